// Defaults in pixels, for cameras of any focal length.
//
// The defaults are made for focal lengths of a few hundred pixels. With normalised image
// coordinates (fx = 1) or small images a pixel is a larger angle. There a default is a share of the
// focal length.
#ifndef RIGEL_CORE_PIXEL_UNIT_H_
#define RIGEL_CORE_PIXEL_UNIT_H_

#include "rigel/core/rig.h"

namespace rigel {

// As a threshold: DefaultThresholdPx().
inline constexpr double kAutoThresholdPx = 0.0;

// One, or 1/450 of the shortest focal length of the rig where that is less.
double PixelUnit(const Rig& rig);

// Squares of thresholds beyond these may be zero or infinite.
inline constexpr double kMinThresholdPx = 1e-12;
inline constexpr double kMaxThresholdPx = 1e12;

// 1.5 pixels, or 1/300 of the shortest focal length where that is less; kMinThresholdPx at least.
double DefaultThresholdPx(const Rig& rig);

// `threshold_px`, or the default where it is kAutoThresholdPx.
double ThresholdPx(double threshold_px, const Rig& rig);

}  // namespace rigel

#endif  // RIGEL_CORE_PIXEL_UNIT_H_
