#include "rigel/core/rig.h"

#include <cmath>

#include "rigel/core/pose.h"

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
    if (!IsRotation(camera.Q)) {
      *error = name + ": Q must be a rotation matrix";
      return false;
    }
    for (const double sigma : {camera.rotation_sigma, camera.position_sigma, camera.focal_sigma}) {
      if (!(sigma >= 0) || !std::isfinite(sigma)) {
        *error = name + ": sigmas of the calibration must be finite and not negative";
        return false;
      }
    }
    if (!std::isfinite(camera.time_offset)) {
      *error = name + ": the time offset must be finite";
      return false;
    }
  }
  return true;
}

}  // namespace rigel
