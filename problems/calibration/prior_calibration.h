// The motion plane and the mounting of an IMU, from the motions of a clip.
//
// Priors are stated in the body frame, but a camera that is the body is rarely level and an IMU
// rarely aligned: the normal of the plane that the body moves in, and the rotation from the frame
// of the stated gravity to the body, are constants of the vehicle. Both show in motions that were
// estimated without them.
//
// All figures are over pairs of one vehicle; errors of pairs are taken as independent.
#ifndef RIGEL_PROBLEMS_CALIBRATION_PRIOR_CALIBRATION_H_
#define RIGEL_PROBLEMS_CALIBRATION_PRIOR_CALIBRATION_H_

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/pose.h"
#include "rigel/core/prior.h"

namespace rigel {

// What is determined.
enum class CalibrationLevel {
  kNone,
  kTilt,  // plane: its tilt towards the driving direction; gravity: the vertical in the body
  kFull,  // plane: the normal; gravity: the whole rotation
};

const char* CalibrationLevelName(CalibrationLevel level);  // "none", "tilt", "full"

// What has a larger standard deviation than this is not determined: no gain over the assumption
// that it is zero.
inline constexpr double kMaxCalibrationSigmaDeg = 1.0;
// Answers farther from the start than this are not believed.
inline constexpr double kMaxCalibrationTurnDeg = 30.0;
// Motions. The residuals of fewer would say little about their own spread, and so about the sigmas.
inline constexpr int kMinCalibrationPairs = 10;

// An estimated motion and what of it is observable.
struct CalibrationMotion {
  Pose pose;  // of one point of the body, the rig's centre at best: MotionOfPoint()
  bool has_rotation = true;
  bool has_direction = true;  // of pose.t
  MotionPrior prior;          // as stated, for its gravity
};

struct PlaneCalibration {
  CalibrationLevel level = CalibrationLevel::kNone;
  std::string message;  // why the level is not kFull
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
  Eigen::Vector3d driving = Eigen::Vector3d::UnitZ();  // direction of most translations, up to sign
  double tilt_sigma = -1.0;  // radians, towards `driving`; -1 if not determined
  double roll_sigma = -1.0;  // radians, about `driving`; -1 if not determined
  // 1-sigma of single motions: angle of translations out of the plane, and rotation (radians) about
  // each axis in the plane.
  double translation_spread = -1.0;
  double rotation_spread = -1.0;
  int translations = 0, rotations = 0;  // motions that were used
};

// The normal n for which, in most motions, t lies in the plane (t . n = 0) and the rotation is
// about n. Translations along one line say nothing of the roll of the plane about it, and a drive
// without turns has no other: the roll is then that of `start`. Least squares with Cauchy weights;
// the uncertainty is that of the residuals as they are (sandwich estimate). kNone, with a message,
// if `start` is not finite or zero.
PlaneCalibration CalibratePlane(const std::vector<CalibrationMotion>& motions,
                                const Eigen::Vector3d& start);

struct GravityCalibration {
  CalibrationLevel level = CalibrationLevel::kNone;
  std::string message;  // why the level is not kFull
  // Body from the frame of the stated directions: gravity is C g. At kTilt without a turn about the
  // vertical.
  Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
  double tilt_sigma = -1.0;  // radians, of C g, the larger of two; -1 if not determined
  double yaw_sigma = -1.0;   // radians, about C g; -1 if not determined
  double spread = -1.0;      // radians, 1-sigma per axis of R C g1 - C g2
  int pairs = 0;             // that turn by enough to be used
};

// The rotation C for which R C g1 = C g2 in most motions. A motion without rotation holds for any
// C; turns about the vertical give the tilt, only others the turn of C about it.
GravityCalibration CalibrateGravity(const std::vector<CalibrationMotion>& motions);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_PRIOR_CALIBRATION_H_
