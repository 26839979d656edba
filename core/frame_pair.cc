#include "rigel/core/frame_pair.h"

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
  return true;
}

}  // namespace rigel
