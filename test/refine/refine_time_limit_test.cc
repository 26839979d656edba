// What ends an estimate or a refinement early, and what is then said of the motion.
#include <atomic>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;

bool SameBits(const Pose& a, const Pose& b) {
  return std::memcmp(a.R.data(), b.R.data(), sizeof(double) * 9) == 0 &&
         std::memcmp(a.t.data(), b.t.data(), sizeof(double) * 3) == 0;
}

// No match follows any motion.
FramePair HostilePair(int num_matches, int num_cameras = 2) {
  FramePair pair;
  pair.prior.axis = pair.prior.normal = Eigen::Vector3d::UnitY();
  pair.prior.gravity1 = pair.prior.gravity2 = Eigen::Vector3d::UnitY();
  Random random(7);
  for (int k = 0; k < num_cameras; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
    camera.s = random.UnitVector3();
    pair.rig.cameras.push_back(camera);
  }
  const auto pixel = [&] {
    return Eigen::Vector2d{random.Uniform(0.0, 640.0), random.Uniform(0.0, 480.0)};
  };
  for (int k = 0; k < num_matches; ++k) {
    Match match;
    match.camera1 = random.Index(num_cameras);
    match.camera2 = random.Index(num_cameras);
    match.pixel1 = pixel();
    match.pixel2 = pixel();
    pair.matches.push_back(match);
  }
  return pair;
}

void ExpectNothingStated(const RefineSummary& summary) {
  EXPECT_EQ(summary.termination, Termination::kStopped);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_FALSE(summary.covariance.has_value());
  EXPECT_FALSE(summary.rotation_observable);
  EXPECT_FALSE(summary.translation_observable);
  EXPECT_FALSE(summary.scale_observable);
  EXPECT_LT(summary.rotation_sigma, 0);
  EXPECT_THAT(summary.ObservabilityReport(), HasSubstr(summary.message));
}

TEST(TimeLimit, AFlagSetBeforeTheCallLeavesNoMotionAndSaysSo) {
  const FramePair pair = ScenePair(SceneOptions(), 1);
  const std::atomic<bool> cancel{true};
  EstimateOptions options;
  options.cancel = &cancel;
  for (const char* solver : {"4pt-axis", "5pt+1", "auto"}) {
    options.solver = solver;
    const MotionEstimate estimate = EstimateMotion(options, pair);
    EXPECT_EQ(estimate.status, EstimateStatus::kNoSolution) << solver;
    EXPECT_FALSE(estimate.HasMotion());
    EXPECT_EQ(estimate.stopped, StopReason::kCancelled);
    EXPECT_THAT(estimate.message, HasSubstr("cancelled before a motion"));
    EXPECT_EQ(estimate.iterations, 0);
  }
}

TEST(TimeLimit, AShortLimitIsSaidAndAWrongOneRefused) {
  const FramePair pair = HostilePair(20000);
  EstimateOptions options;
  options.time_limit = 1e-6;
  const MotionEstimate estimate = EstimateMotion(options, pair);
  EXPECT_EQ(estimate.stopped, StopReason::kTimeLimit);
  EXPECT_THAT(estimate.message, HasSubstr("time limit of 0.001 ms"));
  EXPECT_FALSE(estimate.HasMotion());
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    options.time_limit = bad;
    const MotionEstimate refused = EstimateMotion(options, pair);
    EXPECT_EQ(refused.status, EstimateStatus::kInvalidInput);
    EXPECT_THAT(refused.message, HasSubstr("time_limit"));
  }
}

TEST(TimeLimit, AGenerousOneChangesNoBit) {
  const FramePair pair = ScenePair(SceneOptions(), 2);
  EstimateOptions options;
  const MotionEstimate plain = EstimateMotion(options, pair);
  const std::atomic<bool> cancel{false};
  options.time_limit = 1e6;
  options.cancel = &cancel;
  const MotionEstimate limited = EstimateMotion(options, pair);
  EXPECT_TRUE(SameBits(plain.pose, limited.pose));
  EXPECT_EQ(plain.iterations, limited.iterations);
  EXPECT_EQ(limited.stopped, StopReason::kNone);
  EXPECT_EQ(limited.message, "ok");
  EXPECT_EQ(limited.refine.termination, Termination::kConverged);
}

