#include "rigel/core/pose.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"
#include "rigel/test/core/random_vector.h"

namespace rigel {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kSeeds = 200;

// The second opinion: the exponential series of the matrix itself, in long double.
Matrix3d ExpBySeries(const Vector3d& omega) {
  using LongMatrix = Eigen::Matrix<long double, 3, 3>;
  const LongMatrix W = Skew(omega).cast<long double>();
  LongMatrix sum = LongMatrix::Identity();
  LongMatrix term = LongMatrix::Identity();
  for (int k = 1; k < 60; ++k) {
    term = term * W / static_cast<long double>(k);
    sum += term;
  }
  return sum.cast<double>();
}

double RotationDefect(const Matrix3d& R) {
  return (R.transpose() * R - Matrix3d::Identity()).norm() + std::abs(R.determinant() - 1.0);
}

Pose RandomPose(Random* random) {
  Pose pose;
  pose.R = ExpSO3(RandomVector3(0.0, 3.0, random));
  pose.t = 10.0 * random->NormalVector3();
  return pose;
}

TEST(Pose, SkewIsTheCrossProduct) {
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    const Vector3d a = random.NormalVector3();
    const Vector3d b = random.NormalVector3();
    EXPECT_LT((Skew(a) * b - a.cross(b)).norm(), 1e-14);
  }
}

TEST(Pose, RotationYTurnsZTowardsX) {
  EXPECT_LT((RotationY(kPi / 2) * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 1e-15);
  for (const double angle : {-3.0, -1e-9, 0.0, 0.5, 3.1}) {
    EXPECT_LT((RotationY(angle) - ExpSO3(angle * Vector3d::UnitY())).norm(), 1e-14) << angle;
  }
}

TEST(Pose, ExpAgreesWithTheMatrixSeriesAtAnyAngle) {
  // On both sides of the switch to the series at 1e-6, and beyond pi.
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-8, 0.99e-6, 1.01e-6, 1e-4, 0.01, 0.3, 1.0, 2.0,
                             3.0, kPi - 1e-9, kPi, kPi + 1e-3, 6.0}) {
    for (int seed = 0; seed < 20; ++seed) {
      Random random = Random::Stream(2, seed);
      const Vector3d omega = angle * random.UnitVector3();
      const Matrix3d R = ExpSO3(omega);
      EXPECT_LT((R - ExpBySeries(omega)).norm(), 5e-15) << angle;
      EXPECT_LT(RotationDefect(R), 5e-15) << angle;
    }
  }
}

TEST(Pose, LogInvertsExpFromZeroToPi) {
  for (const double angle : {0.0, 1e-300, 1e-15, 1e-9, 0.9e-6, 1.9e-6, 2.1e-6, 1e-3, 0.5, 2.0, 3.0,
                             kPi - 1e-3, kPi - 1e-6, kPi - 1e-9}) {
    for (int seed = 0; seed < 50; ++seed) {
      Random random = Random::Stream(3, seed);
      const Vector3d omega = angle * random.UnitVector3();
      // Relative below one radian: small angles keep their digits. A matrix holds an angle to
      // 1e-16 absolute only.
      EXPECT_LT((LogSO3(ExpSO3(omega)) - omega).norm(), 4e-15) << angle << " seed " << seed;
    }
  }
}

TEST(Pose, LogAtPiReturnsOneOfTheTwoVectors) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(4, seed);
    Vector3d axis = random.UnitVector3();
    if (seed < 3) axis = Vector3d::Unit(seed);
    const Matrix3d R = 2.0 * axis * axis.transpose() - Matrix3d::Identity();
    const Vector3d omega = LogSO3(R);
    EXPECT_NEAR(omega.norm(), kPi, 1e-14);
    EXPECT_LT(omega.cross(axis).norm(), 1e-14) << seed;
  }
}

TEST(Pose, LogStaysInTheBallOfRadiusPi) {
  Random random(5);
  for (int k = 0; k < kSeeds; ++k) {
    const Vector3d omega = RandomVector3(kPi, 2 * kPi, &random);
    const Vector3d log = LogSO3(ExpSO3(omega));
    EXPECT_LE(log.norm(), kPi + 1e-14);
    EXPECT_LT((ExpSO3(log) - ExpSO3(omega)).norm(), 1e-14);
  }
}

