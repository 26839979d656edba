#include "rigel/core/pixel_unit.h"

#include <algorithm>

namespace rigel {

double PixelUnit(const Rig& rig) {
  // Pixels. At a shorter focal length a default in pixels is a share of it: of 1.5 px, the default
  // threshold, 1/300.
  constexpr double kFocal = 450.0;
  double shortest = kFocal;
  for (const RigCamera& camera : rig.cameras) {
    shortest = std::min(shortest, camera.intrinsics.PixelsPerRadian().minCoeff());
  }
  return shortest / kFocal;
}

double DefaultThresholdPx(const Rig& rig) {
  // Pixels: three sigma of 0.5 px, about the noise of keypoints.
  constexpr double kDefaultThresholdPx = 1.5;
  return std::max(kDefaultThresholdPx * PixelUnit(rig), kMinThresholdPx);
}

double ThresholdPx(double threshold_px, const Rig& rig) {
  return threshold_px == kAutoThresholdPx ? DefaultThresholdPx(rig) : threshold_px;
}

}  // namespace rigel
