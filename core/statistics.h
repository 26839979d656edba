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

// Half the distance of the quartiles: a measure of spread that outliers do not change. 0 for fewer
// than four values.
double QuartileDistance(std::vector<double> values);

// Nothing for an empty list. Numbers that are not finite must not be passed. The median of an even
// count is the mean of the middle two; p90 is interpolated linearly.
std::optional<Statistics> ComputeStatistics(std::vector<double> values);

}  // namespace rigel

#endif  // RIGEL_CORE_STATISTICS_H_
