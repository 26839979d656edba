// What counts as the rotation matrix of a file.
#include "rigel/problems/io/rotation_check.h"

#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/pose.h"

namespace rigel {
namespace {

TEST(RotationCheck, RotationsWithinTheTolerance) {
  const Eigen::Matrix3d R = ExpSO3({0.3, -0.2, 0.9});
  EXPECT_TRUE(IsNearRotation(R));
  EXPECT_TRUE(IsNearRotation(1.0004 * R));
  EXPECT_FALSE(IsNearRotation(1.0006 * R)) << "R'R is off by 1.2e-3";
  EXPECT_FALSE(IsNearRotation(-R)) << "a reflection";
  Eigen::Matrix3d broken = R;
  broken(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IsNearRotation(broken));
}

}  // namespace
}  // namespace rigel
