// The motion plane and the mounting of an IMU, from the motions of a clip.
//
// Priors are stated in the body frame. A camera that defines the body is rarely level, and an IMU
// is rarely aligned with it. Two constants of the vehicle describe this: the normal of the plane of
// motion (plane_calibration.h), and the rotation from the frame of the stated gravity to the body
// (gravity_calibration.h). Both are estimated from motions that were estimated without a prior.
//
// All motions are of one vehicle. Errors of different pairs are assumed independent.
#ifndef RIGEL_PROBLEMS_CALIBRATION_PRIOR_CALIBRATION_H_
#define RIGEL_PROBLEMS_CALIBRATION_PRIOR_CALIBRATION_H_

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/pose.h"
#include "rigel/core/prior.h"

namespace rigel {

// How much of the calibration is determined.
enum class CalibrationLevel {
  kNone,
  kTilt,  // plane: its tilt towards the driving direction; gravity: the vertical in the body
  kFull,  // plane: the normal; gravity: the whole rotation
};

const char* CalibrationLevelName(CalibrationLevel level);  // "none", "tilt", "full"

// Degrees. An angle with a larger standard deviation counts as not determined: it is not better
// than the assumption of zero.
inline constexpr double kMaxCalibrationSigmaDeg = 1.0;
// Degrees. A result that is farther from the start is rejected: the axes are then stated wrongly.
inline constexpr double kMaxCalibrationTurnDeg = 30.0;
// Motions. With fewer the spread of the residuals, and so the sigmas, would be too inaccurate.
inline constexpr int kMinCalibrationPairs = 10;

// An estimated motion and what of it is observable.
struct CalibrationMotion {
  Pose pose;  // of one point of the body, the rig's centre at best: MotionOfPoint()
  bool has_rotation = true;
  bool has_direction = true;  // of pose.t
  MotionPrior prior;          // as stated, for its gravity
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_PRIOR_CALIBRATION_H_
