#include "rigel/core/rig.h"

#include <cmath>

#include <Eigen/LU>

namespace rigel {

bool Rig::IsValid(std::string* error) const {
  for (size_t k = 0; k < cameras.size(); ++k) {
    const RigCamera& camera = cameras[k];
    const PinholeCamera& c = camera.intrinsics;
    const std::string name = "camera " + std::to_string(k);
    if (!(c.fx > 0 && c.fy > 0) || !std::isfinite(c.fx) || !std::isfinite(c.fy)) {
      *error = name + ": focal lengths must be positive and finite";
      return false;
    }
    if (!std::isfinite(c.cx) || !std::isfinite(c.cy) || !camera.s.allFinite()) {
      *error = name + ": principal point and position must be finite";
      return false;
    }
    const Eigen::Matrix3d QtQ = camera.Q.transpose() * camera.Q;
    if (!camera.Q.allFinite() || !((QtQ - Eigen::Matrix3d::Identity()).norm() < 1e-6) ||
        camera.Q.determinant() < 0) {
      *error = name + ": Q must be a rotation matrix";
      return false;
    }
  }
  return true;
}

}  // namespace rigel
