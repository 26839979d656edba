#include "rigel/core/statistics.h"

#include <algorithm>
#include <cmath>

namespace rigel {
namespace {

double Quantile(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const size_t low = static_cast<size_t>(position);
  const size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (position - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace

double QuartileDistance(std::vector<double> values) {
  if (values.size() < 4) return 0.0;
  std::sort(values.begin(), values.end());
  return 0.5 * (values[values.size() * 3 / 4] - values[values.size() / 4]);
}

std::optional<Statistics> ComputeStatistics(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  Statistics s;
  for (const double v : values) {
    s.mean += v;
    s.rms += v * v;
  }
  const double n = static_cast<double>(values.size());
  s.mean /= n;
  s.rms = std::sqrt(s.rms / n);
  s.median = Quantile(values, 0.5);
  s.p90 = Quantile(values, 0.9);
  return s;
}

// From k - 2 to k degrees of freedom it grows by (x/2)^(k/2-1) e^(-x/2) / Gamma(k/2).
double ChiSquaredTail(double value, int degrees_of_freedom) {
  const double half = 0.5 * std::max(value, 0.0);
  const bool odd = degrees_of_freedom % 2 != 0;
  double tail = odd ? std::erfc(std::sqrt(half)) : std::exp(-half);
  double term = odd ? std::exp(-half) * std::sqrt(half) / std::tgamma(1.5) : std::exp(-half) * half;
  for (int k = odd ? 3 : 4; k <= degrees_of_freedom; k += 2) {
    tail += term;
    term *= half / (0.5 * k);
  }
  return tail;
}

std::optional<double> Efficiency(const std::optional<Statistics>& error,
                                 const std::optional<Statistics>& bound) {
  if (!error || !bound || !(bound->rms > 0)) return std::nullopt;
  return error->rms / bound->rms;
}

}  // namespace rigel
