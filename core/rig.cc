#include "rigel/core/rig.h"

#include <cmath>

#include "rigel/core/pose.h"

namespace rigel {

bool Rig::IsValid(std::string* error) const {
  for (size_t k = 0; k < cameras.size(); ++k) {
    const RigCamera& camera = cameras[k];
    const std::string name = "camera " + std::to_string(k);
    std::string what;
    if (!camera.intrinsics.IsValid(&what)) {
      *error = name + ": " + what;
      return false;
    }
    if (!camera.s.allFinite()) {
      *error = name + ": the position must be finite";
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
