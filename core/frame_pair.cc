#include "rigel/core/frame_pair.h"

#include <cmath>

namespace rigel {

bool FramePair::IsValid(std::string* error) const {
  if (!rig.IsValid(error)) return false;
  for (size_t k = 0; k < matches.size(); ++k) {
    const Match& m = matches[k];
    if (m.camera1 < 0 || m.camera1 >= rig.size() || m.camera2 < 0 || m.camera2 >= rig.size()) {
      *error = "match " + std::to_string(k) + ": names a camera outside 0.." +
               std::to_string(rig.size() - 1);
      return false;
    }
    if (!m.pixel1.allFinite() || !m.pixel2.allFinite()) {
      *error = "match " + std::to_string(k) + ": a pixel is not finite";
      return false;
    }
  }
  if (!columns.IsValid(matches.size(), error)) return false;
  for (const auto* time : {&time1, &time2}) {
    if (time->has_value() && !std::isfinite(**time)) {
      *error = "a time is not finite";
      return false;
    }
  }
  for (int k = 0; k < rig.size(); ++k) {
    if (rig.cameras[k].time_offset == 0 || Interval() > 0) continue;
    *error = "camera " + std::to_string(k) +
             " fires at another time: that needs the two times of the pair, in order";
    return false;
  }
  if (truth && !(truth->AllFinite() && IsRotation(truth->R))) {
    *error = "the truth is not a finite motion with a rotation matrix";
    return false;
  }
  if (noise_px && !(*noise_px > 0 && std::isfinite(*noise_px))) {
    *error = "noise_px must be positive and finite";
    return false;
  }
  return prior.IsValid(error);
}

}  // namespace rigel
