// Median, mean, RMS and 90th percentile of a list of numbers.
#ifndef RIGEL_CORE_STATISTICS_H_
#define RIGEL_CORE_STATISTICS_H_

#include <optional>
#include <vector>

namespace rigel {

struct Statistics {
  double median = 0.0;
  double mean = 0.0;
  double rms = 0.0;
  double p90 = 0.0;
};

// Half the distance between the two quartiles: the spread of times, which a few outliers hardly
// change. 0 for fewer than four values.
double QuartileDistance(std::vector<double> values);

// Nothing for an empty list. Numbers that are not finite must not be passed. The median of an even
// count is the mean of the middle two; p90 is interpolated linearly.
std::optional<Statistics> ComputeStatistics(std::vector<double> values);

// The probability that chi2 with that many degrees of freedom (>= 1) exceeds `value`.
double ChiSquaredTail(double value, int degrees_of_freedom);

// The median; nullopt if there are no statistics.
inline std::optional<double> MedianOf(const std::optional<Statistics>& statistics) {
  return statistics ? std::optional<double>(statistics->median) : std::nullopt;
}

// RMS error over RMS bound; nothing where one does not exist or the bound is zero.
std::optional<double> Efficiency(const std::optional<Statistics>& error,
                                 const std::optional<Statistics>& bound);

}  // namespace rigel

#endif  // RIGEL_CORE_STATISTICS_H_
