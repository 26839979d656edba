// Independent errors, errors that hold on, and curves are told apart.
#include "rigel/problems/sensors/series_noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rigel/core/pose.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

constexpr int kReadings = 4000;
constexpr double kMaxGap = 1.0;

TEST(SeriesNoise, IndependentErrorsAreMeasured) {
  Random random(1);
  RateSeries series;
  AttitudeSeries attitudes;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (int k = 0; k < kReadings; ++k) {
    series.times.push_back(0.1 * k);
    series.values.emplace_back(Eigen::Vector3d(k, 2, 3 - k) + 0.2 * random.NormalVector3());
    attitudes.times.push_back(0.1 * k);
    R *= ExpSO3({0.01, 0.02, 0.1});
    attitudes.values.emplace_back(Eigen::Quaterniond(R * ExpSO3(0.02 * random.NormalVector3())));
  }
  EXPECT_NEAR(std::sqrt(MeasureNoise(series, kMaxGap).independent), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(MeasureNoise(series, kMaxGap).Curve(0.2)), 0, 0.05);
  EXPECT_NEAR(std::sqrt(MeasureNoise(attitudes, kMaxGap).independent), 0.02, 0.001);
  // The mean of two readings has half their variance.
  EXPECT_NEAR(MeasureNoise(series, kMaxGap).Interpolated(0.2, 0.5), 0.02, 0.002);
}

TEST(SeriesNoise, ErrorsThatHoldOnAreNotIndependent) {
  Random random(2);
  TimeSeries<double> series;
  double error = 0;
  for (int k = 0; k < kReadings; ++k) {
    error = 0.999 * error + 0.01 * random.Normal();
    series.times.push_back(0.1 * k);
    series.values.push_back(error);
  }
  const SeriesNoise noise = MeasureNoise(series, kMaxGap);
  EXPECT_LT(std::sqrt(noise.independent), 0.01);
  EXPECT_NEAR(noise.Interpolated(0.22, 0.5), 0.22 * 0.22, 0.001);
}

TEST(SeriesNoise, CurvesAreLostBetweenReadings) {
  TimeSeries<double> series;
  for (int k = 0; k < kReadings; ++k) {
    series.times.push_back(0.1 * k);
    series.values.push_back(std::sin(2 * series.times.back()));
  }
  const SeriesNoise noise = MeasureNoise(series, kMaxGap);
  double lost = 0;
  for (int k = 0; k + 1 < kReadings; ++k) {
    const double between = (series.values[k] + series.values[k + 1]) / 2;
    lost += std::pow(between - std::sin(2 * (series.times[k] + 0.05)), 2) / kReadings;
  }
  EXPECT_NEAR(std::sqrt(noise.Interpolated(1e-9, 0.5) / lost), 1, 0.05);
}

TEST(SeriesNoise, ReadingsAcrossGapsDoNotCount) {
  TimeSeries<double> series;
  for (int k = 0; k < 30; ++k) {
    series.times.push_back(k + (k / 10) * 100.0);
    series.values.push_back(k / 10 * 7.0);
  }
  EXPECT_EQ(MeasureNoise(series, kMaxGap).off_line, 0);
  EXPECT_EQ(MeasureNoise(series, kMaxGap).independent, 0);
}

}  // namespace
}  // namespace rigel
