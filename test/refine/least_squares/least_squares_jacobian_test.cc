// Every analytic Jacobian of the refinement against automatic differentiation of a twin.
#include <cmath>
#include <string>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/least_squares/jacobian_twins.h"

namespace rigel {
namespace {

TEST(Jacobian, ChartMatchesAutomaticDifferentiation) {
  Worst values, derivatives;
  int columns = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i, true);
    Random random = Random::Stream(132, i);
    for (const Form& form : kForms) {
      const MotionParameterization chart = MakeChart(form, p.start);
      ASSERT_EQ(chart.size(), form.size) << form.name;
      const Parameters x = RandomParameters(form, i, true, &random);
      CompareChart(chart, form, p.start, x, i, &values, &derivatives);
      columns += form.size;
    }
  }
  values.Expect("values", kTolerance, kPoints * kNumForms);
  derivatives.Expect("derivatives", kTolerance, columns);
}

// Where |t| is held there are depths near a start of the form only: its rotation is of any size,
// the way from it is short.
TEST(Jacobian, DepthsOnTheSphereMatchAutomaticDifferentiation) {
  constexpr Form kOnSphere[] = {
      {RotationForm::kFree, kDepthsOnSphere, "free, depths on the sphere", 4},
      {RotationForm::kAngle, kDepthsOnSphere, "angle, depths on the sphere", 2},
      {RotationForm::kFree, kPlanarDepthsOnSphere, "free, planar", 3},
      {RotationForm::kAngle, kPlanarDepthsOnSphere, "angle, planar", 1}};
  Worst values, derivatives;
  int columns = 0, compared = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(142, i);
    for (const Form& form : kOnSphere) {
      // A start of the form: the reference and, where it is exact, the prior hold.
      TranslationForm free_form = form.translation;
      free_form.holds_length = false;
      const Parameters zero{};
      Start start = p.start;
      MotionParameterization chart;
      ASSERT_TRUE(
          chart.Set(form.rotation, free_form, start.pose, start.alignment, start.reference));
      chart.Evaluate(zero.data(), &start.pose, nullptr);
      const bool set =
          chart.Set(form.rotation, form.translation, start.pose, start.alignment, start.reference);
      if (!set) continue;
      ASSERT_EQ(chart.size(), form.size) << form.name;
      Parameters x{};
      for (int k = 0; k < form.size; ++k) {
        x[k] = std::pow(10.0, random.Uniform(-9.0, -2.5)) * (k % 2 == 0 ? 1.0 : -1.0);
      }
      Pose at;
      chart.Evaluate(x.data(), &at, nullptr);
      const double length = start.pose.t.norm();
      if (std::abs(at.t.norm() - length) > 1e-9 * length) continue;
      CompareChart(chart, form, start, x, i, &values, &derivatives);
      columns += form.size;
      ++compared;
    }
  }
  EXPECT_GT(compared, kPoints * 4 * 9 / 10);
  values.Expect("values", kTolerance, compared);
  derivatives.Expect("derivatives", kTolerance, columns);
}

// Residual and chart in one: relative to the gradient of the match.
TEST(Jacobian, EpipolarResidualsMatchAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 6>;
  Worst values[3], derivatives[3];
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i, true);
    const GroupedMatches matches(p.rig, p.matches);
    Random random = Random::Stream(133, i);
    for (const Form& form : kForms) {
      const MotionParameterization chart = MakeChart(form, p.start);
      const Parameters x = RandomParameters(form, i, true, &random);
      Pose pose;
      MotionBasis basis;
      chart.Evaluate(x.data(), &pose, &basis);
      const Motion<Jet> twin = ChartTwin(form, p.start)(ToJets<Jet>(x, form.size).data());
      for (int kind = 0; kind < 3; ++kind) {
        const EpipolarResiduals residuals(matches, kKinds[kind]);
        std::vector<GroupLinearization> groups;
        residuals.Linearize(pose, &basis, &groups);
        for (int k = 0; k < residuals.size(); ++k) {
          const Match& m = matches.matches()[k];
          const auto where = [&] { return At(form, i) + At(m); };
          Vector6d row = Vector6d::Zero();
          const double r = residuals.Evaluate(groups, k, form.size, row.data());
          const Jet expected = EpipolarTwin<Jet>(kKinds[kind], twin, p.rig, m);
          values[kind].Add(std::abs(r - expected.a) / (1.0 + std::abs(expected.a)), where);
          derivatives[kind].Add(RelativeError(row, expected.v), where);
        }
      }
    }
  }
  for (int kind = 0; kind < 3; ++kind) {
    values[kind].Expect(std::string(kKindNames[kind]) + "_values", kTolerance,
                        kPoints * kNumForms * 9);
    derivatives[kind].Expect(std::string(kKindNames[kind]) + "_derivatives", kTolerance,
                             kPoints * kNumForms * 9);
  }
}

