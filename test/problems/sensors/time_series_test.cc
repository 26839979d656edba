// Places and integrals in a series, and what gaps do.
#include "rigel/problems/sensors/time_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

const std::vector<double> kTimes = {0, 1, 2, 5, 6};
constexpr double kMaxGap = 1.5;

TEST(TimeSeries, PlacesAreBetweenNeighbours) {
  SeriesPlace place;
  EXPECT_EQ(FindPlace(kTimes, 1.25, kMaxGap, &place), Coverage::kCovered);
  EXPECT_EQ(place.index, 1u);
  EXPECT_EQ(place.share, 0.25);
  EXPECT_EQ(FindPlace(kTimes, 6, kMaxGap, &place), Coverage::kCovered);
  EXPECT_EQ(place.index, 3u);
  EXPECT_EQ(place.share, 1);
  EXPECT_EQ(FindPlace(kTimes, 2, kMaxGap, &place), Coverage::kCovered) << "a reading before a gap";
  EXPECT_EQ(FindPlace(kTimes, 5, kMaxGap, &place), Coverage::kCovered) << "one after it";
  EXPECT_EQ(FindPlace(kTimes, 2.1, kMaxGap, &place), Coverage::kGap);
  for (const double time : {-0.1, 6.1, std::nan("")}) {
    EXPECT_EQ(FindPlace(kTimes, time, kMaxGap, &place), Coverage::kOutside);
  }
}

TEST(TimeSeries, SpansHaveNoGap) {
  SeriesPlace first, last;
  EXPECT_EQ(FindSpan(kTimes, 0, 2, kMaxGap, &first, &last), Coverage::kCovered);
  EXPECT_EQ(FindSpan(kTimes, 5, 6, kMaxGap, &first, &last), Coverage::kCovered);
  EXPECT_EQ(FindSpan(kTimes, 1, 5, kMaxGap, &first, &last), Coverage::kGap);
  EXPECT_EQ(FindSpan(kTimes, 2, 5, kMaxGap, &first, &last), Coverage::kGap);
  EXPECT_EQ(FindSpan(kTimes, 5.5, 7, kMaxGap, &first, &last), Coverage::kOutside);
}

TEST(TimeSeries, IntegralsOfLinesAreExact) {
  for (const auto& [begin, end] : {std::pair(0.0, 2.0), std::pair(0.25, 0.75), std::pair(0.5, 1.75),
                                   std::pair(1.0, 1.0), std::pair(0.0, 6.0), std::pair(5.5, 6.0)}) {
    SeriesPlace first, last;
    ASSERT_EQ(FindSpan(kTimes, begin, end, 10, &first, &last), Coverage::kCovered);
    const std::vector<double> weights = IntegralWeights(kTimes, first, last);
    double sum = 0, integral = 0;
    for (size_t k = 0; k < weights.size(); ++k) {
      sum += weights[k];
      integral += weights[k] * (3 * kTimes[first.index + k] + 1);
    }
    EXPECT_NEAR(sum, end - begin, 1e-12);
    EXPECT_NEAR(integral, 1.5 * (end * end - begin * begin) + end - begin, 1e-12);
  }
}

}  // namespace
}  // namespace rigel
