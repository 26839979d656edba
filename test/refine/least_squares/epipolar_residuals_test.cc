// The residuals against their definitions, written anew with ceres::Jet, and their Jacobians
// against that and against numeric differentiation.
#include "rigel/refine/least_squares/epipolar_residuals.h"

#include <cmath>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include "rigel/core/epipolar.h"
#include "rigel/core/rays.h"
#include "rigel/test/core/lens_rig.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/jet_geometry.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr ResidualKind kKinds[] = {ResidualKind::kSampson, ResidualKind::kAngular,
                                   ResidualKind::kAlgebraic};

// x_j . (b x R x_i) for rays in the camera frames, of any length.
template <class T>
T Gec(const Matrix3<T>& R, const Vector3<T>& t, const RigCamera& i, const RigCamera& j,
      const Vector3<T>& u_i, const Vector3<T>& u_j) {
  const Vector3<T> b = R * i.s.cast<T>() + t - j.s.cast<T>();
  const Vector3<T> x_i = i.Q.cast<T>() * u_i;
  const Vector3<T> x_j = j.Q.cast<T>() * u_j;
  return x_j.dot(b.cross(R * x_i));
}

// The residual as the header defines it, from uncentred calibration matrices: nothing of the
// library's own route (centred pixels, linearized groups) is used.
template <class T>
T Residual(ResidualKind kind, const Matrix3<T>& R, const Vector3<T>& t, const Rig& rig,
           const Match& m) {
  using std::sqrt;
  const RigCamera& i = rig.cameras[m.camera1];
  const RigCamera& j = rig.cameras[m.camera2];
  const Camera& ci = i.intrinsics;
  const Camera& cj = j.intrinsics;
  const Vector3<T> b = R * i.s.cast<T>() + t - j.s.cast<T>();
  const Matrix3<T> E = j.Q.transpose().cast<T>() * Cross<T>(b) * R * i.Q.cast<T>();
  const Vector3<T> x_i = AlongRay(ci, m.pixel1).normalized().cast<T>();
  const Vector3<T> x_j = AlongRay(cj, m.pixel2).normalized().cast<T>();
  switch (kind) {
    case ResidualKind::kAlgebraic:
      return x_j.dot(E * x_i);
    case ResidualKind::kAngular: {
      // Derivatives by the directions: E'x_j and E x_i without their radial parts.
      const Vector3<T> by_i = E.transpose() * x_j;
      const Vector3<T> by_j = E * x_i;
      const T C = x_j.dot(by_j);
      const T gradient2 =
          (by_i - x_i * x_i.dot(by_i)).squaredNorm() + (by_j - x_j * x_j.dot(by_j)).squaredNorm();
      return C / sqrt(gradient2) * T(0.25 * (ci.fx() + ci.fy() + cj.fx() + cj.fy()));
    }
    case ResidualKind::kSampson:
      break;
  }
  Eigen::Matrix3d Ki, Kj;
  Ki << ci.fx(), 0, ci.cx(), 0, ci.fy(), ci.cy(), 0, 0, 1;
  Kj << cj.fx(), 0, cj.cx(), 0, cj.fy(), cj.cy(), 0, 0, 1;
  const Matrix3<T> F = Kj.inverse().transpose().cast<T>() * E * Ki.inverse().cast<T>();
  const Vector3<T> p = m.pixel1.homogeneous().cast<T>();
  const Vector3<T> q = m.pixel2.homogeneous().cast<T>();
  const Vector3<T> Fp = F * p;
  const Vector3<T> Ftq = F.transpose() * q;
  return q.dot(Fp) /
         sqrt(Fp.template head<2>().squaredNorm() + Ftq.template head<2>().squaredNorm());
}

// Near zero, near a half turn and in between.
Pose RandomPose(int number, Random* random) {
  const double angle = number % 3 == 0   ? std::pow(10.0, random->Uniform(-9.0, -2.0))
                       : number % 3 == 1 ? kPi - std::pow(10.0, random->Uniform(-9.0, -2.0))
                                         : random->Uniform(0.0, kPi);
  Pose pose;
  pose.R = ExpSO3(angle * random->UnitVector3());
  pose.t = RandomVector3(0.2, 3.0, random);
  return pose;
}

double Value(const EpipolarResiduals& residuals, const Pose& pose, int k) {
  std::vector<GroupLinearization> groups;
  residuals.Linearize(pose, nullptr, &groups);
  return residuals.Evaluate(groups, k, 0, nullptr);
}

