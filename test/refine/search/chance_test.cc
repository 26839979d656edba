#include "rigel/refine/search/chance.h"

#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/problems/benchmarks/hostile_benchmark.h"

namespace rigel {
namespace {

constexpr double kThresholdPx = 4.0 / 3.0;

int Inliers(const GroupedMatches& matches, const Pose& pose) {
  int inliers = 0;
  matches.Score(pose, kThresholdPx, std::numeric_limits<double>::infinity(), &inliers);
  return inliers;
}

// What chance gives is known to some percent, and no number of matches makes it known better.
TEST(Chance, AFewMoreThanExpectedAreNoMotionHoweverManyMatches) {
  const FramePair pair = MakeHostilePair(200000, 1);
  const GroupedMatches matches(pair.rig, pair.matches);
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    Pose pose;
    pose.R = ExpSO3(0.3 * random.UnitVector3());
    pose.t = random.UnitVector3();
    const int expected = Inliers(matches, pose);
    const auto exceeds = [&](int inliers) {
      return ExceedsChance(matches, pose, inliers, matches.size(), kThresholdPx, 1e4);
    };
    EXPECT_FALSE(exceeds(static_cast<int>(1.2 * expected)));
    EXPECT_TRUE(exceeds(4 * expected));
  }
}

}  // namespace
}  // namespace rigel
