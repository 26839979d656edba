// What speaks against a motion, and that nothing does against the right one.
#include "rigel/refine/search/doubt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/grouped_matches.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;

TEST(Doubt, TellsFewInliersLooseResidualsAndAMotionThatLeavesThePrior) {
  constexpr double kThresholdPx = 1.5;
  SceneOptions scene;
  scene.num_matches = 400;
  scene.outlier_share = 0.3;
  const FramePair pair = ScenePair(scene, 0);
  const SolverInfo& axis = *FindSolver("4pt-axis");
  MotionPrior prior = pair.prior;
  const auto doubt = [&](const SolverInfo& solver, const FramePair& p, double threshold_px) {
    return FindDoubt(prior, solver, *p.truth, GroupedMatches(p.rig, p.matches), threshold_px);
  };
  EXPECT_FALSE(doubt(axis, pair, kThresholdPx).Any());
  EXPECT_EQ(doubt(axis, pair, kThresholdPx).Reason(), "");
  // The threshold cuts through the residuals: 87 percent of them, and at twice the threshold all.
  scene.outlier_share = 0.0;
  const FramePair clean = ScenePair(scene, 0);
  EXPECT_TRUE(doubt(axis, clean, 0.5 * kThresholdPx).loose_residuals);
  EXPECT_THAT(doubt(axis, clean, 0.5 * kThresholdPx).Reason(), HasSubstr("twice the threshold"));
  EXPECT_FALSE(doubt(axis, clean, kThresholdPx).Any());
  scene.outlier_share = 0.55;
  const FramePair bad = ScenePair(scene, 0);
  const Doubt few = doubt(axis, bad, kThresholdPx);
  EXPECT_TRUE(few.few_inliers);
  EXPECT_FALSE(few.SaysWrong());
  EXPECT_THAT(few.Reason(), HasSubstr("of 400 matches agree"));
  prior.axis = ExpSO3(Eigen::Vector3d(0, 0, 1.5)) * *prior.axis;
  scene.outlier_share = 0.3;
  scene.rotation_deg = 5.0;
  const FramePair turned = ScenePair(scene, 0);
  EXPECT_TRUE(doubt(axis, turned, kThresholdPx).leaves_prior);
  EXPECT_THAT(doubt(axis, turned, kThresholdPx).Reason(), HasSubstr("away from the prior"));
  EXPECT_FALSE(doubt(*FindSolver("5pt+1"), turned, kThresholdPx).Any());
}

// The threshold follows the noise, so errors of any size are below it.
TEST(Doubt, TellsNoiseThatNoMatcherHas) {
  for (const double noise_px : {0.5, 2.0, 4.0}) {
    SceneOptions scene;
    scene.noise_px = noise_px;
    const MotionEstimate e = EstimateMotion(EstimateOptions(), ScenePair(scene, 0));
    EXPECT_EQ(e.doubtful, noise_px > kDoubtfulNoisePx) << e.doubt;
    if (e.doubtful) {
      EXPECT_THAT(e.doubt, HasSubstr("noise is"));
    }
  }
}

}  // namespace
}  // namespace rigel