TEST(Pose, LeftJacobianAgreesWithNumericDifferentiation) {
  // On both sides of the switch to the series at 1e-3.
  for (const double angle : {0.0, 1e-8, 1e-4, 0.99e-3, 1.01e-3, 0.01, 0.5, 1.5, 3.0, 3.14}) {
    for (int seed = 0; seed < 20; ++seed) {
      Random random = Random::Stream(6, seed);
      const Vector3d omega = angle * random.UnitVector3();
      const Matrix3d J = LeftJacobianSO3(omega);
      const double h = 1e-5;
      for (int k = 0; k < 3; ++k) {
        const Vector3d d = h * Vector3d::Unit(k);
        const Matrix3d inverse = ExpSO3(omega).transpose();
        const Vector3d column =
            (LogSO3(ExpSO3(omega + d) * inverse) - LogSO3(ExpSO3(omega - d) * inverse)) / (2 * h);
        EXPECT_LT((J.col(k) - column).norm(), 1e-9) << angle << " column " << k;
      }
    }
  }
}

TEST(Pose, LeftJacobianIsContinuousWhereItSwitchesToTheSeries) {
  const Vector3d axis = Vector3d(1, -2, 3).normalized();
  const Matrix3d below = LeftJacobianSO3(std::nextafter(1e-3, 0.0) * axis);
  const Matrix3d above = LeftJacobianSO3(1.0000001e-3 * axis);
  EXPECT_LT((below - above).norm(), 1e-9);
  // The integral of Exp(s w) over s in [0, 1] is the definition; here by Simpson's rule.
  for (const double angle : {0.5e-3, 2e-3}) {
    const Vector3d w = angle * axis;
    const Matrix3d simpson = (Matrix3d::Identity() + 4.0 * ExpSO3(0.5 * w) + ExpSO3(w)) / 6.0;
    EXPECT_LT((LeftJacobianSO3(w) - simpson).norm(), 1e-14) << angle;
  }
}

TEST(Pose, CompositionAppliesTheRightOneFirst) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(7, seed);
    const Pose b_from_a = RandomPose(&random);
    const Pose c_from_b = RandomPose(&random);
    const Vector3d X = 10.0 * random.NormalVector3();
    EXPECT_LT((c_from_b * b_from_a * X - c_from_b * (b_from_a * X)).norm(), 1e-12);
    EXPECT_LT((b_from_a * X - (b_from_a.R * X + b_from_a.t)).norm(), 1e-13);
  }
}

TEST(Pose, InverseUndoesTheMotion) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(8, seed);
    const Pose pose = RandomPose(&random);
    for (const Pose& identity : {pose * pose.Inverse(), pose.Inverse() * pose}) {
      EXPECT_LT((identity.R - Matrix3d::Identity()).norm(), 1e-14);
      EXPECT_LT(identity.t.norm(), 1e-13);
    }
  }
}

TEST(Pose, QuaternionRoundTripHasPositiveW) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(9, seed);
    const Pose pose = RandomPose(&random);
    const Quaterniond q = pose.Quaternion();
    EXPECT_GE(q.w(), 0.0);
    EXPECT_NEAR(q.norm(), 1.0, 1e-15);
    // Neither the sign nor the length of the quaternion matters.
    Quaterniond other = q;
    other.coeffs() *= -3.0;
    const Pose back = Pose::FromQuaternion(other, pose.t);
    EXPECT_LT((back.R - pose.R).norm(), 1e-14) << seed;
    EXPECT_EQ(back.t, pose.t);
  }
}

TEST(Pose, AllFiniteSeesEveryEntry) {
  EXPECT_TRUE(Pose().AllFinite());
  for (int k = 0; k < 12; ++k) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Pose pose;
      (k < 9 ? pose.R(k % 3, k / 3) : pose.t[k - 9]) = bad;
      EXPECT_FALSE(pose.AllFinite()) << k;
    }
  }
}

