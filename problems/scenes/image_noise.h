// Noise of image points in synthetic scenes.
#ifndef RIGEL_PROBLEMS_SCENES_IMAGE_NOISE_H_
#define RIGEL_PROBLEMS_SCENES_IMAGE_NOISE_H_

#include "rigel/core/eigen_types.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

// The standard deviation of the noise for a sigma of 1: that of the mixture is 1.445.
double StandardDeviation(NoiseShape shape);

// Independent noise on both coordinates.
Pixel DrawNoise(NoiseShape shape, double sigma_px, Random* random);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_IMAGE_NOISE_H_
