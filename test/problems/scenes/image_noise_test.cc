// The noise has the stated deviation and shape.
#include "rigel/problems/scenes/image_noise.h"

#include <cmath>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(ImageNoise, NamesOfModels) {
  NoiseShape model = NoiseShape::kGaussian;
  EXPECT_TRUE(ParseNoiseShape("mixture", &model));
  EXPECT_EQ(model, NoiseShape::kMixture);
  EXPECT_TRUE(ParseNoiseShape("laplace", &model));
  EXPECT_EQ(model, NoiseShape::kLaplace);
  EXPECT_TRUE(ParseNoiseShape("t3", &model));
  EXPECT_EQ(model, NoiseShape::kStudent3);
  EXPECT_TRUE(ParseNoiseShape("gaussian", &model));
  EXPECT_EQ(model, NoiseShape::kGaussian);
  EXPECT_FALSE(ParseNoiseShape("t4", &model));
}

TEST(ImageNoise, DeviationAndShape) {
  // The share of a Gaussian within 0.5 sigma, of 80 percent of 0.6 sigma and 20 of 3 sigma, of
  // Laplace's 1 - exp(-sqrt(2) x), and of Student's t with three degrees of freedom at x sqrt(3).
  const struct {
    NoiseShape model;
    double deviation, share;
  } cases[] = {{NoiseShape::kGaussian, 1.0, 0.3829},
               {NoiseShape::kMixture, std::sqrt(0.8 * 0.36 + 0.2 * 9.0), 0.5027},
               {NoiseShape::kLaplace, 1.0, 0.5069},
               {NoiseShape::kStudent3, 1.0, 0.5498}};
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
    const double tolerance = c.model == NoiseShape::kStudent3 ? 0.1 : 0.02;
    EXPECT_NEAR(std::sqrt(squares / kDraws) / kSigma, c.deviation, tolerance);
    EXPECT_NEAR(near / static_cast<double>(kDraws), c.share, 0.005);
  }
}

}  // namespace
}  // namespace rigel
