// The sign of t by depths, and the false minima of a tiny |t|.
#include "rigel/refine/search/sign_and_scale.h"

#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr double kThresholdPx = 1.5;

TEST(ResolveSign, FlipsAWrongSignAndKeepsARightOne) {
  for (const MotionPattern motion :
       {MotionPattern::kForward, MotionPattern::kSideways, MotionPattern::kRandom}) {
    for (int index = 0; index < 100; ++index) {
      SceneOptions options;
      options.motion = motion;
      options.num_matches = 1000;  // more than are looked at
      options.outlier_share = 0.2;
      const FramePair pair = ScenePair(options, index);
      const GroupedMatches matches(pair.rig, pair.matches);
      Pose pose = *pair.truth;
      EXPECT_TRUE(ResolveSign(matches, kThresholdPx, &pose)) << index;
      EXPECT_EQ(pose.t, pair.truth->t) << index;
      pose.t = -pair.truth->t;
      EXPECT_TRUE(ResolveSign(matches, kThresholdPx, &pose)) << index;
      EXPECT_EQ(pose.t, pair.truth->t) << index;
      EXPECT_EQ(pose.R, pair.truth->R);
    }
  }
}

TEST(ResolveSign, DecidesNothingWithoutParallaxOrMatches) {
  // A turn about the body's origin of cameras that stand there: any t fits, none has parallax.
  SceneOptions options;
  Pose turn;
  turn.R = ExpSO3(DegToRad(3.0) * Eigen::Vector3d::UnitY());
  FramePair pair = ScenePair(options, 0, turn);
  for (RigCamera& camera : pair.rig.cameras) camera.s.setZero();
  Random random(1);
  for (Match& m : pair.matches) {
    const RigCamera& camera = pair.rig.cameras[m.camera1];
    m.pixel2 = ProjectPinhole(camera.intrinsics, camera.Q.transpose() * turn.R * camera.Q *
                                                     AlongRay(camera.intrinsics, m.pixel1));
    m.pixel2.x() += 0.5 * random.Normal();
    m.pixel2.y() += 0.5 * random.Normal();
  }
  for (const double sign : {1.0, -1.0}) {
    Pose pose = turn;
    pose.t = {0, 0, sign};
    EXPECT_TRUE(ResolveSign(GroupedMatches(pair.rig, pair.matches), kThresholdPx, &pose));
    EXPECT_EQ(pose.t.z(), sign);
    EXPECT_TRUE(ResolveSign(GroupedMatches(pair.rig, {}), kThresholdPx, &pose));
    EXPECT_EQ(pose.t.z(), sign);
    ResolveSignAndScale(GroupedMatches(pair.rig, {}), kThresholdPx, &pose);
    EXPECT_EQ(pose.t.z(), sign);
  }
}

// Forward with yaw: the arms R s - s of the two cameras point along and against the motion. With a
// tiny |t| they decide, the matches fit as well as under the truth, and half of them lie behind.
FramePair ForwardWithYaw(int index) {
  SceneOptions options;
  options.num_matches = 200;
  options.rotation_deg = 5.0;
  options.noise_px = 0.3;
  return ScenePair(options, index);
}

TEST(ResolveSign, RecognizesTheFalseMinimaOfForwardMotionWithYaw) {
  int fits = 0, recognized = 0;
  for (int index = 0; index < 100; ++index) {
    const FramePair pair = ForwardWithYaw(index);
    const GroupedMatches matches(pair.rig, pair.matches);
    Pose wrong = *pair.truth;
    wrong.t *= 1e-3;
    // Worth the name only where the matches fit it and the two baselines point apart; some random
    // rigs have them otherwise.
    int inliers = 0;
    matches.Score(wrong, 3.0, 1e18, &inliers);
    double along[2];
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d& s = pair.rig.cameras[k].s;
      const Eigen::Vector3d arm = wrong.R * s - s;
      along[k] = (arm + wrong.t).dot(arm + pair.truth->t);
    }
    if (inliers < 100 || along[0] * along[1] > 0) continue;
    ++fits;
    recognized += !ResolveSign(matches, 3.0, &wrong);
  }
  RecordProperty("fits", fits);
  RecordProperty("recognized", recognized);
  EXPECT_GE(fits, 10);
  // Where one camera has many more decided matches than the other their share is not poor enough.
  EXPECT_GE(recognized, 8 * fits / 10);
}

TEST(ResolveSignAndScale, LeavesTheFalseMinima) {
  int right = 0;
  constexpr int kPairs = 100;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = ForwardWithYaw(index);
    const GroupedMatches matches(pair.rig, pair.matches);
    Pose pose = *pair.truth;
    pose.t *= index % 2 == 0 ? 1e-2 : -1e-2;
    ResolveSignAndScale(matches, kThresholdPx, &pose);
    EXPECT_EQ(pose.R, pair.truth->R);
    right += DirectionErrorDeg(*pair.truth, pose) < 5.0 && pose.t.norm() > 0.3 &&
             ResolveSign(matches, kThresholdPx, &pose);
  }
  RecordProperty("right", right);
  EXPECT_GE(right, 97);
}

TEST(ResolveSignAndScale, LeavesATrueMotionItsDirection) {
  for (int index = 0; index < 100; ++index) {
    SceneOptions options;
    options.motion = MotionPattern::kRandom;
    const FramePair pair = ScenePair(options, index);
    const GroupedMatches matches(pair.rig, pair.matches);
    for (const double sign : {1.0, -1.0}) {
      Pose pose = *pair.truth;
      pose.t *= sign;
      ResolveSignAndScale(matches, kThresholdPx, &pose);
      EXPECT_LT(DirectionErrorDeg(*pair.truth, pose), 3.0) << index;
    }
  }
}

}  // namespace
}  // namespace rigel
