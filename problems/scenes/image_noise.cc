#include "rigel/problems/scenes/image_noise.h"

#include <cmath>

#include "rigel/core/enum_names.h"

namespace rigel {
namespace {

constexpr EnumName<NoiseShape> kNames[] = {{NoiseShape::kGaussian, "gaussian"},
                                           {NoiseShape::kMixture, "mixture"},
                                           {NoiseShape::kLaplace, "laplace"},
                                           {NoiseShape::kStudent3, "t3"}};

// The mixture of image_noise.h: the share of the narrow part, and the sigmas of both parts.
constexpr double kNarrowShare = 0.8;
constexpr double kNarrow = 0.6;
constexpr double kWide = 3.0;

double DrawCoordinate(NoiseShape shape, Random* random) {
  switch (shape) {
    case NoiseShape::kGaussian:
      break;
    case NoiseShape::kMixture: {
      const double sigma = random->Uniform() < kNarrowShare ? kNarrow : kWide;
      return sigma * random->Normal();
    }
    case NoiseShape::kLaplace: {
      const double sign = random->Index(2) == 1 ? 1.0 : -1.0;
      return -sign * std::log(1.0 - random->Uniform()) / std::sqrt(2.0);
    }
    case NoiseShape::kStudent3: {
      // t = x sqrt(3) / |y| with the standard deviation sqrt(3).
      const double x = random->Normal();
      return x / random->NormalVector3().norm();
    }
  }
  return random->Normal();
}

}  // namespace

bool ParseNoiseShape(std::string_view name, NoiseShape* shape) {
  return FindValue(kNames, name, shape);
}

double StandardDeviation(NoiseShape shape) {
  if (shape != NoiseShape::kMixture) return 1.0;
  return std::sqrt(kNarrowShare * kNarrow * kNarrow + (1.0 - kNarrowShare) * kWide * kWide);
}

Pixel DrawNoise(NoiseShape shape, double sigma_px, Random* random) {
  const double x = DrawCoordinate(shape, random);
  const double y = DrawCoordinate(shape, random);
  return {sigma_px * x, sigma_px * y};
}

}  // namespace rigel
