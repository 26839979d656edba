#include "rigel/minimal/ransac/sampler.h"

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

constexpr SampleKind kKinds[] = {SampleKind::kSpread, SampleKind::kOneCamera,
                                 SampleKind::kOnePairPlusOne};

TEST(Sampler, DrawsDistinctIndicesInRange) {
  for (const SampleKind kind : kKinds) {
    for (const std::vector<int>& sizes :
         {std::vector<int>{20}, {10, 10}, {1, 19}, {5, 1, 14}, {1, 1, 1, 1, 1}}) {
      const std::vector<MatchGroup> groups = MakeGroups(sizes);
      const int total = Total(groups);
      Random random(1);
      for (int size = 1; size <= total; ++size) {
        const Sampler sampler(groups, kind, size);
        for (int k = 0; k < 200 && sampler.CanDraw(); ++k) {
          std::vector<int> sample(size + 1, -7);
          ASSERT_TRUE(sampler.Draw(&random, sample.data()));
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
}

TEST(Sampler, SpreadSamplesBeginInDifferentCameraPairs) {
  // However lopsided the groups are: a sample of one pair says nothing about scale.
  for (const std::vector<int>& sizes : {std::vector<int>{10, 10}, {99, 1}, {1, 99}, {3, 90, 7}}) {
    const std::vector<MatchGroup> groups = MakeGroups(sizes);
    const Sampler sampler(groups, SampleKind::kSpread, 4);
    Random random(2);
    for (int k = 0; k < 2000; ++k) {
      int sample[4];
      ASSERT_TRUE(sampler.Draw(&random, sample));
      EXPECT_NE(GroupOf(groups, sample[0]), GroupOf(groups, sample[1]));
    }
  }
}

TEST(Sampler, OneCameraSamplesAreOfOneIntraCameraGroup) {
  std::vector<MatchGroup> groups = MakeGroups({10, 30, 3, 20});
  groups[1].camera2 = 0;  // inter-camera
  const Sampler sampler(groups, SampleKind::kOneCamera, 4);
  Random random(3);
  std::vector<int> counts(4);
  const int draws = 6000;
  for (int k = 0; k < draws; ++k) {
    int sample[4];
    ASSERT_TRUE(sampler.Draw(&random, sample));
    const int group = GroupOf(groups, sample[0]);
    for (const int index : sample) EXPECT_EQ(GroupOf(groups, index), group);
    ++counts[group];
  }
  EXPECT_EQ(counts[1], 0);
  EXPECT_EQ(counts[2], 0) << "too small";
  // In proportion to the number of matches, 10 to 20; five standard deviations.
  EXPECT_NEAR(counts[0], draws / 3.0, 5 * std::sqrt(draws * 2.0 / 9.0));
}

TEST(Sampler, OnePairPlusOneSamplesEndInAnotherPair) {
  std::vector<MatchGroup> groups = MakeGroups({10, 5, 20, 4});
  groups[2].camera2 = 0;  // any pair will do, inter-camera or not
  const Sampler sampler(groups, SampleKind::kOnePairPlusOne, 6);
  Random random(4);
  std::set<int> firsts, lasts;
  for (int k = 0; k < 2000; ++k) {
    int sample[6];
    ASSERT_TRUE(sampler.Draw(&random, sample));
    const int group = GroupOf(groups, sample[0]);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(GroupOf(groups, sample[i]), group);
    EXPECT_NE(GroupOf(groups, sample[5]), group);
    firsts.insert(group);
    lasts.insert(sample[5]);
  }
  EXPECT_EQ(firsts, (std::set<int>{0, 1, 2})) << "every pair of five matches, no smaller one";
  EXPECT_EQ(lasts.size(), 39u) << "any match can be the last";
  // With one pair only the last is of that pair too.
  const Sampler single(MakeGroups({6}), SampleKind::kOnePairPlusOne, 6);
  int sample[6];
  ASSERT_TRUE(single.Draw(&random, sample));
  EXPECT_EQ(std::set<int>(sample, sample + 6).size(), 6u);
}

TEST(Sampler, FailsWhereThereIsNoSample) {
  struct Case {
    std::vector<int> sizes;
    SampleKind kind;
    int size;
    bool possible;
  };
  const Case cases[] = {
      {{}, SampleKind::kSpread, 1, false},
      {{3}, SampleKind::kSpread, 4, false},
      {{1, 2}, SampleKind::kSpread, 4, false},
      {{1, 2}, SampleKind::kSpread, 3, true},
      {{3}, SampleKind::kSpread, 0, false},
      {{3}, SampleKind::kSpread, -1, false},
      {{100}, SampleKind::kSpread, 64, true},
      {{100}, SampleKind::kSpread, 65, false},
      {{}, SampleKind::kOneCamera, 2, false},
      {{1, 1, 1}, SampleKind::kOneCamera, 2, false},
      {{1, 2, 1}, SampleKind::kOneCamera, 2, true},
      {{4, 4, 4}, SampleKind::kOnePairPlusOne, 6, false},
      {{5}, SampleKind::kOnePairPlusOne, 6, false},
      {{5, 1}, SampleKind::kOnePairPlusOne, 6, true},
      {{6}, SampleKind::kOnePairPlusOne, 6, true},
  };
  for (size_t k = 0; k < std::size(cases); ++k) {
    const Case& c = cases[k];
    const Sampler sampler(MakeGroups(c.sizes), c.kind, c.size);
    Random random(5);
    int sample[64] = {};
    EXPECT_EQ(sampler.CanDraw(), c.possible) << "case " << k;
    EXPECT_EQ(sampler.Draw(&random, sample), c.possible) << "case " << k;
  }
  // Inter-camera matches only: nothing for a one-camera solver.
  std::vector<MatchGroup> inter = MakeGroups({50});
  inter[0].camera2 = 7;
  EXPECT_FALSE(Sampler(inter, SampleKind::kOneCamera, 2).CanDraw());
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
  const Sampler sampler(MakeGroups({n}), SampleKind::kSpread, size);
  Random random(4);
  std::vector<std::vector<int>> counts(size, std::vector<int>(n));
  std::vector<int> pairs(n * n);
  for (int k = 0; k < draws; ++k) {
    int sample[size];
    ASSERT_TRUE(sampler.Draw(&random, sample));
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
  const Sampler sampler(groups, SampleKind::kSpread, 4);
  Random random(5);
  std::vector<int> first(n), any(n);
  for (int k = 0; k < draws; ++k) {
    int sample[4];
    ASSERT_TRUE(sampler.Draw(&random, sample));
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

TEST(Sampler, TheSecondOfASpreadSampleIsAnyMatchOfOtherPairs) {
  const std::vector<MatchGroup> groups = MakeGroups({12, 8, 20});
  const Sampler sampler(groups, SampleKind::kSpread, 4);
  Random random(7);
  std::vector<int> seconds(40);
  int draws = 0;
  for (int k = 0; k < 60000; ++k) {
    int sample[4];
    ASSERT_TRUE(sampler.Draw(&random, sample));
    // The group in the middle has others on both sides.
    if (GroupOf(groups, sample[0]) != 1) continue;
    ++seconds[sample[1]];
    ++draws;
  }
  seconds.erase(seconds.begin() + 12, seconds.begin() + 20);
  EXPECT_LT(ChiSquare(seconds, draws / 32.0), 31 + 5 * std::sqrt(2.0 * 31));
}

TEST(Sampler, TheSeedFixesTheSamples) {
  const std::vector<MatchGroup> groups = MakeGroups({30, 70});
  const Sampler sampler(groups, SampleKind::kSpread, 5);
  Random a(6), b(6);
  for (int k = 0; k < 100; ++k) {
    int first[5], second[5];
    sampler.Draw(&a, first);
    sampler.Draw(&b, second);
    EXPECT_TRUE(std::equal(first, first + 5, second));
  }
}

}  // namespace
}  // namespace rigel
