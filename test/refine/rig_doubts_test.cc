// What contradicts the rig is named, what fits is not.
#include "rigel/refine/rig_doubts.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

FramePair StereoPair(double inter_share, int index) {
  SceneOptions scene;
  scene.num_matches = 300;
  scene.inter_share = inter_share;
  scene.outlier_share = 0.1;
  return ScenePair(scene, index);
}

TEST(RigDoubts, ARightRigHasNone) {
  for (const double inter_share : {0.0, 0.1, 0.5, 1.0}) {
    for (int index = 0; index < 5; ++index) {
      const MotionEstimate e = EstimateMotion(EstimateOptions(), StereoPair(inter_share, index));
      ASSERT_EQ(e.status, EstimateStatus::kSuccess);
      EXPECT_THAT(e.rig_doubts, IsEmpty());
    }
  }
}

TEST(RigDoubts, CountsTheMatchesOfEachCameraPair) {
  const FramePair pair = StereoPair(0.5, 0);
  const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
  int rows = 0, inliers = 0;
  for (const CameraPairFit& fit : e.refine.camera_pairs) {
    int expected = 0;
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      const Match& m = pair.matches[k];
      if (m.camera1 != fit.camera1 || m.camera2 != fit.camera2) continue;
      ++rows;
      expected += e.refine.inliers[k];
    }
    EXPECT_EQ(fit.inliers, expected);
    inliers += fit.inliers;
  }
  EXPECT_EQ(rows, 300);
  EXPECT_EQ(inliers, e.num_inliers);
}

TEST(RigDoubts, SwappedCamerasAreNamed) {
  for (int index = 0; index < 5; ++index) {
    FramePair pair = StereoPair(0.5, index);
    std::swap(pair.rig.cameras[0], pair.rig.cameras[1]);
    const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
    ASSERT_FALSE(e.rig_doubts.empty()) << index;
    const RigDoubt& last = e.rig_doubts.back();
    EXPECT_EQ(last.kind, RigDoubtKind::kSwapped);
    EXPECT_THAT(last.message, AllOf(StartsWith("with cameras 0 and 1 swapped 2"),
                                    HasSubstr(" of 300 matches fit instead of ")));
    // It is told, not used, and told again.
    EstimateOptions plain;
    plain.check_rig = false;
    const MotionEstimate without = EstimateMotion(plain, pair);
    EXPECT_EQ(without.pose.R, e.pose.R);
    EXPECT_EQ(without.pose.t, e.pose.t);
    EXPECT_THAT(without.rig_doubts, IsEmpty());
    EXPECT_EQ(EstimateMotion(EstimateOptions(), pair).rig_doubts.back().message, last.message);
  }
}

TEST(RigDoubts, ACameraPairOfWhichFewFitIsNamed) {
  FramePair pair = StereoPair(0.3, 1);
  Random random(1);
  for (Match& m : pair.matches) {
    if (!m.IsIntra()) m.pixel2 = {random.Uniform(0.0, 640.0), random.Uniform(0.0, 480.0)};
  }
  const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
  ASSERT_THAT(e.rig_doubts, SizeIs(1));
  EXPECT_EQ(e.rig_doubts[0].kind, RigDoubtKind::kFewFit);
  EXPECT_THAT(e.rig_doubts[0].message,
              AllOf(StartsWith("cameras 0-1: "), HasSubstr(" of 90 fit; are they swapped")));
}

TEST(RigDoubts, AFrozenCameraIsNamed) {
  FramePair pair = StereoPair(0.0, 2);
  for (Match& m : pair.matches) {
    if (m.camera1 == 1) m.pixel2 = m.pixel1;
  }
  const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
  ASSERT_FALSE(e.rig_doubts.empty());
  EXPECT_EQ(e.rig_doubts[0].kind, RigDoubtKind::kFrozen);
  EXPECT_THAT(e.rig_doubts[0].message, StartsWith("camera 1 shows the same image twice"));
  // Both stand: nothing is frozen.
  for (Match& m : pair.matches) m.pixel2 = m.pixel1;
  EXPECT_THAT(EstimateMotion(EstimateOptions(), pair).rig_doubts, IsEmpty());
}

TEST(RigDoubts, OneWayStereoIsNotCalledStandingStill) {
  FramePair pair = StereoPair(1.0, 3);
  std::vector<Match> one_way;
  for (const Match& m : pair.matches) {
    if (m.camera1 == 0 && m.camera2 == 1) one_way.push_back(m);
  }
  pair.matches = one_way;
  pair.columns = MatchColumns();
  const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
  ASSERT_EQ(e.status, EstimateStatus::kSuccess);
  EXPECT_TRUE(e.refine.rotation_observable);
  EXPECT_LT(RadToDeg(RotationError(pair.truth->R, e.pose.R)), 0.3);
  EXPECT_FALSE(e.refine.translation_observable);
  EXPECT_THAT(e.refine.ObservabilityReport(),
              StartsWith("|t| is not determined by one camera pair: 0-1"));
  ASSERT_NE(e.refine.OnlyCameraPair(), nullptr);
  const auto& b = e.refine.OnlyCameraPair()->baseline;
  const Eigen::Vector3d truth =
      (pair.truth->R * pair.rig.cameras[0].s + pair.truth->t - pair.rig.cameras[1].s).normalized();
  EXPECT_LT((Eigen::Vector3d(b[0], b[1], b[2]) - truth).norm(), 0.05);
}

// The rig is right, the prior is not.
TEST(RigDoubts, AWrongPriorIsNotBlamedOnTheRig) {
  int doubtful = 0;
  for (int index = 0; index < 25; ++index) {
    SceneOptions scene;
    scene.ring = true;
    scene.num_cameras = 8;
    scene.num_matches = 200;
    scene.outlier_share = 0.3;
    scene.motion = MotionPattern::kRandom;
    scene.rotation_deg = 20.0;
    scene.rotation_axis = RotationAxisPattern::kRandom;
    FramePair pair = ScenePair(scene, index);
    pair.prior.gravity2 = pair.prior.gravity1;  // as --prior=body says
    EstimateOptions options;
    options.solver = "4pt";
    const MotionEstimate e = EstimateMotion(options, pair);
    if (!e.HasMotion()) continue;
    EXPECT_THAT(e.rig_doubts, IsEmpty());
    doubtful += e.doubtful ? 1 : 0;
  }
  EXPECT_GT(doubtful, 0);
}

// No match connects them: that each fits badly by itself is what shows.
TEST(RigDoubts, SwappedCamerasWithoutMatchesBetweenThemAreNamed) {
  SceneOptions scene;
  scene.ring = true;
  scene.num_cameras = 6;
  scene.num_matches = 600;
  scene.rotation_deg = 5.0;
  FramePair pair = ScenePair(scene, 0);
  std::swap(pair.rig.cameras[2], pair.rig.cameras[3]);
  const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
  ASSERT_THAT(e.rig_doubts, SizeIs(3));
  EXPECT_THAT(e.rig_doubts[0].message, AllOf(StartsWith("camera 2: "), HasSubstr("is it swapped")));
  EXPECT_THAT(e.rig_doubts[1].message, StartsWith("camera 3: "));
  EXPECT_EQ(e.rig_doubts[2].kind, RigDoubtKind::kSwapped);
  EXPECT_THAT(e.rig_doubts[2].message, StartsWith("with cameras 2 and 3 swapped "));
}

}  // namespace
}  // namespace rigel
