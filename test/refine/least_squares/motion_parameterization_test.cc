// Each chart of the motion: where it starts, what it keeps, and its derivative.
#include "rigel/refine/least_squares/motion_parameterization.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/least_squares/translation_forms.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

struct Form {
  TranslationForm form;
  const char* name;
};

constexpr Form kForms[] = {
    {kFreeTranslation, "free"}, {kSphere, "sphere"}, {kPlane, "plane"},
    {kCircle, "circle"},        {kDepths, "depths"}, {kPlanarDepths, "planar depths"},
};
constexpr Form kFormsOnSphere[] = {
    {kDepthsOnSphere, "depths on the sphere"},
    {kPlanarDepthsOnSphere, "planar depths on the sphere"},
};
constexpr RotationForm kRotations[] = {RotationForm::kFree, RotationForm::kAngle};

// A motion that meets the prior, a plane and a reference match exactly, as a start that all forms
// hold.
struct Problem {
  Pose pose;
  Eigen::Vector3d n1, n2;  // n2 = R n1, t . n2 = 0
  Alignment alignment;
  RayPair reference;
};

Problem MakeProblem(uint64_t seed) {
  Random random = Random::Stream(77, seed);
  Problem p;
  p.pose.R = ExpSO3(RandomVector3(0.0, 3.0, &random));
  p.n1 = random.UnitVector3();
  p.n2 = p.pose.R * p.n1;
  const Eigen::Vector3d t = random.UnitVector3();
  p.pose.t = random.Uniform(0.2, 2.0) * (t - p.n2 * p.n2.dot(t)).normalized();
  MotionPrior prior;
  prior.gravity1 = p.n1;
  prior.gravity2 = p.n2;
  std::string error;
  EXPECT_TRUE(MakeAlignment(prior, PriorKind::kVertical, &p.alignment, &error)) << error;
  p.reference.ray1.s = 0.5 * random.NormalVector3();
  p.reference.ray2.s = 0.5 * random.NormalVector3();
  p.reference.ray1.x = random.UnitVector3();
  const Eigen::Vector3d X1 = p.reference.ray1.s + random.Uniform(3.0, 20.0) * p.reference.ray1.x;
  p.reference.ray2.x = (p.pose * X1 - p.reference.ray2.s).normalized();
  return p;
}

std::vector<double> RandomParameters(int size, double scale, Random* random) {
  std::vector<double> parameters(std::max(size, 1));
  for (double& x : parameters) x = random->Uniform(-scale, scale);
  return parameters;
}

Pose At(const MotionParameterization& chart, const std::vector<double>& parameters) {
  Pose pose;
  chart.Evaluate(parameters.data(), &pose, nullptr);
  return pose;
}

TEST(MotionParameterization, ReproducesAStartOfItsForm) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = MakeProblem(seed);
    for (const RotationForm rotation : kRotations) {
      for (const Form& form : kForms) {
        SCOPED_TRACE(form.name);
        MotionParameterization chart;
        ASSERT_TRUE(chart.Set(rotation, form.form, p.pose, p.alignment, p.reference));
        ASSERT_EQ(chart.size(), (rotation == RotationForm::kFree ? 3 : 1) + form.form.size());
        const Pose start = At(chart, std::vector<double>(6, 0.0));
        EXPECT_LT((start.R - p.pose.R).norm(), 1e-12);
        // A reference of little parallax amplifies rounding.
        EXPECT_LT((start.t - p.pose.t).norm(), form.form.depths ? 1e-9 : 1e-12);
      }
    }
  }
}

