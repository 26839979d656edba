// The noise has the stated deviation and shape.
#include "rigel/problems/scenes/image_noise.h"

#include <cmath>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(ImageNoise, NamesOfModels) {
  NoiseModel model = NoiseModel::kGaussian;
  EXPECT_TRUE(ParseNoiseModel("mixture", &model));
  EXPECT_EQ(model, NoiseModel::kMixture);
  EXPECT_TRUE(ParseNoiseModel("laplace", &model));
  EXPECT_EQ(model, NoiseModel::kLaplace);
  EXPECT_TRUE(ParseNoiseModel("t3", &model));
  EXPECT_EQ(model, NoiseModel::kStudent3);
  EXPECT_TRUE(ParseNoiseModel("gaussian", &model));
  EXPECT_EQ(model, NoiseModel::kGaussian);
  EXPECT_FALSE(ParseNoiseModel("t4", &model));
}

TEST(ImageNoise, DeviationAndShape) {
  // The share of a Gaussian within 0.5 sigma, of 80 percent of 0.6 sigma and 20 of 3 sigma, of
  // Laplace's 1 - exp(-sqrt(2) x), and of Student's t with three degrees of freedom at x sqrt(3).
  const struct {
    NoiseModel model;
    double deviation, share;
  } cases[] = {{NoiseModel::kGaussian, 1.0, 0.3829},
               {NoiseModel::kMixture, std::sqrt(0.8 * 0.36 + 0.2 * 9.0), 0.5027},
               {NoiseModel::kLaplace, 1.0, 0.5069},
               {NoiseModel::kStudent3, 1.0, 0.5498}};
  for (const auto& c : cases) {
    constexpr int kDraws = 200000;
    constexpr double kSigma = 2.0;
    Random random(1);
    double sum = 0, squares = 0;
    int near = 0;
    for (int k = 0; k < kDraws / 2; ++k) {
      const Pixel noise = DrawNoise(c.model, kSigma, &random);
      for (const double x : {noise.x(), noise.y()}) {
        sum += x;
        squares += x * x;
        near += std::abs(x) < 0.5 * kSigma;
      }
    }
    EXPECT_NEAR(sum / kDraws, 0.0, 0.02);
    EXPECT_NEAR(StandardDeviation(c.model), c.deviation, 1e-12);
    // The fourth moment of t3 is infinite: its sample deviation converges slowly.
    const double tolerance = c.model == NoiseModel::kStudent3 ? 0.1 : 0.02;
    EXPECT_NEAR(std::sqrt(squares / kDraws) / kSigma, c.deviation, tolerance);
    EXPECT_NEAR(near / static_cast<double>(kDraws), c.share, 0.005);
  }
}

}  // namespace
}  // namespace rigel
