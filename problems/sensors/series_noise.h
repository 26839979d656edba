// How much the readings of a series scatter about the straight line between their neighbours.
//
// The error of an interpolated value depends on two things that nobody states, and that the
// readings show. Errors of neighbouring readings may be independent, as those of a wheel's pulses,
// or the same, as those of a filter's attitude. And the true curve leaves the line.
#ifndef RIGEL_PROBLEMS_SENSORS_SERIES_NOISE_H_
#define RIGEL_PROBLEMS_SENSORS_SERIES_NOISE_H_

#include <vector>

#include <Eigen/Core>

#include "rigel/problems/sensors/sensor_files.h"

namespace rigel {

// Mean squares per axis, in the unit of the readings. 0 where there are too few readings.
struct SeriesNoise {
  double independent = 0.0;  // of the part of the errors that is new in each reading
  double off_line = 0.0;     // of a reading's difference from the line between its neighbours

  // The independent part where the whole error of a reading is stated as sigma. What scatters more
  // is no error of the readings but a curve.
  double Independent(double sigma) const;

  // How far the true curve leaves the line through a reading's neighbours, squared.
  double Curve(double sigma) const;

  // The mean square error of a value at this share of the step between two readings.
  double Interpolated(double sigma, double share) const;
};

// Only readings whose neighbours are at most max_gap seconds away count.
SeriesNoise MeasureNoise(const AttitudeSeries& series, double max_gap);  // radians
SeriesNoise MeasureNoise(const RateSeries& series, double max_gap);
SeriesNoise MeasureNoise(const TimeSeries<double>& series, double max_gap);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SENSORS_SERIES_NOISE_H_
