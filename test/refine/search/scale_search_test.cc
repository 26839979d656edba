// The search for |t|: out of the false minima of intra-camera matches.
#include "rigel/refine/search/scale_search.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

SceneOptions Scene() {
  SceneOptions scene;
  scene.motion = MotionPattern::kRandom;
  scene.rotation_deg = 10.0;  // the arms then say |t| to a few percent
  scene.num_matches = 600;
  return scene;
}

// Without a prior on the length, and with no other lengths to try.
bool Search(const GroupedMatches& matches, Pose* pose) {
  return SearchScale(matches, 1.5, 0.5, PriorResiduals(), {}, pose);
}

// Without the search one pair in twenty of this poor solver (its bias here is some degrees) ends
// with |t| beyond any distance and a direction that is off by ten times its standard deviation.
TEST(ScaleSearch, NoEstimateRunsAway) {
  int far = 0;
  double worst = 0.0;
  constexpr int kPairs = 200;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = ScenePair(Scene(), index);
    EstimateOptions options;
    options.solver = "4pt-approx";
    options.refine.noise_px = 0.5;
    const MotionEstimate estimate = EstimateMotion(options, pair);
    ASSERT_EQ(estimate.status, EstimateStatus::kSuccess) << index;
    far += estimate.pose.t.norm() > 2.0;
    worst = std::max(worst, DirectionErrorDeg(*pair.truth, estimate.pose));
  }
  std::printf("[ measured ] |t| > 2 m in %d of %d, largest error of direction %.2f deg\n", far,
              kPairs, worst);
  EXPECT_EQ(far, 0);
  EXPECT_LT(worst, 1.0);
}

TEST(ScaleSearch, FindsTheWayBackFromInfinity) {
  int found = 0;
  constexpr int kPairs = 100;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = ScenePair(Scene(), index);
    const GroupedMatches matches(pair.rig, pair.matches);
    Random random = Random::Stream(3, index);
    Pose pose = StartNear(*pair.truth, 0.2, 0.02, &random);
    pose.t *= 1e4;
    EXPECT_TRUE(Search(matches, &pose)) << index;
    found += std::abs(pose.t.norm() - 1.0) < 0.3;
  }
  std::printf("[ measured ] found %d of %d\n", found, kPairs);
  EXPECT_GE(found, kPairs - 5);
}

TEST(ScaleSearch, LeavesWhatItCannotImprove) {
  for (int index = 0; index < 20; ++index) {
    const FramePair pair = ScenePair(Scene(), index);
    const GroupedMatches matches(pair.rig, pair.matches);
    Pose pose = *pair.truth;
    Search(matches, &pose);
    EXPECT_NEAR(pose.t.norm(), 1.0, 0.3);
    // No translation, no direction to search along.
    pose.t.setZero();
    const Pose before = pose;
    EXPECT_FALSE(Search(matches, &pose));
    EXPECT_EQ(pose.t, before.t);
  }
}

}  // namespace
}  // namespace rigel
