// The length that matches between cameras vote for, and that a refinement reaches it from another.
#include "rigel/refine/search/length_vote.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/problems/scenes/street.h"
#include "rigel/test/accuracy/street_rigs.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

FramePair SurroundPair(int index, double calibration_sigma_deg = 0.0) {
  StreetOptions street = SixCameras();
  street.calibration_sigma_deg = calibration_sigma_deg;
  street.calibration_sigma_m = 0.1 * calibration_sigma_deg;
  street.seed = 1 + index;
  street.num_matches = 2000;
  street.inter_share = 0.15;
  street.outlier_share = 0.2;
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeStreetPair(street, index, &pair, &error)) << error;
  return pair;
}

TEST(LengthVote, TheTrueLengthIsAmongThoseVotedFor) {
  for (int index = 0; index < 10; ++index) {
    const FramePair pair = SurroundPair(index);
    const GroupedMatches matches(pair.rig, pair.matches);
    const double truth = pair.truth->t.norm();
    for (const double factor : {0.3, 1.0, 3.0}) {
      Pose pose = *pair.truth;
      pose.t *= factor;
      double nearest = std::numeric_limits<double>::infinity();
      for (const double length : VoteOnLength(matches, pose, 0.5)) {
        nearest = std::min(nearest, std::abs(length / truth - 1.0));
      }
      // Of the body's origin, not of the rig's centre.
      EXPECT_LT(nearest, 0.1) << "pair " << index << ", factor " << factor;
    }
  }
}

TEST(LengthVote, IntraCameraMatchesHaveNoVote) {
  const FramePair pair = ScenePair(SceneOptions(), 0);
  EXPECT_TRUE(VoteOnLength(GroupedMatches(pair.rig, pair.matches), *pair.truth, 0.5).empty());
}

// With a calibration that is off, a fit from a wrong length bends rotation and direction to that
// length, and ends there. From two thirds of the length and from one and a half times it.
TEST(LengthVote, ARefinementEndsAtTheLengthOfTheMostMatches) {
  int ended_elsewhere = 0;
  for (int index = 0; index < 20; ++index) {
    const FramePair pair = SurroundPair(index, 0.2);
    Pose reference = *pair.truth;
    const int most = RefinePair(RefineOptions(), pair, &reference).num_inliers;
    for (const double factor : {0.67, 1.5}) {
      Pose pose = *pair.truth;
      pose.t *= factor;
      ended_elsewhere += RefinePair(RefineOptions(), pair, &pose).num_inliers < 0.99 * most;
    }
  }
  std::printf("[ measured ] of 40 fits from a wrong length %d ended elsewhere\n", ended_elsewhere);
  EXPECT_LE(ended_elsewhere, 4);  // without the vote 10
}

}  // namespace
}  // namespace rigel