TEST(EpipolarResiduals, SampsonIsTheErrorOfCore) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Rig rig = MixedRig(&random);
    const GroupedMatches matches(rig, UnrelatedMatches(rig, 18, &random));
    const Pose pose = RandomPose(i, &random);
    const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
    ASSERT_EQ(residuals.size(), 18);
    ASSERT_EQ(residuals.num_groups(), 9);
    for (int k = 0; k < matches.size(); ++k) {
      const double expected = SampsonError(pose, rig, matches.matches()[k]);
      EXPECT_NEAR(Value(residuals, pose, k), expected, 1e-9 * (1 + std::abs(expected)));
    }
  }
}

TEST(EpipolarResiduals, AlgebraicIsTheTripleProductInMetres) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Rig rig = MixedRig(&random);
    const GroupedMatches matches(rig, UnrelatedMatches(rig, 18, &random));
    const Pose pose = RandomPose(i, &random);
    const EpipolarResiduals residuals(matches, ResidualKind::kAlgebraic);
    for (int k = 0; k < matches.size(); ++k) {
      EXPECT_NEAR(Value(residuals, pose, k),
                  GecTripleProduct(pose, MakeRayPair(rig, matches.matches()[k])), 1e-13);
    }
  }
}

// The gradients in the definitions by automatic differentiation of C itself, by the four pixels and
// by the two directions.
TEST(EpipolarResiduals, SampsonAndAngularDivideByTheGradientOfTheConstraint) {
  using Jet = ceres::Jet<double, 4>;
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Rig rig = MixedRig(&random);
    const GroupedMatches matches(rig, UnrelatedMatches(rig, 9, &random));
    const Pose pose = RandomPose(i, &random);
    const EpipolarResiduals sampson(matches, ResidualKind::kSampson);
    const EpipolarResiduals angular(matches, ResidualKind::kAngular);
    for (int k = 0; k < matches.size(); ++k) {
      const Match& m = matches.matches()[k];
      const RigCamera& ci = rig.cameras[m.camera1];
      const RigCamera& cj = rig.cameras[m.camera2];
      const Camera& a = ci.intrinsics;
      const Camera& b = cj.intrinsics;
      const Vector3<Jet> u_i((Jet(m.pixel1.x(), 0) - a.cx()) / a.fx(),
                             (Jet(m.pixel1.y(), 1) - a.cy()) / a.fy(), Jet(1.0));
      const Vector3<Jet> u_j((Jet(m.pixel2.x(), 2) - b.cx()) / b.fx(),
                             (Jet(m.pixel2.y(), 3) - b.cy()) / b.fy(), Jet(1.0));
      const Matrix3<Jet> R = pose.R.cast<Jet>();
      const Vector3<Jet> t = pose.t.cast<Jet>();
      const Jet by_pixels = Gec<Jet>(R, t, ci, cj, u_i, u_j);
      const double r = by_pixels.a / by_pixels.v.norm();
      EXPECT_NEAR(Value(sampson, pose, k), r, 1e-9 * (1 + std::abs(r)));

      const Eigen::Vector3d x_i = AlongRay(a, m.pixel1).normalized();
      const Eigen::Vector3d x_j = AlongRay(b, m.pixel2).normalized();
      const Eigen::Matrix<double, 3, 2> T_i = TangentBasis(x_i);
      const Eigen::Matrix<double, 3, 2> T_j = TangentBasis(x_j);
      Vector3<Jet> d_i, d_j;
      for (int n = 0; n < 3; ++n) {
        d_i(n) = x_i(n) + T_i(n, 0) * Jet(0.0, 0) + T_i(n, 1) * Jet(0.0, 1);
        d_j(n) = x_j(n) + T_j(n, 0) * Jet(0.0, 2) + T_j(n, 1) * Jet(0.0, 3);
      }
      const Jet by_directions = Gec<Jet>(R, t, ci, cj, d_i, d_j);
      const double focal = 0.25 * (a.fx() + a.fy() + b.fx() + b.fy());
      const double s = focal * by_directions.a / by_directions.v.norm();
      EXPECT_NEAR(Value(angular, pose, k), s, 1e-9 * (1 + std::abs(s)));
    }
  }
}

