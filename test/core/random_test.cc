#include "rigel/core/random.h"

#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(Random, IsSplitMix64) {
  // The published generator's first outputs for the seed 1234567: reports can be replayed on any
  // platform.
  Random random(1234567);
  EXPECT_EQ(random.Next(), 6457827717110365317u);
  EXPECT_EQ(random.Next(), 3203168211198807973u);
  EXPECT_EQ(random.Next(), 9817491932198370423u);
}

TEST(Random, TheSameSeedGivesTheSameNumbers) {
  Random a(7), b(7), c(8);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(a.Next(), b.Next());
  EXPECT_NE(a.Next(), c.Next());
  Random s = Random::Stream(7, 3), t = Random::Stream(7, 3);
  for (int k = 0; k < 101; ++k) {
    EXPECT_EQ(s.Normal(), t.Normal());
    EXPECT_EQ(s.Index(10), t.Index(10));
  }
}

TEST(Random, StreamsDoNotOverlap) {
  // SplitMix64 streams are windows of one sequence: those of neighbouring seeds and indices must
  // not be shifted copies of one another.
  std::set<uint64_t> seen;
  size_t drawn = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    for (uint64_t index = 0; index < 100; ++index) {
      Random random = Random::Stream(seed, index);
      for (int k = 0; k < 100; ++k, ++drawn) seen.insert(random.Next());
    }
  }
  EXPECT_EQ(seen.size(), drawn);
}

TEST(Random, NeighbouringStreamsAreUncorrelated) {
  double sum = 0.0;
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double x = Random::Stream(1, k).Uniform() - 0.5;
    const double y = Random::Stream(1, k + 1).Uniform() - 0.5;
    sum += 12.0 * x * y;
  }
  EXPECT_LT(std::abs(sum / n), 5.0 / std::sqrt(n));
}

TEST(Random, IndexCoversItsRangeEvenly) {
  Random random(2);
  for (const int n : {1, 2, 3, 7, 100}) {
    std::vector<int> counts(n);
    const int draws = 10000;
    for (int k = 0; k < draws; ++k) {
      const int index = random.Index(n);
      ASSERT_GE(index, 0);
      ASSERT_LT(index, n);
      ++counts[index];
    }
    double chi2 = 0.0;
    const double expected = draws / static_cast<double>(n);
    for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
    // Mean n - 1, standard deviation sqrt(2 (n - 1)).
    EXPECT_LT(chi2, n - 1 + 5.0 * std::sqrt(2.0 * (n - 1)) + 1e-9) << n;
  }
  for (int k = 0; k < 1000; ++k) {
    const int index = random.Index(2147483647);
    ASSERT_GE(index, 0);
    ASSERT_LT(index, 2147483647);
  }
}

TEST(Random, UniformStaysInItsInterval) {
  Random random(3);
  double sum = 0.0, lowest = 1.0, highest = 0.0;
  const int n = 100000;
  for (int k = 0; k < n; ++k) {
    const double x = random.Uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
    lowest = std::min(lowest, x);
    highest = std::max(highest, x);
    const double y = random.Uniform(-3.0, 5.0);
    ASSERT_GE(y, -3.0);
    ASSERT_LE(y, 5.0);
  }
  EXPECT_NEAR(sum / n, 0.5, 5.0 * std::sqrt(1.0 / 12 / n));
  EXPECT_LT(lowest, 1e-3);
  EXPECT_GT(highest, 1 - 1e-3);
}

TEST(Random, NormalHasTheMomentsOfTheNormalDistribution) {
  Random random(4);
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0, neighbours = 0, last = 0;
  const int n = 200000;
  for (int k = 0; k < n; ++k) {
    const double x = random.Normal();
    ASSERT_TRUE(std::isfinite(x));
    m1 += x;
    m2 += x * x;
    m3 += x * x * x;
    m4 += x * x * x * x;
    neighbours += x * last;
    last = x;
  }
  // Five standard deviations of each mean: sqrt of 1, 2, 15, 96 over n.
  const double unit = 5.0 / std::sqrt(n);
  EXPECT_NEAR(m1 / n, 0.0, unit);
  EXPECT_NEAR(m2 / n, 1.0, std::sqrt(2.0) * unit);
  EXPECT_NEAR(m3 / n, 0.0, std::sqrt(15.0) * unit);
  EXPECT_NEAR(m4 / n, 3.0, std::sqrt(96.0) * unit);
  EXPECT_NEAR(neighbours / n, 0.0, unit);
}

TEST(Random, UnitVectorsAreUniformOnTheSphere) {
  Random random(5);
  const int n = 50000;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (int k = 0; k < n; ++k) {
    const Eigen::Vector3d v = random.UnitVector3();
    ASSERT_NEAR(v.norm(), 1.0, 1e-14);
    mean += v / n;
    moment += v * v.transpose() / n;
  }
  EXPECT_LT(mean.norm(), 5.0 / std::sqrt(n));
  EXPECT_LT((moment - Eigen::Matrix3d::Identity() / 3.0).norm(), 5.0 / std::sqrt(n));
}

TEST(Random, NormalVectorHasIndependentComponents) {
  Random random(6);
  const int n = 50000;
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (int k = 0; k < n; ++k) {
    const Eigen::Vector3d v = random.NormalVector3();
    moment += v * v.transpose() / n;
  }
  EXPECT_LT((moment - Eigen::Matrix3d::Identity()).norm(), 3.0 * 5.0 / std::sqrt(n));
}

}  // namespace
}  // namespace rigel
