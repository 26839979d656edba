#include "rigel/minimal/sampler.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace rigel {
namespace {

// Groups of the given sizes, one after the other.
std::vector<MatchGroup> MakeGroups(const std::vector<int>& sizes) {
  std::vector<MatchGroup> groups;
  int begin = 0;
  for (const int size : sizes) {
    const int camera = static_cast<int>(groups.size());
    groups.push_back({camera, camera, begin, size});
    begin += size;
  }
  return groups;
}

int Total(const std::vector<MatchGroup>& groups) {
  return groups.empty() ? 0 : groups.back().begin + groups.back().size;
}

int GroupOf(const std::vector<MatchGroup>& groups, int index) {
  for (size_t g = 0; g < groups.size(); ++g) {
    if (index >= groups[g].begin && index < groups[g].begin + groups[g].size) {
      return static_cast<int>(g);
    }
  }
  return -1;
}

TEST(Sampler, DrawsDistinctIndicesInRange) {
  for (const std::vector<int>& sizes :
       {std::vector<int>{20}, {10, 10}, {1, 19}, {5, 1, 14}, {1, 1, 1, 1, 1}}) {
    const std::vector<MatchGroup> groups = MakeGroups(sizes);
    const int total = Total(groups);
    const Sampler sampler(groups, total);
    Random random(1);
    for (int size = 1; size <= total; ++size) {
      for (int k = 0; k < 200; ++k) {
        std::vector<int> sample(size + 1, -7);
        ASSERT_TRUE(sampler.Draw(size, &random, sample.data()));
        EXPECT_EQ(sample[size], -7) << "wrote beyond the sample";
        sample.pop_back();
        const std::set<int> distinct(sample.begin(), sample.end());
        EXPECT_EQ(distinct.size(), sample.size());
        EXPECT_GE(*distinct.begin(), 0);
        EXPECT_LT(*distinct.rbegin(), total);
      }
    }
  }
}

TEST(Sampler, TheFirstTwoComeFromDifferentCameraPairs) {
  // However lopsided the groups are: a sample of one pair says nothing about scale.
  for (const std::vector<int>& sizes : {std::vector<int>{10, 10}, {99, 1}, {1, 99}, {3, 90, 7}}) {
    const std::vector<MatchGroup> groups = MakeGroups(sizes);
    const Sampler sampler(groups, Total(groups));
    Random random(2);
    for (int k = 0; k < 2000; ++k) {
      int sample[4];
      ASSERT_TRUE(sampler.Draw(4, &random, sample));
      EXPECT_NE(GroupOf(groups, sample[0]), GroupOf(groups, sample[1]));
    }
  }
}

TEST(Sampler, FailsWhereThereAreTooFewMatches) {
  Random random(3);
  int sample[8] = {};
  EXPECT_FALSE(Sampler({}, 0).Draw(1, &random, sample));
  EXPECT_FALSE(Sampler(MakeGroups({3}), 3).Draw(4, &random, sample));
  EXPECT_FALSE(Sampler(MakeGroups({1, 2}), 3).Draw(4, &random, sample));
  EXPECT_TRUE(Sampler(MakeGroups({1, 2}), 3).Draw(3, &random, sample));
  EXPECT_FALSE(Sampler(MakeGroups({3}), 3).Draw(0, &random, sample));
  EXPECT_FALSE(Sampler(MakeGroups({3}), 3).Draw(-1, &random, sample));
}

double ChiSquare(const std::vector<int>& counts, double expected) {
  double sum = 0.0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

TEST(Sampler, OneGroupIsDrawnUniformly) {
  // Every position of the sample, and every pair of neighbours in it.
  const int n = 10;
  const int size = 4;
  const int draws = 20000;
  const Sampler sampler(MakeGroups({n}), n);
  Random random(4);
  std::vector<std::vector<int>> counts(size, std::vector<int>(n));
  std::vector<int> pairs(n * n);
  for (int k = 0; k < draws; ++k) {
    int sample[size];
    ASSERT_TRUE(sampler.Draw(size, &random, sample));
    for (int i = 0; i < size; ++i) ++counts[i][sample[i]];
    ++pairs[sample[1] * n + sample[2]];
  }
  for (int i = 0; i < size; ++i) {
    // Nine degrees of freedom: mean 9, standard deviation 4.2.
    EXPECT_LT(ChiSquare(counts[i], draws / static_cast<double>(n)), 30.0) << "position " << i;
  }
  std::vector<int> off_diagonal;
  for (int i = 0; i < n * n; ++i) {
    if (i / n != i % n) off_diagonal.push_back(pairs[i]);
  }
  // 89 degrees of freedom: standard deviation 13.3.
  EXPECT_LT(ChiSquare(off_diagonal, draws / 90.0), 89 + 5 * 13.3);
}

TEST(Sampler, WithinGroupsEveryMatchIsDrawnAlike) {
  const std::vector<MatchGroup> groups = MakeGroups({12, 8, 20});
  const int n = Total(groups);
  const int draws = 20000;
  const Sampler sampler(groups, n);
  Random random(5);
  std::vector<int> first(n), any(n);
  for (int k = 0; k < draws; ++k) {
    int sample[4];
    ASSERT_TRUE(sampler.Draw(4, &random, sample));
    ++first[sample[0]];
    for (const int index : sample) ++any[index];
  }
  EXPECT_LT(ChiSquare(first, draws / static_cast<double>(n)), 39 + 5 * std::sqrt(2.0 * 39));
  for (const MatchGroup& group : groups) {
    const std::vector<int> counts(any.begin() + group.begin,
                                  any.begin() + group.begin + group.size);
    double mean = 0.0;
    for (const int count : counts) mean += count / static_cast<double>(group.size);
    const double dof = group.size - 1;
    EXPECT_LT(ChiSquare(counts, mean), dof + 5 * std::sqrt(2.0 * dof));
  }
}

TEST(Sampler, TheSeedFixesTheSamples) {
  const std::vector<MatchGroup> groups = MakeGroups({30, 70});
  const Sampler sampler(groups, 100);
  Random a(6), b(6);
  for (int k = 0; k < 100; ++k) {
    int first[5], second[5];
    sampler.Draw(5, &a, first);
    sampler.Draw(5, &b, second);
    EXPECT_TRUE(std::equal(first, first + 5, second));
  }
}

}  // namespace
}  // namespace rigel
