// PROSAC: the best matches first, all of them in the end, samples as a Sampler draws them.
#include "rigel/minimal/ransac/prosac.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/minimal/random_problem.h"

namespace rigel {
namespace {

// `count` matches of two cameras, of scores in an order of its own.
GroupedMatches MakeMatches(int count, bool with_scores) {
  Rig rig;
  for (int k = 0; k < 2; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400, 400, 320, 240, 640, 480);
    camera.s = Eigen::Vector3d(k, 0, 0);
    rig.cameras.push_back(camera);
  }
  std::vector<Match> matches;
  Random random(7);
  for (int k = 0; k < count; ++k) {
    Match m;
    m.camera1 = k % 2;
    m.camera2 = (k / 2) % 2;
    m.pixel1 = {random.Uniform(0, 640), random.Uniform(0, 480)};
    m.pixel2 = {random.Uniform(0, 640), random.Uniform(0, 480)};
    if (with_scores) m.score = (k * 37) % count / static_cast<double>(count);
    matches.push_back(m);
  }
  return GroupedMatches(rig, matches);
}

// The rank of each match by its score.
std::vector<int> Ranks(const GroupedMatches& matches) {
  std::vector<int> order(matches.size()), rank(matches.size());
  for (int k = 0; k < matches.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return matches.matches()[a].score < matches.matches()[b].score;
  });
  for (int k = 0; k < matches.size(); ++k) rank[order[k]] = k;
  return rank;
}

TEST(Prosac, WithoutScoresItIsTheSampler) {
  const GroupedMatches matches = MakeMatches(100, false);
  for (const SampleKind kind :
       {SampleKind::kSpread, SampleKind::kOneCamera, SampleKind::kOnePairPlusOne}) {
    ProsacSampler prosac(matches, kind, 4, 1000);
    const Sampler sampler(matches.groups(), kind, 4);
    Random a(3), b(3);
    for (int k = 0; k < 100; ++k) {
      int one[4], other[4];
      ASSERT_TRUE(prosac.Draw(&a, one));
      ASSERT_TRUE(sampler.Draw(&b, other));
      EXPECT_TRUE(std::equal(one, one + 4, other));
    }
  }
}

TEST(Prosac, DrawsFromThePoolWhichGrowsToAllMatches) {
  const GroupedMatches matches = MakeMatches(100, true);
  const std::vector<int> rank = Ranks(matches);
  for (const SampleKind kind :
       {SampleKind::kSpread, SampleKind::kOneCamera, SampleKind::kOnePairPlusOne}) {
    ProsacSampler prosac(matches, kind, 4, 1000);
    Random random(3);
    int last_pool = 0;
    std::set<int> drawn;
    for (int k = 0; k < 3000; ++k) {
      int sample[4];
      ASSERT_TRUE(prosac.Draw(&random, sample));
      EXPECT_GE(prosac.pool_size(), last_pool);
      last_pool = prosac.pool_size();
      if (k == 0) {
        EXPECT_LE(last_pool, 25);
      }
      for (const int i : sample) EXPECT_LT(rank[i], last_pool) << "draw " << k;
      EXPECT_EQ(std::set<int>(sample, sample + 4).size(), 4u);
      drawn.insert(sample, sample + 4);
      const auto group = [&](int i) {
        const Match& m = matches.matches()[i];
        return 2 * m.camera1 + m.camera2;
      };
      if (kind == SampleKind::kSpread) {
        EXPECT_NE(group(sample[0]), group(sample[1]));
      }
      if (kind == SampleKind::kOneCamera) {
        for (const int i : sample) EXPECT_EQ(group(i), group(sample[0]));
        EXPECT_TRUE(matches.matches()[sample[0]].IsIntra());
      }
    }
    EXPECT_EQ(last_pool, 100);
    EXPECT_GE(drawn.size(), kind == SampleKind::kOneCamera ? 50u : 100u);
  }
}

// A camera pair whose matches all have poor scores: the pool grows until there is a sample.
TEST(Prosac, WaitsForTheMatchesThatASampleNeeds) {
  const GroupedMatches all = MakeMatches(100, true);
  std::vector<Match> input = all.matches();
  for (Match& m : input) {
    if (m.IsIntra()) m.score += 2.0;
  }
  const GroupedMatches matches(all.rig(), input);
  ProsacSampler prosac(matches, SampleKind::kOneCamera, 4, 1000);
  Random random(1);
  int sample[4];
  ASSERT_TRUE(prosac.Draw(&random, sample));
  EXPECT_GT(prosac.pool_size(), 50);
  for (const int i : sample) EXPECT_TRUE(matches.matches()[i].IsIntra());
}

TEST(Prosac, FewMatchesAndNone) {
  Random random(1);
  int sample[4];
  ProsacSampler few(MakeMatches(5, true), SampleKind::kSpread, 4, 10);
  EXPECT_TRUE(few.Draw(&random, sample));
  ProsacSampler none(MakeMatches(0, true), SampleKind::kSpread, 4, 10);
  EXPECT_FALSE(none.Draw(&random, sample));
}

}  // namespace
}  // namespace rigel
