#include <cmath>

#include "rigel/core/score_kernel.h"

namespace rigel {
namespace {

// Incomplete gamma functions: lower (1, x) and upper (0, x).
double LowerGamma1(double x) { return 1.0 - std::exp(-x); }

// E1(x) by its series and continued fraction.
double UpperGamma0(double x) {
  if (x < 1.0) {
    double sum = -0.57721566490153286 - std::log(x);
    double term = 1.0;
    for (int k = 1; k < 30; ++k) {
      term *= -x / k;
      sum -= term / k;
    }
    return sum;
  }
  double fraction = 0.0;
  for (int k = 60; k >= 1; --k) fraction = k / (1.0 + k / (x + fraction));
  return std::exp(-x) / (x + fraction);
}

}  // namespace

// With one degree of freedom (n + 1) / 2 = 1 and (n - 1) / 2 = 0. The threshold is k sigma_max.
LossTable MagsacTable(double t2) {
  constexpr double kQuantile = 2.5758;  // 0.99 of |N(0, 1)|
  const double sigma2 = t2 / (kQuantile * kQuantile);
  const auto loss = [&](double r2) {
    const double x = r2 / (2.0 * sigma2);
    const double last = UpperGamma0(0.5 * kQuantile * kQuantile);
    if (!(x > 0)) return 0.0;
    return 0.5 * sigma2 * LowerGamma1(x) + 0.25 * r2 * (UpperGamma0(x) - last);
  };
  LossTable table;
  const double scale = t2 / loss(t2);
  for (int k = 0; k < LossTable::kBins; ++k) {
    table.values[k] = scale * loss(k * t2 / LossTable::kBins);
  }
  table.values[LossTable::kBins] = table.values[LossTable::kBins + 1] = t2;
  return table;
}

}  // namespace rigel
