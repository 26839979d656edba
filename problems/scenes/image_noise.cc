#include "rigel/problems/scenes/image_noise.h"

#include <cmath>

#include "rigel/core/enum_names.h"

namespace rigel {
namespace {

constexpr EnumName<NoiseModel> kNames[] = {{NoiseModel::kGaussian, "gaussian"},
                                           {NoiseModel::kMixture, "mixture"},
                                           {NoiseModel::kLaplace, "laplace"},
                                           {NoiseModel::kStudent3, "t3"}};

// The mixture of image_noise.h: the share of the narrow part, and the sigmas of both parts.
constexpr double kNarrowShare = 0.8;
constexpr double kNarrow = 0.6;
constexpr double kWide = 3.0;

double DrawCoordinate(NoiseModel model, Random* random) {
  switch (model) {
    case NoiseModel::kGaussian:
      break;
    case NoiseModel::kMixture: {
      const double sigma = random->Uniform() < kNarrowShare ? kNarrow : kWide;
      return sigma * random->Normal();
    }
    case NoiseModel::kLaplace: {
      const double sign = random->Index(2) == 1 ? 1.0 : -1.0;
      return -sign * std::log(1.0 - random->Uniform()) / std::sqrt(2.0);
    }
    case NoiseModel::kStudent3: {
      // t = x sqrt(3) / |y| with the standard deviation sqrt(3).
      const double x = random->Normal();
      return x / random->NormalVector3().norm();
    }
  }
  return random->Normal();
}

}  // namespace

bool ParseNoiseModel(std::string_view name, NoiseModel* model) {
  return FindValue(kNames, name, model);
}

double StandardDeviation(NoiseModel model) {
  if (model != NoiseModel::kMixture) return 1.0;
  return std::sqrt(kNarrowShare * kNarrow * kNarrow + (1.0 - kNarrowShare) * kWide * kWide);
}

Pixel DrawNoise(NoiseModel model, double sigma_px, Random* random) {
  const double x = DrawCoordinate(model, random);
  const double y = DrawCoordinate(model, random);
  return {sigma_px * x, sigma_px * y};
}

}  // namespace rigel
