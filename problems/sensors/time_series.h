// Readings of a sensor over time, linear between neighbours.
#ifndef RIGEL_PROBLEMS_SENSORS_TIME_SERIES_H_
#define RIGEL_PROBLEMS_SENSORS_TIME_SERIES_H_

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rigel {

// Whether a series says something of a time, or of all times between two.
enum class Coverage {
  kCovered,
  kOutside,  // before its first reading or after its last
  kGap,      // between two readings that are too far apart
};

template <class Value>
struct TimeSeries {
  std::vector<double> times;  // seconds, increasing
  std::vector<Value> values;
};

// A time between two readings: index + share. share is in [0, 1), or 1 at the last reading.
struct SeriesPlace {
  size_t index = 0;
  double share = 0.0;
};

// The place of a time. There are two readings at least. *place is set if it is covered: by two
// readings at most max_gap seconds apart, or by one at exactly that time.
inline Coverage FindPlace(const std::vector<double>& times, double time, double max_gap,
                          SeriesPlace* place) {
  if (!(time >= times.front() && time <= times.back())) return Coverage::kOutside;
  const auto after = std::upper_bound(times.begin(), times.end() - 1, time);
  place->index = static_cast<size_t>(after - times.begin()) - 1;
  const double gap = times[place->index + 1] - times[place->index];
  place->share = (time - times[place->index]) / gap;
  const bool at_reading = place->share == 0 || place->share == 1;
  return at_reading || gap <= max_gap ? Coverage::kCovered : Coverage::kGap;
}

// Whether all of [begin, end] is covered; begin <= end.
inline Coverage FindSpan(const std::vector<double>& times, double begin, double end, double max_gap,
                         SeriesPlace* first, SeriesPlace* last) {
  for (const auto& [time, place] : {std::pair(begin, first), std::pair(end, last)}) {
    const Coverage coverage = FindPlace(times, time, max_gap, place);
    if (coverage != Coverage::kCovered) return coverage;
  }
  for (size_t k = first->index; k <= last->index; ++k) {
    const bool used = begin < times[k + 1] && end > times[k];
    if (used && times[k + 1] - times[k] > max_gap) return Coverage::kGap;
  }
  return Coverage::kCovered;
}

// part(k, u, v, seconds) for each part of a covered span, in order: it goes from share u to share v
// of the step from reading k to the next.
template <class Part>
void ForEachPart(const std::vector<double>& times, const SeriesPlace& first,
                 const SeriesPlace& last, const Part& part) {
  for (size_t k = first.index; k <= last.index; ++k) {
    const double u = k == first.index ? first.share : 0.0;
    const double v = k == last.index ? last.share : 1.0;
    if (v > u) part(k, u, v, (v - u) * (times[k + 1] - times[k]));
  }
}

// The integral over a covered span as a sum of weights times readings: weight k is that of reading
// first.index + k. Seconds.
inline std::vector<double> IntegralWeights(const std::vector<double>& times,
                                           const SeriesPlace& first, const SeriesPlace& last) {
  std::vector<double> weights(last.index - first.index + 2, 0.0);
  ForEachPart(times, first, last, [&](size_t k, double u, double v, double seconds) {
    const double after = seconds * (u + v) / 2;  // of the later reading
    weights[k - first.index] += seconds - after;
    weights[k - first.index + 1] += after;
  });
  return weights;
}

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SENSORS_TIME_SERIES_H_
