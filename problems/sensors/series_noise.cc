#include "rigel/problems/sensors/series_noise.h"

#include <algorithm>
#include <cstddef>

#include "rigel/core/pose.h"

namespace rigel {
namespace {

// Both are variances with independent errors n_k of variance 1: of the difference from the line,
// e_k = n_k - (n_{k-1} + n_{k+1}) / 2, and of e_k - e_{k-1}, which a smooth curve hardly enters.
constexpr double kVarianceOffLine = 1.5;
constexpr double kVarianceOfChange = 5.0;

// residual(k, share): reading k less the value at this share of the way from reading k - 1 to k
// + 1.
template <class Residual>
SeriesNoise Measure(const std::vector<double>& times, double max_gap, int num_axes,
                    const Residual& residual) {
  SeriesNoise noise;
  double count = 0, num_changes = 0;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  bool has_before = false;
  for (size_t k = 1; k + 1 < times.size(); ++k) {
    const double gap1 = times[k] - times[k - 1], gap2 = times[k + 1] - times[k];
    const bool close = gap1 <= max_gap && gap2 <= max_gap;
    if (close) {
      const Eigen::Vector3d e = residual(k, gap1 / (gap1 + gap2));
      noise.off_line += e.squaredNorm();
      count += num_axes;
      if (has_before) {
        noise.independent += (e - before).squaredNorm();
        num_changes += num_axes;
      }
      before = e;
    }
    has_before = close;
  }
  if (count > 0) noise.off_line /= count;
  if (num_changes > 0) noise.independent /= num_changes * kVarianceOfChange;
  return noise;
}

}  // namespace

double SeriesNoise::Independent(double sigma) const { return std::min(independent, sigma * sigma); }

double SeriesNoise::Curve(double sigma) const {
  return std::max(0.0, off_line - kVarianceOffLine * Independent(sigma));
}

// Of independent errors the mean of two readings has half the variance. A parabola whose reading is
// off the line of its neighbours by c is off the line between two readings by share (1 - share) c.
double SeriesNoise::Interpolated(double sigma, double share) const {
  const double product = share * (1 - share);
  return sigma * sigma - 2 * product * Independent(sigma) + product * product * Curve(sigma);
}

SeriesNoise MeasureNoise(const AttitudeSeries& series, double max_gap) {
  return Measure(series.times, max_gap, 3, [&](size_t k, double share) -> Eigen::Vector3d {
    const Eigen::Quaterniond before(series.values[k - 1]), at(series.values[k]),
        after(series.values[k + 1]);
    return LogSO3((before.slerp(share, after).conjugate() * at).toRotationMatrix());
  });
}

SeriesNoise MeasureNoise(const RateSeries& series, double max_gap) {
  const auto& w = series.values;
  return Measure(series.times, max_gap, 3, [&](size_t k, double share) -> Eigen::Vector3d {
    return w[k] - (1 - share) * w[k - 1] - share * w[k + 1];
  });
}

SeriesNoise MeasureNoise(const TimeSeries<double>& series, double max_gap) {
  const auto& v = series.values;
  return Measure(series.times, max_gap, 1, [&](size_t k, double share) -> Eigen::Vector3d {
    return {v[k] - (1 - share) * v[k - 1] - share * v[k + 1], 0, 0};
  });
}

}  // namespace rigel