// A start that breaks the prior, the plane and the reference.
TEST(MotionParameterization, ProjectsAStartThatIsNotOfItsForm) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = MakeProblem(seed);
    Random random = Random::Stream(78, seed);
    const Pose start = StartNear(p.pose, 3.0, 0.1, &random);
    for (const RotationForm rotation : kRotations) {
      for (const Form& form : kForms) {
        SCOPED_TRACE(form.name);
        MotionParameterization chart;
        ASSERT_TRUE(chart.Set(rotation, form.form, start, p.alignment, p.reference));
        const Pose at = At(chart, std::vector<double>(6, 0.0));
        if (rotation == RotationForm::kFree) {
          EXPECT_LT((at.R - start.R).norm(), 1e-12);
        } else {
          // Of the family, and no other member is nearer.
          EXPECT_LT((at.R * p.n1 - p.n2).norm(), 1e-12);
          const double distance = RotationError(start.R, at.R);
          for (const double step : {-1e-3, 1e-3}) {
            EXPECT_LT(distance, RotationError(start.R, ExpSO3(step * p.n2) * at.R));
          }
        }
        const Eigen::Vector3d gx = at.R * p.reference.ray1.x;
        if (form.form.depths) {
          EXPECT_NEAR(GecTripleProduct(at, p.reference), 0.0, 1e-10);
          if (!form.form.planar) {
            // The shortest way that makes the rays meet is along their common perpendicular.
            EXPECT_NEAR((at.t - start.t).dot(gx), 0.0, 1e-9);
            EXPECT_NEAR((at.t - start.t).dot(p.reference.ray2.x), 0.0, 1e-9);
          } else if (rotation == RotationForm::kAngle) {
            EXPECT_NEAR(at.t.dot(p.n2), 0.0, 1e-9);
          }
        } else if (form.form.planar) {
          const Eigen::Vector3d in_plane = start.t - p.n2 * p.n2.dot(start.t);
          const double stretch = form.form.holds_length ? start.t.norm() / in_plane.norm() : 1.0;
          EXPECT_LT((at.t - stretch * in_plane).norm(), 1e-12);
        } else {
          EXPECT_LT((at.t - start.t).norm(), 1e-12);
        }
      }
    }
  }
}

TEST(MotionParameterization, BasisMatchesNumericDifferentiation) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = MakeProblem(seed);
    Random random = Random::Stream(79, seed);
    const Pose start = StartNear(p.pose, 3.0, 0.1, &random);
    for (const RotationForm rotation : kRotations) {
      for (const Form& form : kForms) {
        MotionParameterization chart;
        ASSERT_TRUE(chart.Set(rotation, form.form, start, p.alignment, p.reference));
        // Large steps, none, and those at which series take over from quotients.
        for (const double scale : {0.8, 1e-2, 1e-4, 1e-8, 0.0}) {
          SCOPED_TRACE(std::string(form.name) + " at " + std::to_string(scale));
          const std::vector<double> x = RandomParameters(chart.size(), scale, &random);
          Pose pose;
          MotionBasis basis;
          basis.setConstant(6, 6, 5.0);
          chart.Evaluate(x.data(), &pose, &basis);
          ASSERT_EQ(basis.cols(), chart.size());
          for (int c = 0; c < chart.size(); ++c) {
            const Vector6d numeric = CentralDifference(
                [&](double h) {
                  std::vector<double> y = x;
                  y[c] += h;
                  return Difference(At(chart, y), pose);
                },
                1e-3);
            EXPECT_LT((basis.col(c) - numeric).norm(), 1e-8 * (1 + numeric.norm()))
                << "column " << c << ": " << basis.col(c).transpose() << " against "
                << numeric.transpose();
          }
        }
      }
    }
  }
}

