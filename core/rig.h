// The calibrated camera rig: where each camera sits on the body.
#ifndef RIGEL_CORE_RIG_H_
#define RIGEL_CORE_RIG_H_

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/camera.h"
#include "rigel/core/eigen_types.h"

namespace rigel {

// body_from_camera: X_body = Q X_cam + s (metres), the same at both times.
struct RigCamera {
  Camera intrinsics;  // raw pixels of any lens, or undistorted ones of a pinhole
  Eigen::Matrix3d Q = Eigen::Matrix3d::Identity();
  Eigen::Vector3d s = Eigen::Vector3d::Zero();
  // The stated error of the calibration, 1 sigma. 0: nothing is stated.
  double rotation_sigma = 0.0;  // of Q, radians per axis
  double position_sigma = 0.0;  // of s, metres per axis
  double focal_sigma = 0.0;     // of both focal lengths alike, as a fraction
  // Seconds that the camera fires after the times of the pair. Negative: before them.
  double time_offset = 0.0;
};
static_assert(kSameLayoutEverywhere<RigCamera>, "no member of RigCamera may be aligned");

// Camera k of the paper is rig.cameras[k].
struct Rig {
  std::vector<RigCamera> cameras;

  int size() const { return static_cast<int>(cameras.size()); }

  // False with a message if a number is not finite, the intrinsics are not valid (camera.h), a
  // sigma is negative or a Q is not a rotation.
  bool IsValid(std::string* error) const;
};

}  // namespace rigel

#endif  // RIGEL_CORE_RIG_H_
