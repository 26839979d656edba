// Median, mean, RMS and 90th percentile of a list of numbers.
#ifndef RIGEL_PROBLEMS_STATISTICS_H_
#define RIGEL_PROBLEMS_STATISTICS_H_

#include <optional>
#include <vector>

namespace rigel {

struct Statistics {
  double median = 0.0;
  double mean = 0.0;
  double rms = 0.0;
  double p90 = 0.0;
};

// Nothing for an empty list. Numbers that are not finite must not be passed. The median of an even
// count is the mean of the middle two; p90 is interpolated linearly.
std::optional<Statistics> ComputeStatistics(std::vector<double> values);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_STATISTICS_H_