TEST(MotionParameterization, KeepsWhatItsFormTakesAsExact) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Problem p = MakeProblem(seed);
    Random random = Random::Stream(80, seed);
    const Pose start = StartNear(p.pose, 3.0, 0.1, &random);
    for (const RotationForm rotation : kRotations) {
      for (const Form& form : kForms) {
        SCOPED_TRACE(form.name);
        MotionParameterization chart;
        ASSERT_TRUE(chart.Set(rotation, form.form, start, p.alignment, p.reference));
        for (int i = 0; i < 10; ++i) {
          const Pose pose = At(chart, RandomParameters(chart.size(), 2.0, &random));
          EXPECT_LT((pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
          EXPECT_GT(pose.R.determinant(), 0);
          if (rotation == RotationForm::kAngle) {
            EXPECT_LT((pose.R * p.n1 - p.n2).norm(), 1e-12);
          }
          if (form.form.holds_length) {
            EXPECT_NEAR(pose.t.norm(), start.t.norm(), 1e-12);
          }
          // With depths the plane turns with a free rotation; no form of Refine() combines them.
          if (form.form.planar && (!form.form.depths || rotation == RotationForm::kAngle)) {
            EXPECT_NEAR(pose.t.dot(p.n2), 0.0, 1e-8);
          }
          if (form.form.depths) {
            EXPECT_NEAR(GecTripleProduct(pose, p.reference), 0.0, 1e-10 * (1 + pose.t.norm()));
          }
        }
      }
    }
  }
}

TEST(MotionParameterization, DepthsOnTheSphereHoldTheLengthOfT) {
  int count = 0, held = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const Problem p = MakeProblem(seed);
    Pose start = p.pose;
    start.t *= 1.01;  // not of the reference
    for (const Form& form : kFormsOnSphere) {
      MotionParameterization chart;
      ASSERT_TRUE(chart.Set(RotationForm::kFree, form.form, start, p.alignment, p.reference));
      ASSERT_EQ(chart.size(), form.form.planar ? 3 : 4);
      for (const double turn : {-0.003, 0.0, 0.003}) {
        const Pose pose = At(chart, {turn, 0.5 * turn, -turn, 2.0 * turn});
        // There may be no such depths: then |t| is the nearest, which is longer.
        ++count;
        const double longer = pose.t.norm() / start.t.norm() - 1.0;
        held += std::abs(longer) < 1e-9;
        EXPECT_GT(longer, -1e-9);
        EXPECT_NEAR(GecTripleProduct(pose, p.reference), 0.0, 1e-10 * (1 + pose.t.norm()));
      }
    }
  }
  EXPECT_GE(held, 0.95 * count);
}

// The logarithm of |t|: equal steps either way are equal factors, and the direction stays.
TEST(MotionParameterization, TheLengthMovesByItsLogarithm) {
  const Problem p = MakeProblem(4);
  for (const TranslationForm& form : {kFreeTranslation, kPlane}) {
    MotionParameterization chart;
    ASSERT_TRUE(chart.Set(RotationForm::kFree, form, p.pose, p.alignment, p.reference));
    std::vector<double> x(6, 0.0);
    double& log = x[chart.size() - 1];
    for (const double at : {-50.0, -1.0, 0.5, 30.0}) {
      log = at;
      EXPECT_LT((At(chart, x).t / std::exp(at) - p.pose.t).norm(), 1e-12);
    }
  }
}

TEST(MotionParameterization, TheLengthStaysWithinItsRange) {
  const Problem p = MakeProblem(4);
  const double norm = p.pose.t.norm();
  const LengthRange range = {0.25 * norm, 1000.0 * norm};
  for (const TranslationForm& form : {kFreeTranslation, kPlane}) {
    MotionParameterization chart;
    ASSERT_TRUE(chart.Set(RotationForm::kFree, form, p.pose, p.alignment, p.reference, range));
    std::vector<double> x(6, 0.0);
    double& log = x[chart.size() - 1];
    Pose pose;
    MotionBasis basis;
    for (const double beyond : {-1.4, -20.0, -1e6, 6.95, 1e6}) {
      log = beyond;
      chart.Evaluate(x.data(), &pose, &basis);
      const double share = beyond < 0 ? 0.25 : 1000.0;
      EXPECT_LT((pose.t - share * p.pose.t).norm(), 1e-9 * norm * share);
      // A parameter that does not move the motion must say so.
      EXPECT_EQ(basis.col(chart.size() - 1).norm(), 0.0);
    }
    for (const double within : {-1.38, 6.9}) {
      log = within;
      chart.Evaluate(x.data(), &pose, &basis);
      EXPECT_NEAR(pose.t.norm(), norm * std::exp(within), 1e-12 * pose.t.norm());
      EXPECT_GT(basis.col(chart.size() - 1).norm(), 0.0);
    }
  }
}