// RANSAC is done, the refinement is not: the motion is what it had by then.
TEST(TimeLimit, AFlagSetDuringTheRefinementLeavesTheBestByThen) {
  SceneOptions scene;
  scene.num_matches = 400;
  const FramePair pair = ScenePair(scene, 3);
  for (const RefineForm form : {RefineForm::kFull, RefineForm::kBundle}) {
    std::atomic<bool> cancel{false};
    int calls = 0;
    EstimateOptions options;
    options.cancel = &cancel;
    options.refine.form = form;
    options.refine.progress = [&](const RefineProgress& at) {
      ++calls;
      EXPECT_EQ(at.round, 1);
      EXPECT_GE(at.cost, 0.0);
      cancel = true;
    };
    const MotionEstimate estimate = EstimateMotion(options, pair);
    EXPECT_EQ(calls, 1) << RefineFormName(form);
    EXPECT_EQ(estimate.status, EstimateStatus::kSuccess);
    EXPECT_EQ(estimate.stopped, StopReason::kCancelled);
    EXPECT_EQ(estimate.message, "cancelled");
    EXPECT_LT(RotationErrorDeg(*pair.truth, estimate.pose), 1.0);
    EXPECT_GT(estimate.num_inliers, 300);
    EXPECT_TRUE(estimate.refine.exceeds_chance);
    ExpectNothingStated(estimate.refine);
  }
}

TEST(TimeLimit, ARefinementWithoutTimeKeepsItsStart) {
  const FramePair pair = ScenePair(SceneOptions(), 4);
  RefineOptions options;
  options.time_limit = 0.0;
  Pose pose = *pair.truth;
  const RefineSummary summary = RefinePair(options, pair, &pose);
  ExpectNothingStated(summary);
  EXPECT_EQ(summary.stopped, StopReason::kTimeLimit);
  EXPECT_EQ(summary.message, "stopped at the time limit of 0 ms");
  EXPECT_EQ(summary.num_iterations, 0);
  EXPECT_TRUE(SameBits(pose, *pair.truth));
  options.time_limit = -1.0;
  EXPECT_EQ(RefinePair(options, pair, &pose).termination, Termination::kFailure);
}

TEST(TimeLimit, ProgressTellsOfEachIteration) {
  const FramePair pair = ScenePair(SceneOptions(), 5);
  for (const RefineEngine engine : {RefineEngine::kAuto, RefineEngine::kCeres}) {
    std::vector<RefineProgress> steps;
    RefineOptions options;
    options.engine = engine;
    options.progress = [&](const RefineProgress& at) { steps.push_back(at); };
    Pose pose = *pair.truth;
    ASSERT_TRUE(RefinePair(options, pair, &pose).IsSolutionUsable());
    ASSERT_GE(steps.size(), 2u);
    EXPECT_EQ(steps.front().round, 1);
    for (size_t k = 1; k < steps.size(); ++k) {
      if (steps[k].round != steps[k - 1].round) continue;
      EXPECT_EQ(steps[k].iteration, steps[k - 1].iteration + 1);
      EXPECT_LE(steps[k].cost, steps[k - 1].cost);
    }
  }
}

// The work is counted, not timed.
TEST(Caps, WorkEndsTheLoopOfASlowSolverAtTheSameIterationEachTime) {
  const FramePair pair = HostilePair(300);
  EstimateOptions options;
  options.refine_motion = false;
  options.solver = "6pt-stewenius";
  options.ransac.max_work_us = 3e4;
  const MotionEstimate first = EstimateMotion(options, pair);
  const MotionEstimate second = EstimateMotion(options, pair);
  EXPECT_LE(first.iterations, 150);
  EXPECT_GE(first.iterations, 50);
  EXPECT_EQ(first.iterations, second.iterations);
  EXPECT_TRUE(SameBits(first.pose, second.pose));
  // A fast one makes all its iterations of it.
  options.solver = "3pt-approx";
  options.ransac.max_iterations = 1000;
  EXPECT_EQ(EstimateMotion(options, pair).iterations, 1000);
}

// Of many matches a part is scored; what is told is of all.
TEST(Caps, AScoredPartFindsTheMotionOfAll) {
  SceneOptions scene;
  scene.num_matches = 6000;
  scene.outlier_share = 0.6;
  const FramePair pair = ScenePair(scene, 6);
  EstimateOptions options;
  options.refine_motion = false;
  options.ransac.max_scored = 1 << 30;
  const MotionEstimate all = EstimateMotion(options, pair);
  options.ransac.max_scored = 500;
  const MotionEstimate part = EstimateMotion(options, pair);
  EXPECT_GT(part.num_inliers, 2000);
  EXPECT_NEAR(part.num_inliers, all.num_inliers, 0.02 * all.num_inliers);
  EXPECT_LT(RotationErrorDeg(*pair.truth, part.pose), 0.1);
  // As many as there are: nothing changes.
  options.ransac.max_scored = static_cast<int>(pair.matches.size());
  EXPECT_TRUE(SameBits(EstimateMotion(options, pair).pose, all.pose));
}

}  // namespace
}  // namespace rigel
