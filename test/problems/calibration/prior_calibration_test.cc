// A known plane and a known mounting are found within the stated uncertainty; what the motions do
// not determine is said.
#include "rigel/problems/calibration/prior_calibration.h"

#include <cmath>

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

const Eigen::Vector3d kY = Eigen::Vector3d::UnitY();

struct DriveOptions {
  int pairs = 100;
  double yaw_deg = 2.0;        // of the largest turns between two frames
  double vibration_deg = 0.1;  // 1-sigma of rotations about each axis
  double bumps_deg = 0.5;      // 1-sigma of the directions of translation
  double pitch_deg = 0.0;      // of hills: largest turns about X
  double gravity_deg = 0.0;    // 1-sigma of the stated directions
  int outliers = 0;            // motions of anything
};

// A drive whose plane has the normal A' Y in the body frame, and whose stated gravity, C' times the
// body's, is Y on level ground but for C.
std::vector<CalibrationMotion> Drive(const DriveOptions& options, const Eigen::Matrix3d& A,
                                     const Eigen::Matrix3d& C, uint64_t seed) {
  Random random(seed);
  std::vector<CalibrationMotion> motions;
  Eigen::Matrix3d body_from_world = A.transpose();  // the body's Y is the world's but for A
  const auto stated = [&](const Eigen::Matrix3d& from_world) {
    const Eigen::Matrix3d noise = ExpSO3(DegToRad(options.gravity_deg) * random.NormalVector3());
    return Eigen::Vector3d(C.transpose() * noise * from_world * kY);
  };
  Eigen::Vector3d gravity = stated(body_from_world);
  for (int k = 0; k < options.pairs; ++k) {
    const double yaw = DegToRad(options.yaw_deg) * std::sin(0.1 * k);
    const double pitch = DegToRad(options.pitch_deg) * std::cos(0.13 * k);
    CalibrationMotion motion;
    const Eigen::Matrix3d turn = ExpSO3({pitch, yaw, 0});
    const Eigen::Matrix3d true_R = A.transpose() * turn * A;
    motion.pose.R = ExpSO3(DegToRad(options.vibration_deg) * random.NormalVector3()) * true_R;
    const Eigen::Matrix3d bump = ExpSO3(DegToRad(options.bumps_deg) * random.NormalVector3());
    motion.pose.t = A.transpose() * bump * RotationY(0.5 * yaw) * Eigen::Vector3d(0, 0, -1);
    body_from_world = true_R * body_from_world;
    motion.prior.gravity1 = gravity;
    motion.prior.gravity2 = gravity = stated(body_from_world);
    if (k < options.outliers) {
      motion.pose.R = ExpSO3(0.05 * random.NormalVector3());
      motion.pose.t = random.UnitVector3();
    }
    motions.push_back(motion);
  }
  return motions;
}

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

const Eigen::Matrix3d kTilted = ExpSO3({DegToRad(1.2), 0, DegToRad(1.6)});  // 2 degrees

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
