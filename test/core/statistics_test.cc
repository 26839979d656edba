// The four numbers of a report.
#include "rigel/core/statistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(Statistics, OfNothingThereAreNone) { EXPECT_FALSE(ComputeStatistics({}).has_value()); }

TEST(Statistics, OfOneNumberAllAreThatNumber) {
  const auto s = ComputeStatistics({3.5});
  ASSERT_TRUE(s.has_value());
  EXPECT_EQ(s->median, 3.5);
  EXPECT_EQ(s->mean, 3.5);
  EXPECT_EQ(s->rms, 3.5);
  EXPECT_EQ(s->p90, 3.5);
}

TEST(Statistics, OfAnOddCountInAnyOrder) {
  const auto s = ComputeStatistics({4, 0, 1, 3, 2, 5, 6, 7, 10, 9, 8});
  ASSERT_TRUE(s.has_value());
  EXPECT_DOUBLE_EQ(s->median, 5.0);
  EXPECT_DOUBLE_EQ(s->mean, 5.0);
  EXPECT_DOUBLE_EQ(s->rms, std::sqrt(385.0 / 11.0));
  EXPECT_DOUBLE_EQ(s->p90, 9.0);
}

TEST(Statistics, TheMedianOfAnEvenCountIsTheMeanOfTheMiddleTwo) {
  const auto s = ComputeStatistics({1, 100, 2, 4});
  ASSERT_TRUE(s.has_value());
  EXPECT_DOUBLE_EQ(s->median, 3.0);
  EXPECT_DOUBLE_EQ(s->mean, 26.75);
  // Position 2.7 of 0..3: between 4 and 100.
  EXPECT_NEAR(s->p90, 4.0 + 0.7 * 96.0, 1e-12);
  const auto two = ComputeStatistics({2.0, 1.0});
  EXPECT_DOUBLE_EQ(two->median, 1.5);
  EXPECT_DOUBLE_EQ(two->p90, 1.9);
}

TEST(Statistics, NegativeNumbers) {
  const auto s = ComputeStatistics({-3, -1, -2});
  EXPECT_DOUBLE_EQ(s->median, -2.0);
  EXPECT_DOUBLE_EQ(s->mean, -2.0);
  EXPECT_DOUBLE_EQ(s->rms, std::sqrt(14.0 / 3.0));
}

TEST(Statistics, WhatDoesNotExistHasNoMedianAndNoEfficiency) {
  const auto errors = ComputeStatistics({3, 4});
  const auto bounds = ComputeStatistics({1, 7});
  EXPECT_EQ(MedianOf(errors), 3.5);
  EXPECT_FALSE(MedianOf(std::nullopt).has_value());
  EXPECT_DOUBLE_EQ(*Efficiency(errors, bounds), std::sqrt(0.5));
  EXPECT_FALSE(Efficiency(std::nullopt, bounds).has_value());
  EXPECT_FALSE(Efficiency(errors, std::nullopt).has_value());
  EXPECT_FALSE(Efficiency(errors, ComputeStatistics({0.0})).has_value());
}

// Tables: 5, 1 and 0.1 percent.
TEST(Statistics, TailsOfChiSquared) {
  EXPECT_NEAR(ChiSquaredTail(3.841459, 1), 0.05, 1e-7);
  EXPECT_NEAR(ChiSquaredTail(5.991465, 2), 0.05, 1e-7);
  EXPECT_NEAR(ChiSquaredTail(11.344867, 3), 0.01, 1e-8);
  EXPECT_NEAR(ChiSquaredTail(22.457744, 6), 0.001, 1e-9);
  EXPECT_NEAR(ChiSquaredTail(24.995790, 15), 0.05, 1e-7);
  EXPECT_EQ(ChiSquaredTail(0.0, 4), 1.0);
  EXPECT_EQ(ChiSquaredTail(1e5, 3), 0.0);
}

}  // namespace
}  // namespace rigel