// Relative to the row, which is what a least-squares step sees.
TEST(EpipolarResiduals, JacobianMatchesAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 6>;
  Random random(4);
  std::vector<GroupLinearization> groups;
  for (int i = 0; i < 200; ++i) {
    const Rig rig = MixedRig(&random);
    const GroupedMatches matches(rig, UnrelatedMatches(rig, 9, &random));
    const Pose pose = RandomPose(i, &random);
    MotionBasis identity;
    identity.setIdentity(6, 6);
    Vector3<Jet> d, t;
    for (int n = 0; n < 3; ++n) {
      d(n) = Jet(0.0, n);
      t(n) = Jet(pose.t(n), 3 + n);
    }
    // Exp(d) at d = 0, to the first order that jets carry.
    const Matrix3<Jet> R = (Matrix3<Jet>::Identity() + Cross<Jet>(d)) * pose.R.cast<Jet>();
    for (const ResidualKind kind : kKinds) {
      const EpipolarResiduals residuals(matches, kind);
      residuals.Linearize(pose, &identity, &groups);
      for (int k = 0; k < matches.size(); ++k) {
        Vector6d row;
        const double value = residuals.Evaluate(groups, k, 6, row.data());
        const Jet expected = Residual<Jet>(kind, R, t, rig, matches.matches()[k]);
        EXPECT_NEAR(value, expected.a, 1e-9 * (1 + std::abs(expected.a)));
        EXPECT_LT((row - expected.v).norm(), 1e-10 * expected.v.norm())
            << "pose " << i << ", kind " << static_cast<int>(kind) << ", match " << k;
      }
    }
  }
}

// Also says that the basis is what the header calls it, and that the perturbation is from the left.
TEST(EpipolarResiduals, JacobianMatchesNumericDifferentiationAlongAnyBasis) {
  Random random(5);
  std::vector<GroupLinearization> groups;
  for (int i = 0; i < 200; ++i) {
    const Rig rig = MixedRig(&random);
    const GroupedMatches matches(rig, UnrelatedMatches(rig, 9, &random));
    const Pose pose = RandomPose(i, &random);
    const int columns = 1 + i % 6;
    MotionBasis basis(6, columns);
    for (int c = 0; c < columns; ++c) {
      basis.col(c) << random.NormalVector3(), random.NormalVector3();
    }
    for (const ResidualKind kind : kKinds) {
      const EpipolarResiduals residuals(matches, kind);
      residuals.Linearize(pose, &basis, &groups);
      for (int k = 0; k < matches.size(); ++k) {
        // A stride of two, the odd places of which must stay as they are.
        std::vector<double> row(2 * columns, -7.0);
        residuals.Evaluate(groups, k, columns, row.data(), 2);
        Eigen::VectorXd analytic(columns), numeric(columns);
        for (int c = 0; c < columns; ++c) {
          EXPECT_EQ(row[2 * c + 1], -7.0);
          analytic(c) = row[2 * c];
          numeric(c) = CentralDifference(
              [&](double h) {
                const Vector6d step = h * basis.col(c);
                return Eigen::Matrix<double, 1, 1>(Value(residuals, Perturbed(pose, step), k));
              },
              1e-4)(0);
        }
        EXPECT_LT((analytic - numeric).norm(), 1e-6 * numeric.norm())
            << "pose " << i << ", kind " << static_cast<int>(kind) << ", match " << k;
      }
    }
  }
}

TEST(EpipolarResiduals, JacobianOfAnyLensMatchesNumericDifferentiation) {
  Random random(8);
  std::vector<GroupLinearization> groups;
  MotionBasis identity;
  identity.setIdentity(6, 6);
  for (int number = 0; number < 18; ++number) {
    const LensRig lenses = MakeLensRig(number, &random);
    const GroupedMatches matches(lenses.rig, UnrelatedLensMatches(lenses, 9, &random));
    const Pose pose = RandomPose(2, &random);
    for (const ResidualKind kind : kKinds) {
      const EpipolarResiduals residuals(matches, kind);
      residuals.Linearize(pose, &identity, &groups);
      for (int k = 0; k < matches.size(); ++k) {
        Vector6d row, numeric;
        residuals.Evaluate(groups, k, 6, row.data());
        for (int c = 0; c < 6; ++c) {
          numeric(c) = CentralDifference(
              [&](double h) {
                const Vector6d step = h * Vector6d::Unit(c);
                return Eigen::Matrix<double, 1, 1>(Value(residuals, Perturbed(pose, step), k));
              },
              1e-4)(0);
        }
        EXPECT_LT((row - numeric).norm(), 1e-6 * numeric.norm())
            << "rig " << number << ", kind " << static_cast<int>(kind) << ", match " << k;
      }
    }
  }
}