TEST(MotionParameterization, RefusesAStartWithoutAPlaceInTheForm) {
  const Problem p = MakeProblem(5);
  Pose still = p.pose;
  still.t.setZero();
  MotionParameterization chart;
  for (const RotationForm rotation : kRotations) {
    for (const Form& form : kForms) {
      SCOPED_TRACE(form.name);
      EXPECT_EQ(chart.Set(rotation, form.form, still, p.alignment, p.reference), form.form.depths);
      // Rays of one point at infinity.
      RayPair parallel = p.reference;
      parallel.ray2.x = p.pose.R * parallel.ray1.x;
      EXPECT_EQ(chart.Set(RotationForm::kFree, form.form, p.pose, p.alignment, parallel),
                !form.form.depths);
    }
    for (const Form& form : kFormsOnSphere) {
      SCOPED_TRACE(form.name);
      EXPECT_FALSE(chart.Set(rotation, form.form, still, p.alignment, p.reference));
    }
  }
  // t along the normal has no direction in the plane.
  MotionPrior prior;
  prior.normal = Eigen::Vector3d::UnitY();
  Alignment upright;
  std::string error;
  ASSERT_TRUE(MakeAlignment(prior, PriorKind::kPlanar, &upright, &error)) << error;
  Pose climbing;
  climbing.t = {0, 2, 0};
  for (const TranslationForm& form : {kPlane, kCircle}) {
    EXPECT_FALSE(chart.Set(RotationForm::kAngle, form, climbing, upright, p.reference));
  }
  // A reference on the horizon says nothing of the height: no line of depths in the plane.
  RayPair horizon;
  horizon.ray1.x = {0, 0, 1};
  horizon.ray2.x = Eigen::Vector3d(0.1, 0, 1).normalized();
  Pose forward;
  forward.t = {0, 0, 1};
  for (const TranslationForm& form : {kPlanarDepths, kPlanarDepthsOnSphere}) {
    EXPECT_FALSE(chart.Set(RotationForm::kAngle, form, forward, upright, horizon));
  }
}

// Only one ray on the horizon: nothing may be divided by its height.
TEST(MotionParameterization, PlanarDepthsTakeOneRayOnTheHorizon) {
  MotionPrior prior;
  prior.normal = Eigen::Vector3d::UnitY();
  Alignment upright;
  std::string error;
  ASSERT_TRUE(MakeAlignment(prior, PriorKind::kPlanar, &upright, &error)) << error;
  RayPair reference;
  reference.ray1.s = {0, -1, 0};
  reference.ray1.x = Eigen::Vector3d(0.2, 0.1, 1).normalized();
  Pose forward;
  forward.t = {0, 0, -1};
  const Eigen::Vector3d X1 = reference.ray1.s + 10 * reference.ray1.x;
  reference.ray2.s = {0.3, X1.y(), 0};
  reference.ray2.x = (forward * X1 - reference.ray2.s).normalized();
  ASSERT_NEAR(reference.ray2.x.y(), 0.0, 1e-15);
  MotionParameterization chart;
  ASSERT_TRUE(chart.Set(RotationForm::kAngle, kPlanarDepths, forward, upright, reference));
  EXPECT_LT((At(chart, {0, 0}).t - forward.t).norm(), 1e-10);
  for (const double x : {-3.0, 0.5, 4.0}) EXPECT_NEAR(At(chart, {0, x}).t.y(), 0.0, 1e-12);
}

}  // namespace
}  // namespace rigel