// The angle between the two is the smallest that any rotation from a to b can have.
TEST(Pose, SmallestRotationTakesAToBByTheirAngle) {
  for (const double angle :
       {0.0, 1e-14, 1e-10, 1e-5, 0.3, 2.0, 3.0, kPi - 1e-5, kPi - 1e-10, kPi - 1e-14, kPi}) {
    for (int seed = 0; seed < 50; ++seed) {
      Random random = Random::Stream(10, seed);
      const Vector3d a = seed < 3 ? Vector3d(Vector3d::Unit(seed)) : random.UnitVector3();
      const Vector3d axis = TangentBasis(a).col(seed % 2);
      const Vector3d b = angle == kPi ? Vector3d(-a) : Vector3d(ExpSO3(angle * axis) * a);
      const Matrix3d M = SmallestRotation(a, b);
      EXPECT_LT(RotationDefect(M), 1e-14);
      // Within 1e-12 of -a the rotation is a half turn; between that and 1e-3, a x b has lost the
      // digits of the axis.
      EXPECT_LT((M * a - b).norm(), 2e-12) << angle << " seed " << seed;
      EXPECT_NEAR(LogSO3(M).norm(), angle, 2e-12) << angle << " seed " << seed;
      EXPECT_LT(std::abs(LogSO3(M).dot(a)), 1e-11) << "the axis is perpendicular to a";
    }
  }
}

TEST(Pose, TangentBasisIsRightHandedAndOrthonormal) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(11, seed);
    const Vector3d v = seed < 6 ? Vector3d((seed < 3 ? 1.0 : -1.0) * Vector3d::Unit(seed % 3))
                                : random.UnitVector3();
    Matrix3d basis;
    basis << v, TangentBasis(v);
    EXPECT_LT(RotationDefect(basis), 1e-14) << seed;
  }
}

TEST(Rotation, IsRotation) {
  const Eigen::Matrix3d R = ExpSO3({0.3, -0.2, 0.5});
  EXPECT_TRUE(IsRotation(R));
  EXPECT_FALSE(IsRotation(1.001 * R));
  EXPECT_FALSE(IsRotation(-R));
  Eigen::Matrix3d nan = R;
  nan(1, 2) = std::nan("");
  EXPECT_FALSE(IsRotation(nan));
}

TEST(PartOfMotion, PartsMakeTheWhole) {
  for (int index = 0; index < 20; ++index) {
    Random random = Random::Stream(31, index);
    const Pose motion = {ExpSO3(random.Uniform(0.0, 3.0) * random.UnitVector3()),
                         random.NormalVector3()};
    const double share = random.Uniform(-1.0, 2.0);
    const Pose whole = PartOfMotion(motion, share) * PartOfMotion(motion, 1.0 - share);
    EXPECT_LT((whole.R - motion.R).norm(), 1e-13);
    EXPECT_LT((whole.t - motion.t).norm(), 1e-12);
    EXPECT_EQ(PartOfMotion(motion, 0.0).R, Pose().R);
    EXPECT_EQ(PartOfMotion(motion, 0.0).t, Pose().t);
  }
}

TEST(PartOfMotion, ItsJacobianIsTheNumericOne) {
  for (int index = 0; index < 20; ++index) {
    Random random = Random::Stream(32, index);
    const Pose motion = {ExpSO3(random.Uniform(0.0, 2.5) * random.UnitVector3()),
                         random.NormalVector3()};
    const double share = random.Uniform(-1.0, 1.0);
    const Pose part = PartOfMotion(motion, share);
    Matrix6d numeric;
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-5;
      Eigen::Matrix<double, 6, 1> change[2];
      for (int side = 0; side < 2; ++side) {
        const double step = side == 0 ? kStep : -kStep;
        Pose moved = motion;
        if (k < 3) {
          moved.R = ExpSO3(step * Eigen::Vector3d::Unit(k)) * motion.R;
        } else {
          moved.t(k - 3) += step;
        }
        const Pose of_moved = PartOfMotion(moved, share);
        change[side] << LogSO3(of_moved.R * part.R.transpose()), of_moved.t - part.t;
      }
      numeric.col(k) = (change[0] - change[1]) / (2.0 * kStep);
    }
    EXPECT_LT((PartOfMotionJacobian(motion, share) - numeric).norm(), 1e-8 * (1 + numeric.norm()));
  }
}

}  // namespace
}  // namespace rigel
