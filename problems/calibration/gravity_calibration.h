// The mounting of an IMU: the rotation from the frame of the stated gravity to the body.
#ifndef RIGEL_PROBLEMS_CALIBRATION_GRAVITY_CALIBRATION_H_
#define RIGEL_PROBLEMS_CALIBRATION_GRAVITY_CALIBRATION_H_

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/problems/calibration/prior_calibration.h"

namespace rigel {

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

// The rotation C for which R C g1 = C g2 in most motions. A motion without rotation does not
// constrain C. Rotations about the vertical determine the tilt of C; only rotations about other
// axes determine the rotation of C about the vertical.
GravityCalibration CalibrateGravity(const std::vector<CalibrationMotion>& motions);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_GRAVITY_CALIBRATION_H_
