// The loss of MAGSAC++ against its definition, integrated numerically.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/score_kernel.h"

namespace rigel {
namespace {

// The weight of a residual r is the mean over the noise levels sigma in [r / k, sigma_max] of the
// density of |r| at sigma, and the loss is the integral of r times the weight.
double Weight(double r, double sigma_max, double k) {
  constexpr int kSteps = 4000;
  const double low = r / k;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double sigma = low + (sigma_max - low) * (i + 0.5) / kSteps;
    sum += std::exp(-r * r / (2 * sigma * sigma)) / sigma;
  }
  return sum * (sigma_max - low) / kSteps;
}

TEST(MagsacTable, IsTheIntegralOfTheMarginalizedWeight) {
  const double t2 = 2.25, k = 2.5758;
  const double t = std::sqrt(t2), sigma_max = t / k;
  const LossTable table = MagsacTable(t2);
  EXPECT_EQ(table.values[0], 0.0);
  EXPECT_EQ(table.values[LossTable::kBins], t2);
  constexpr int kSteps = 2048;
  double loss = 0.0;
  std::vector<double> at(LossTable::kBins + 1, 0.0);
  std::vector<double> cumulative(kSteps + 1, 0.0);
  for (int i = 0; i < kSteps; ++i) {
    const double r = t * (i + 0.5) / kSteps;
    loss += r * Weight(r, sigma_max, k) * t / kSteps;
    cumulative[i + 1] = loss;
  }
  for (int bin = 1; bin < LossTable::kBins; ++bin) {
    const double position = kSteps * std::sqrt(bin / static_cast<double>(LossTable::kBins));
    const int i = static_cast<int>(position);
    const double value = cumulative[i] + (position - i) * (cumulative[i + 1] - cumulative[i]);
    EXPECT_NEAR(table.values[bin], t2 * value / loss, 5e-3 * t2) << bin;
    EXPECT_GT(table.values[bin], table.values[bin - 1]);
  }
}

}  // namespace
}  // namespace rigel
