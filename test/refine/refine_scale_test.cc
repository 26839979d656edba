// What Refine() says of the length and the direction of t, and what holds them.
#include "rigel/refine/refine.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/parallel.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

TEST(RefineScale, ScaleIsObservableWhereMatchesBetweenCamerasSayIt) {
  int half_inter = 0, pure_intra = 0;
  constexpr int kPairs = 200;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions scene;
    scene.num_matches = 100;
    scene.inter_share = 0.5;
    FramePair pair = ScenePair(scene, index);
    Random random = Random::Stream(6, index);
    Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
    RefineSummary summary = RefinePair(RefineOptions(), pair, &pose);
    half_inter += summary.scale_observable && summary.IsSolutionUsable() &&
                  ScaleError(pair.truth->t, pose.t) < 0.05;

    scene.inter_share = 0.0;
    scene.rotation_deg = 0.0;
    pair = ScenePair(scene, index);
    pose = StartNear(*pair.truth, 0.05, 0.02, &random);
    summary = RefinePair(RefineOptions(), pair, &pose);
    EXPECT_TRUE(summary.IsSolutionUsable()) << index << ": " << summary.message;
    pure_intra += summary.scale_observable;
  }
  RecordProperty("half_inter", half_inter);
  RecordProperty("pure_intra", pure_intra);
  EXPECT_GE(half_inter, 198);
  EXPECT_LE(pure_intra, 2);
}

// Of 200 whole estimates: those that call the direction of t observable.
int CountObservable(double inter_share, const Pose* truth) {
  constexpr int kPairs = 200;
  std::vector<char> observable(kPairs);
  ParallelFor(kPairs, 2, [&](int index) {
    SceneOptions scene;
    scene.num_matches = 100;
    scene.inter_share = inter_share;
    scene.motion = MotionPattern::kRandom;
    FramePair pair;
    std::string error;
    const bool made = truth != nullptr ? MakeScenePair(scene, index, *truth, &pair, &error)
                                       : MakeScenePair(scene, index, &pair, &error);
    EstimateOptions options;
    options.solver = "4pt";
    observable[index] = made && EstimateMotion(options, pair).refine.translation_observable;
  });
  return static_cast<int>(std::count(observable.begin(), observable.end(), 1));
}

TEST(RefineScale, DirectionIsObservableOnlyWhereThereIsTranslation) {
  Pose turn;
  turn.R = ExpSO3(DegToRad(1.0) * Eigen::Vector3d::UnitY());
  for (const double inter_share : {0.0, 0.5}) {
    const int still = CountObservable(inter_share, &turn);
    const int moving = CountObservable(inter_share, nullptr);
    std::printf("[ measured ] inter %.1f: observable %d of 200 still, %d of 200 moving\n",
                inter_share, still, moving);
    EXPECT_LE(still, 4) << inter_share;
    EXPECT_GE(moving, 198) << inter_share;
  }
}

// Matches between cameras alone: at zero translation they leave t along the line of the cameras
// undetermined, so that the motion found may be long and is yet consistent with none.
TEST(RefineScale, DirectionIsNotObservableAtRestFromInterCameraMatchesAlone) {
  Pose turn;
  turn.R = ExpSO3(DegToRad(1.0) * Eigen::Vector3d::UnitY());
  const int still = CountObservable(1.0, &turn);
  const int moving = CountObservable(1.0, nullptr);
  std::printf("[ measured ] inter 1.0: observable %d of 200 still, %d of 200 moving\n", still,
              moving);
  EXPECT_LE(still, 4);
  EXPECT_GE(moving, 198);
}

TEST(RefineScale, FixedScaleKeepsTheLengthOfT) {
  for (const RefineForm form :
       {RefineForm::kFull, RefineForm::kPrior, RefineForm::kDepths, RefineForm::kPriorDepths}) {
    for (const double inter_share : {0.0, 0.5}) {
      SCOPED_TRACE(RefineFormName(form));
      SceneOptions scene;
      scene.inter_share = inter_share;
      const FramePair pair = ScenePair(scene, 4);
      Random random(4);
      Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
      const double length = pose.t.norm();
      RefineOptions options;
      options.form = form;
      options.prior_kind = PriorKind::kAxis;
      options.scale = ScaleMode::kFixed;
      options.threshold_px = 3.0;
      const RefineSummary summary = RefinePair(options, pair, &pose);
      ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
      EXPECT_NEAR(pose.t.norm(), length, 1e-9);
      ASSERT_TRUE(summary.covariance.has_value());
      EXPECT_LT((summary.covariance->block<3, 3>(3, 3) * pose.t).norm(), 1e-10);
    }
  }
}

TEST(RefineScale, FixedScaleHoldsTheDistanceOfThePrior) {
  SceneOptions scene;
  FramePair pair = ScenePair(scene, 4);
  Random random(4);
  RefineOptions options;
  options.scale = ScaleMode::kFixed;
  for (const double distance : {1.0, 2.5}) {
    pair.prior.distance = distance;
    Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
    ASSERT_TRUE(RefinePair(options, pair, &pose).IsSolutionUsable());
    EXPECT_NEAR(pose.t.norm(), distance, 1e-12);
  }
  // No direction can be held at a distance of zero: |t| stays as at the start.
  pair.prior.distance = 0.0;
  Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
  const double length = pose.t.norm();
  ASSERT_TRUE(RefinePair(options, pair, &pose).IsSolutionUsable());
  EXPECT_NEAR(pose.t.norm(), length, 1e-12);
}

// Wheel odometry of two percent on matches that say nothing of |t|.
TEST(RefineScale, ADistanceWithASigmaMakesTheScaleObservable) {
  SceneOptions scene;
  double error2 = 0.0;
  constexpr int kPairs = 50;
  for (int index = 0; index < kPairs; ++index) {
    FramePair pair = ScenePair(scene, index);
    Random random = Random::Stream(9, index);
    const double sigma = 0.02;
    pair.prior.distance = 1.0 + sigma * random.Normal();
    pair.prior.distance_sigma = sigma;
    RefineOptions options;
    options.use_prior = true;
    Pose pose = StartNear(*pair.truth, 0.05, 0.1, &random);
    const RefineSummary summary = RefinePair(options, pair, &pose);
    ASSERT_TRUE(summary.IsSolutionUsable());
    EXPECT_TRUE(summary.scale_observable) << index;
    EXPECT_NEAR(summary.relative_scale_sigma, sigma, 0.1 * sigma);
    error2 += std::pow(ScaleError(pair.truth->t, pose.t) / sigma, 2);
  }
  EXPECT_NEAR(std::sqrt(error2 / kPairs), 1.0, 0.3);
}

}  // namespace
}  // namespace rigel
