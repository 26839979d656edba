#include "rigel/core/metrics.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

using Eigen::Vector3d;

const double kAngles[] = {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 2.0, 3.0, kPi - 1e-6, kPi - 1e-9, kPi};

TEST(Metrics, RotationErrorIsExactFromZeroToPi) {
  // arccos((trace - 1) / 2) would return 0 for 1e-9.
  for (const double angle : kAngles) {
    for (int seed = 0; seed < 20; ++seed) {
      Random random = Random::Stream(1, seed);
      const Eigen::Matrix3d R_gt = ExpSO3(random.NormalVector3());
      const Eigen::Matrix3d R = ExpSO3(angle * random.UnitVector3()) * R_gt;
      EXPECT_NEAR(RotationError(R_gt, R), angle, 3e-15) << seed;
      EXPECT_NEAR(RotationError(R, R_gt), angle, 3e-15) << seed;
    }
  }
}

TEST(Metrics, DirectionErrorIsExactFromZeroToPi) {
  for (const double angle : kAngles) {
    for (int seed = 0; seed < 20; ++seed) {
      Random random = Random::Stream(2, seed);
      const Vector3d t_gt = 3.0 * random.UnitVector3();
      const Vector3d t = 0.2 * (ExpSO3(angle * TangentBasis(t_gt.normalized()).col(0)) * t_gt);
      EXPECT_NEAR(TranslationDirectionError(t_gt, t), angle, 3e-15) << seed;
    }
  }
}

TEST(Metrics, DirectionOfZeroIsNan) {
  const Vector3d t(1, 2, 3);
  EXPECT_TRUE(std::isnan(TranslationDirectionError(Vector3d::Zero(), t)));
  EXPECT_TRUE(std::isnan(TranslationDirectionError(t, Vector3d::Zero())));
  EXPECT_TRUE(std::isnan(TranslationDirectionError(Vector3d::Zero(), Vector3d::Zero())));
}

TEST(Metrics, ScaleErrorIsAFractionOfTheTruth) {
  const Vector3d t(0, 3, 4);
  EXPECT_NEAR(ScaleError(t, {5.5, 0, 0}), 0.1, 1e-15);
  EXPECT_NEAR(ScaleError(t, {4.5, 0, 0}), 0.1, 1e-15);
  EXPECT_EQ(ScaleError(t, Vector3d::Zero()), 1.0);
  EXPECT_EQ(ScaleError(t, -t), 0.0) << "the sign is the direction's matter";
  EXPECT_TRUE(std::isnan(ScaleError(Vector3d::Zero(), t)));
}

TEST(Metrics, AngleBetweenDirectionsOfAnyLength) {
  EXPECT_DOUBLE_EQ(AngleBetween({2, 0, 0}, {0, 0, 3}), std::acos(0.0));
  EXPECT_DOUBLE_EQ(AngleBetween({1, 0, 0}, {-5, 0, 0}), std::acos(-1.0));
  EXPECT_DOUBLE_EQ(AngleBetween({1, 0, 0}, {1, 1e-9, 0}), 1e-9);
  EXPECT_EQ(AngleBetween({1, 0, 0}, Vector3d::Zero()), 0.0);
}

TEST(Metrics, NanGoesThrough) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector3d t(1, 2, 3);
  EXPECT_TRUE(std::isnan(TranslationDirectionError(t, {nan, 1, 1})));
  EXPECT_TRUE(std::isnan(ScaleError(t, {nan, 1, 1})));
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R(0, 1) = nan;
  EXPECT_TRUE(std::isnan(RotationError(Eigen::Matrix3d::Identity(), R)));
}

}  // namespace
}  // namespace rigel
