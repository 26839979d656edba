// A known mounting is found within the stated uncertainty. What the motions do not determine is
// said.
#include "rigel/problems/calibration/gravity_calibration.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/problems/calibration/drive.h"

namespace rigel {
namespace {

using testing::HasSubstr;

TEST(GravityCalibration, TurnsGiveTheTiltWithinItsSigma) {
  constexpr int kSeeds = 100;
  DriveOptions options;
  options.gravity_deg = 0.02;
  options.vibration_deg = 0.02;
  double squares = 0.0;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    const GravityCalibration gravity =
        CalibrateGravity(Drive(options, Eigen::Matrix3d::Identity(), kTilted, seed));
    ASSERT_EQ(gravity.level, CalibrationLevel::kTilt) << gravity.message;
    EXPECT_THAT(gravity.message, HasSubstr("turn about the vertical"));
    // Where the vertical is said to be.
    const double off = DegToRad(AngleDeg(gravity.C * kTilted.transpose() * kY, kY));
    squares += off * off / (2 * gravity.tilt_sigma * gravity.tilt_sigma) / kSeeds;
    EXPECT_LT(RadToDeg(gravity.tilt_sigma), 0.5);
  }
  EXPECT_GT(squares, 0.3);  // noise of shared frames cancels in part
  EXPECT_LT(squares, 1.5);
}

TEST(GravityCalibration, HillsGiveTheWholeRotation) {
  DriveOptions options;
  options.pairs = 300;
  options.gravity_deg = 0.02;
  options.vibration_deg = 0.02;
  options.pitch_deg = 2.0;
  const Eigen::Matrix3d C = ExpSO3({0.03, 0.02, -0.01});
  const GravityCalibration gravity =
      CalibrateGravity(Drive(options, Eigen::Matrix3d::Identity(), C, 1));
  ASSERT_EQ(gravity.level, CalibrationLevel::kFull) << gravity.message;
  EXPECT_GT(gravity.yaw_sigma, 0);
  const double off = LogSO3(gravity.C * C.transpose()).norm();
  EXPECT_LT(off, 3 * std::hypot(gravity.yaw_sigma, std::sqrt(2.0) * gravity.tilt_sigma));
  EXPECT_LT(RadToDeg(off), 0.3);
}

TEST(GravityCalibration, NoiseAboutOtherAxesIsNoHill) {
  DriveOptions options;
  options.pairs = 20000;
  options.gravity_deg = 0.1;
  EXPECT_EQ(CalibrateGravity(Drive(options, Eigen::Matrix3d::Identity(), kTilted, 1)).level,
            CalibrationLevel::kTilt);
}

TEST(GravityCalibration, StraightDriveGivesNothing) {
  DriveOptions straight;
  straight.yaw_deg = 0.0;
  straight.gravity_deg = 0.1;
  for (const int pairs : {50, 5000}) {
    straight.pairs = pairs;
    const GravityCalibration gravity =
        CalibrateGravity(Drive(straight, Eigen::Matrix3d::Identity(), kTilted, 2));
    EXPECT_EQ(gravity.level, CalibrationLevel::kNone);
    EXPECT_THAT(gravity.message, HasSubstr("too little rotation"));
    EXPECT_EQ(gravity.C, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  }
  // Turns enough, in the frame of an IMU that stands on end.
  DriveOptions hills;
  hills.pairs = 300;
  hills.pitch_deg = 2.0;
  hills.vibration_deg = 0.02;
  const GravityCalibration on_end = CalibrateGravity(
      Drive(hills, Eigen::Matrix3d::Identity(), ExpSO3({DegToRad(50.0), 0, 0}), 3));
  EXPECT_EQ(on_end.level, CalibrationLevel::kNone);
  EXPECT_THAT(on_end.message, HasSubstr("turned by 50.0 degrees against the body"));
  std::vector<CalibrationMotion> none = Drive({}, kTilted, kTilted, 1);
  for (CalibrationMotion& motion : none) motion.prior.gravity2.reset();
  EXPECT_THAT(CalibrateGravity(none).message, HasSubstr("too few pairs that state gravity1"));
}

}  // namespace
}  // namespace rigel
