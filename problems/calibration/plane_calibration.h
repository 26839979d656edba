// The plane that a vehicle moves in, from the motions of a drive.
#ifndef RIGEL_PROBLEMS_CALIBRATION_PLANE_CALIBRATION_H_
#define RIGEL_PROBLEMS_CALIBRATION_PLANE_CALIBRATION_H_

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/problems/calibration/prior_calibration.h"

namespace rigel {

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
// about n. Least squares with Cauchy weights; the uncertainty is the sandwich estimate of the
// residuals. Translations along one line do not determine the roll of the plane about this line. A
// drive without turns has only such translations: the roll is then that of `start`. kNone, with a
// message, if `start` is not finite or zero.
PlaneCalibration CalibratePlane(const std::vector<CalibrationMotion>& motions,
                                const Eigen::Vector3d& start);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_PLANE_CALIBRATION_H_