// By the perturbation R <- Exp(d) R, t <- t + e; each row relative to itself.
TEST(Jacobian, PriorResidualsMatchAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 6>;
  Worst values, derivatives;
  int rows = 0;
  for (int i = 0; i < kPoints; ++i) {
    Random random = Random::Stream(134, i);
    for (const PriorKind kind : kPriorKinds) {
      for (const int lengths : {0, 1, 2, 3}) {  // none, the distance, the weak one, both
        MotionPrior prior = FullPrior(&random);
        const PriorParts parts = RandomParts(kind, lengths, &random);
        if (!parts.distance && i % 2 == 0) prior.distance_sigma = 0.0;
        Pose start, pose;
        start.R = RandomRotation((i / 3) % 3, &random);
        start.t = RandomVector3(0.2, 3.0, &random);
        if (i % 10 == 9) start.t.setZero();
        pose.R = RandomRotation(i % 3, &random);
        pose.t = RandomVector3(0.2, 3.0, &random);
        const PriorResiduals residuals(prior, parts, start);
        PriorResiduals::Residuals r;
        PriorResiduals::Jacobian J;
        residuals.Evaluate(pose, &r, &J);
        const std::vector<Jet> twin = PriorTwin<Jet>(prior, parts, start, PerturbedJets<Jet>(pose));
        ASSERT_EQ(residuals.size(), static_cast<int>(twin.size()));
        ASSERT_EQ(J.rows(), residuals.size());
        for (int k = 0; k < residuals.size(); ++k) {
          const auto where = [&] {
            return "kind " + std::to_string(static_cast<int>(kind)) + ", point " +
                   std::to_string(i) + ", row " + std::to_string(k);
          };
          values.Add(std::abs(r(k) - twin[k].a) / (1.0 + std::abs(twin[k].a)), where);
          derivatives.Add(RelativeError(J.row(k).transpose(), twin[k].v), where);
          ++rows;
        }
      }
    }
  }
  EXPECT_GT(rows, kPoints * 40);
  values.Expect("values", kTolerance, rows);
  derivatives.Expect("derivatives", kTolerance, rows);
}

// Each block relative to itself.
TEST(Jacobian, ReprojectionCostMatchesAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 9>;
  Worst values, by_motion, by_point;
  int count = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i, true);
    Random random = Random::Stream(135, i);
    for (const Form& form : kForms) {
      const MotionParameterization chart = MakeChart(form, p.start);
      const Parameters x = RandomParameters(form, i, true, &random);
      const ChartTwin chart_twin(form, p.start);
      for (const Match& m : p.matches) {
        Vector3<double> point;
        if (!RandomImage(p.rig, chart_twin(x.data()), m, &random, &point)) continue;
        ++count;
        const double weight = random.Uniform(0.2, 3.0);
        Eigen::Vector4d r;
        Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::RowMajor> motion(4, form.size);
        Eigen::Matrix<double, 4, 3, Eigen::RowMajor> inverse_depth;
        const double* blocks[2] = {x.data(), point.data()};
        double* jacobians[2] = {motion.data(), inverse_depth.data()};
        ASSERT_TRUE(
            ReprojectionOnChart(chart, p.rig, m, weight).Evaluate(blocks, r.data(), jacobians));
        const Vector3<Jet> jets(Jet(point.x(), 6), Jet(point.y(), 7), Jet(point.z(), 8));
        const Eigen::Matrix<Jet, 4, 1> twin = ReprojectionTwin<Jet>(
            p.rig, m, weight, chart_twin(ToJets<Jet>(x, form.size).data()), jets);
        Eigen::Vector4d expected;
        Eigen::Matrix<double, 4, 9> J;
        for (int k = 0; k < 4; ++k) {
          expected(k) = twin(k).a;
          J.row(k) = twin(k).v.transpose();
        }
        const auto where = [&] { return At(form, i) + At(m); };
        values.Add((r - expected).norm() / (1.0 + expected.norm()), where);
        by_motion.Add(RelativeError(motion, J.leftCols(form.size)), where);
        by_point.Add(RelativeError(inverse_depth, J.rightCols<3>()), where);
      }
    }
  }
  EXPECT_GT(count, kPoints * kNumForms * 8);
  values.Expect("values", kTolerance, count);
  by_motion.Expect("motion", kTolerance, count);
  by_point.Expect("point", kTolerance, count);
}

}  // namespace
}  // namespace rigel