// Shrinking the motion of a camera at the origin of the body must gain nothing: else least squares
// runs to zero motion.
TEST(EpipolarResiduals, SampsonAndAngularDoNotSeeTheLengthOfTheBaseline) {
  Random random(6);
  Rig rig = MixedRig(&random);
  rig.cameras.resize(1);
  rig.cameras[0].s.setZero();
  const GroupedMatches matches(rig, UnrelatedMatches(rig, 10, &random));
  Pose pose = RandomPose(2, &random);
  Pose tiny = pose;
  tiny.t *= 1e-9;
  for (int k = 0; k < matches.size(); ++k) {
    for (const ResidualKind kind : {ResidualKind::kSampson, ResidualKind::kAngular}) {
      const EpipolarResiduals residuals(matches, kind);
      EXPECT_NEAR(Value(residuals, pose, k), Value(residuals, tiny, k), 1e-8);
    }
    const EpipolarResiduals algebraic(matches, ResidualKind::kAlgebraic);
    EXPECT_NEAR(1e-9 * Value(algebraic, pose, k), Value(algebraic, tiny, k), 1e-20);
  }
}

void ExpectZero(const GroupedMatches& matches, const Pose& pose) {
  MotionBasis identity;
  identity.setIdentity(6, 6);
  std::vector<GroupLinearization> groups;
  for (const ResidualKind kind : {ResidualKind::kSampson, ResidualKind::kAngular}) {
    const EpipolarResiduals residuals(matches, kind);
    residuals.Linearize(pose, &identity, &groups);
    for (int k = 0; k < matches.size(); ++k) {
      Vector6d row = Vector6d::Constant(3.0);
      EXPECT_EQ(residuals.Evaluate(groups, k, 6, row.data()), 0.0);
      EXPECT_EQ(row, Vector6d::Zero());
    }
  }
}

TEST(EpipolarResiduals, AreZeroAtTheEpipoles) {
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].intrinsics = Camera::Pinhole(400, 420, 320, 240, 640, 480);
  Match m;
  m.pixel1 = m.pixel2 = {320, 240};
  Pose pose;
  pose.t = {0, 0, 1};
  ExpectZero(GroupedMatches(rig, {m}), pose);
}

TEST(EpipolarResiduals, AreZeroWhereEVanishes) {
  Random random(7);
  const Rig rig = MixedRig(&random);
  // The zero motion, for intra-camera matches.
  std::vector<Match> intra = UnrelatedMatches(rig, 20, &random);
  for (Match& m : intra) m.camera2 = m.camera1;
  ExpectZero(GroupedMatches(rig, intra), Pose());
  // Camera 1 at time 2 exactly where camera 0 was at time 1.
  std::vector<Match> inter = UnrelatedMatches(rig, 20, &random);
  for (Match& m : inter) {
    m.camera1 = 0;
    m.camera2 = 1;
  }
  Pose pose;
  pose.t = rig.cameras[1].s - rig.cameras[0].s;
  Rig exact = rig;
  exact.cameras[1].s = exact.cameras[0].s + pose.t;
  ExpectZero(GroupedMatches(exact, inter), pose);
}

// The limits must be reached without overflow on the way.
TEST(EpipolarResiduals, StayFiniteBesideTheEpipoleAndBesideZero) {
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].intrinsics = Camera::Pinhole(400, 420, 0, 0, 640, 480);
  MotionBasis identity;
  identity.setIdentity(6, 6);
  std::vector<GroupLinearization> groups;
  for (double size = 1.0; size > 1e-140; size *= 1e-3) {
    Match m;
    m.pixel1 = {size, 2 * size};
    m.pixel2 = {-3 * size, size};
    const GroupedMatches beside(rig, {m});
    m.pixel1 = {100, 20};
    m.pixel2 = {-30, 50};
    const GroupedMatches away(rig, {m});
    Pose forward, tiny;
    forward.t = {0, 0, 1};
    tiny.t = size * Eigen::Vector3d(1, 2, 3);
    for (const ResidualKind kind : kKinds) {
      for (int i = 0; i < 2; ++i) {
        const EpipolarResiduals residuals(i == 0 ? beside : away, kind);
        Vector6d row;
        residuals.Linearize(i == 0 ? forward : tiny, &identity, &groups);
        const double r = residuals.Evaluate(groups, 0, 6, row.data());
        EXPECT_TRUE(std::isfinite(r)) << size;
        EXPECT_TRUE(row.allFinite()) << size;
        if (i == 0) {
          EXPECT_LE(std::abs(r), 10 * size + 1e-12);  // the nearest exact match is there
        }
      }
    }
  }
}

}  // namespace
}  // namespace rigel
