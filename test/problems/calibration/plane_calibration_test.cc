// A known plane is found within the stated uncertainty. What the motions do not determine is said.
#include "rigel/problems/calibration/plane_calibration.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/problems/calibration/drive.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(PlaneCalibration, NormalIsFoundWithinItsSigma) {
  constexpr int kSeeds = 100;
  const Eigen::Vector3d truth = kTilted.transpose() * kY;
  double tilt = 0.0, roll = 0.0;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    const PlaneCalibration plane = CalibratePlane(Drive({}, kTilted, kTilted, seed), kY);
    ASSERT_EQ(plane.level, CalibrationLevel::kFull) << plane.message;
    EXPECT_THAT(plane.message, IsEmpty());
    EXPECT_LT(AngleDeg(plane.normal, truth), 1.5);
    const Eigen::Vector3d along = (plane.driving - truth * truth.dot(plane.driving)).normalized();
    tilt += std::pow(plane.normal.dot(along) / plane.tilt_sigma, 2) / kSeeds;
    roll += std::pow(plane.normal.dot(truth.cross(along)) / plane.roll_sigma, 2) / kSeeds;
    EXPECT_LT(RadToDeg(plane.tilt_sigma), 0.1);
    EXPECT_NEAR(RadToDeg(plane.translation_spread), 0.5, 0.25);
    EXPECT_NEAR(RadToDeg(plane.rotation_spread), 0.1, 0.04);
  }
  // 1 for a right sigma, 0.14 its own standard deviation.
  EXPECT_NEAR(tilt, 1.0, 0.5);
  EXPECT_NEAR(roll, 1.0, 0.5);
}

TEST(PlaneCalibration, StraightDriveLeavesTheRoll) {
  DriveOptions straight;
  straight.yaw_deg = 0.0;
  for (const int pairs : {50, 5000}) {
    straight.pairs = pairs;
    const PlaneCalibration plane = CalibratePlane(Drive(straight, kTilted, kTilted, 1), kY);
    ASSERT_EQ(plane.level, CalibrationLevel::kTilt);
    EXPECT_THAT(plane.message, HasSubstr("roll"));
    EXPECT_EQ(plane.roll_sigma, -1.0);
    // The plane holds the direction of driving, its roll is the start's.
    EXPECT_NEAR(AngleDeg(plane.normal, kTilted.transpose() * Eigen::Vector3d::UnitZ()), 90.0, 0.3);
    EXPECT_NEAR(plane.normal.x(), 0.0, 1e-3);
    EXPECT_NEAR(AngleDeg(plane.normal, kY), 1.2, 0.3);
  }
}

// The noise of rotations has an axis in each clip, now and then near the start.
TEST(PlaneCalibration, RollOfNoiseIsNotBelieved) {
  DriveOptions straight;
  straight.yaw_deg = 0.0;
  straight.pairs = 50;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const PlaneCalibration plane = CalibratePlane(Drive(straight, kTilted, kTilted, seed), kY);
    EXPECT_EQ(plane.level, CalibrationLevel::kTilt) << seed;
  }
}

TEST(PlaneCalibration, OutliersDoNotMoveIt) {
  DriveOptions options;
  options.outliers = 15;
  const PlaneCalibration plane = CalibratePlane(Drive(options, kTilted, kTilted, 3), kY);
  ASSERT_EQ(plane.level, CalibrationLevel::kFull) << plane.message;
  EXPECT_LT(AngleDeg(plane.normal, kTilted.transpose() * kY), 0.5);
}

TEST(PlaneCalibration, WhatHasNoPlaneIsSaid) {
  std::vector<CalibrationMotion> motions = Drive({}, kTilted, kTilted, 4);
  for (size_t k = 9; k < motions.size(); ++k) motions[k].has_direction = false;
  const PlaneCalibration few = CalibratePlane(motions, kY);
  EXPECT_EQ(few.level, CalibrationLevel::kNone);
  EXPECT_THAT(few.message, HasSubstr("too few motions with a direction of translation: 9"));
  EXPECT_EQ(few.normal, kY);

  // Motions of anything, and a plane that stands upright.
  DriveOptions wild;
  wild.outliers = wild.pairs;
  EXPECT_EQ(CalibratePlane(Drive(wild, kTilted, kTilted, 5), kY).level, CalibrationLevel::kNone);
  const Eigen::Matrix3d upright = ExpSO3({DegToRad(60.0), 0, 0});
  EXPECT_EQ(CalibratePlane(Drive({}, upright, upright, 6), kY).level, CalibrationLevel::kNone);
  EXPECT_EQ(CalibratePlane({}, kY).level, CalibrationLevel::kNone);
}

// What stood in the way is what is named.
TEST(PlaneCalibration, AWrongStartIsBlamedForWhatItIs) {
  // Turns in a plane that is not across the start.
  const Eigen::Matrix3d upright = ExpSO3({DegToRad(60.0), 0, 0});
  const PlaneCalibration far = CalibratePlane(Drive({}, upright, upright, 6), kY);
  EXPECT_EQ(far.level, CalibrationLevel::kNone);
  EXPECT_EQ(far.normal, kY);
  EXPECT_THAT(far.message, AllOf(HasSubstr("lie in a plane, but across"),
                                 HasSubstr("degrees from the start +y"), HasSubstr("--down")));
  EXPECT_NEAR(std::stod(far.message.substr(far.message.find(" degrees") - 4)), 60.0, 0.3);
  // Straight ahead along what is said to be down.
  DriveOptions straight;
  straight.yaw_deg = 0.0;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const PlaneCalibration along = CalibratePlane(Drive(straight, I, I, 7), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(along.level, CalibrationLevel::kNone);
  EXPECT_THAT(along.message, AllOf(HasSubstr("most translations go along"),
                                   HasSubstr("out of the plane across the start +z")));
  // Nothing is wrong with the start where the motions are of no plane.
  DriveOptions wild;
  wild.bumps_deg = 60.0;
  wild.vibration_deg = 20.0;
  const PlaneCalibration scatter = CalibratePlane(Drive(wild, I, I, 8), kY);
  EXPECT_EQ(scatter.level, CalibrationLevel::kNone);
  EXPECT_THAT(scatter.message, AllOf(HasSubstr("scatter too much"), HasSubstr("at most 1.0")));
}

TEST(PlaneCalibration, AStartThatIsNoDirectionIsRefused) {
  const std::vector<CalibrationMotion> motions = Drive({}, kTilted, kTilted, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Eigen::Vector3d& start :
       {Eigen::Vector3d(0, nan, 0), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(HUGE_VAL, 0, 0)}) {
    const PlaneCalibration plane = CalibratePlane(motions, start);
    EXPECT_EQ(plane.level, CalibrationLevel::kNone);
    EXPECT_THAT(plane.message, HasSubstr("the start is no direction"));
    EXPECT_TRUE(plane.normal.allFinite());
  }
}

}  // namespace
}  // namespace rigel
