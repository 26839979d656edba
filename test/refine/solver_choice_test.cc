// The solver "auto": what it takes, and that a wrong prior costs time and not accuracy.
#include "rigel/refine/solver_choice.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

std::vector<std::string> Names(const MotionPrior& prior) {
  std::vector<std::string> names;
  for (const SolverInfo* solver : SuggestSolvers(prior)) names.emplace_back(solver->name);
  return names;
}

TEST(SolverChoice, TakesTheMostConstrainedThatThePriorAllows) {
  MotionPrior prior;
  EXPECT_EQ(Names(prior), (std::vector<std::string>{"5pt+1"}));
  prior.axis = Eigen::Vector3d::UnitY();
  EXPECT_EQ(Names(prior), (std::vector<std::string>{"4pt-axis", "5pt+1"}));
  prior.gravity1 = prior.gravity2 = Eigen::Vector3d::UnitY();
  EXPECT_EQ(Names(prior), (std::vector<std::string>{"4pt", "4pt-axis", "5pt+1"}));
  prior.normal = Eigen::Vector3d::UnitY();
  EXPECT_EQ(Names(prior), (std::vector<std::string>{"3pt", "4pt", "4pt-axis", "5pt+1"}));
  EXPECT_STREQ(SuggestSolver(prior).name, "3pt");
  // A direction that is none is no prior.
  prior.normal->setZero();
  EXPECT_EQ(Names(prior).front(), "4pt");
}

TEST(SolverChoice, DoubtsFewInliersLooseResidualsAndAMotionThatLeavesThePrior) {
  constexpr double kThresholdPx = 1.5;
  SceneOptions scene;
  scene.num_matches = 400;
  scene.outlier_share = 0.3;
  const FramePair pair = ScenePair(scene, 0);
  const GroupedMatches matches(pair.rig, pair.matches);
  const SolverInfo& axis = *FindSolver("4pt-axis");
  MotionPrior prior = pair.prior;
  EXPECT_FALSE(IsDoubtful(prior, axis, *pair.truth, matches, kThresholdPx));
  // The threshold cuts through the residuals: 87 percent of them, and at twice the threshold all.
  scene.outlier_share = 0.0;
  const FramePair clean = ScenePair(scene, 0);
  const GroupedMatches clean_matches(clean.rig, clean.matches);
  EXPECT_TRUE(IsDoubtful(prior, axis, *clean.truth, clean_matches, 0.5 * kThresholdPx));
  EXPECT_FALSE(IsDoubtful(prior, axis, *clean.truth, clean_matches, kThresholdPx));
  scene.outlier_share = 0.55;
  const FramePair bad = ScenePair(scene, 0);
  EXPECT_TRUE(
      IsDoubtful(prior, axis, *bad.truth, GroupedMatches(bad.rig, bad.matches), kThresholdPx));
  prior.axis = ExpSO3(Eigen::Vector3d(0, 0, 1.5)) * *prior.axis;
  scene.outlier_share = 0.3;
  scene.rotation_deg = 5.0;
  const FramePair turned = ScenePair(scene, 0);
  const GroupedMatches turned_matches(turned.rig, turned.matches);
  EXPECT_TRUE(IsDoubtful(prior, axis, *turned.truth, turned_matches, kThresholdPx));
  EXPECT_FALSE(
      IsDoubtful(prior, *FindSolver("5pt+1"), *turned.truth, turned_matches, kThresholdPx));
}

// Every prior off by 20 degrees, turns of 10 degrees, 30 percent of outliers.
TEST(SolverChoice, AWrongPriorCostsNoAccuracy) {
  double right2 = 0.0, wrong2 = 0.0;
  int others = 0;
  constexpr int kPairs = 40;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions scene;
    scene.num_matches = 300;
    scene.outlier_share = 0.3;
    scene.rotation_deg = 10.0;
    scene.motion = index % 2 == 0 ? MotionPattern::kPlanar : MotionPattern::kRandom;
    FramePair pair = ScenePair(scene, index);
    EstimateOptions options;
    options.solver = kAutoSolver;
    options.refine.noise_px = scene.noise_px;
    const MotionEstimate right = EstimateMotion(options, pair);
    ASSERT_EQ(right.status, EstimateStatus::kSuccess);
    EXPECT_EQ(right.solver, index % 2 == 0 ? "3pt" : "4pt") << index;
    const Eigen::Matrix3d off = ExpSO3(DegToRad(20.0) * Eigen::Vector3d::UnitX());
    pair.prior.gravity2 = off * *pair.prior.gravity2;
    pair.prior.axis = off * *pair.prior.axis;
    if (pair.prior.normal) pair.prior.normal = off * *pair.prior.normal;
    const MotionEstimate wrong = EstimateMotion(options, pair);
    ASSERT_EQ(wrong.status, EstimateStatus::kSuccess);
    others += wrong.solver != right.solver;
    right2 += std::pow(RotationErrorDeg(*pair.truth, right.pose), 2);
    wrong2 += std::pow(RotationErrorDeg(*pair.truth, wrong.pose), 2);
  }
  std::printf(
      "[ measured ] rotation RMS %.4f deg, with the wrong prior %.4f, another solver in %d\n",
      std::sqrt(right2 / kPairs), std::sqrt(wrong2 / kPairs), others);
  EXPECT_LT(std::sqrt(wrong2 / right2), 1.1);
  EXPECT_GT(others, kPairs / 4);
}

TEST(SolverChoice, WithAnExactPriorTheFirstStands) {
  SceneOptions scene;
  scene.motion = MotionPattern::kPlanar;
  FramePair pair = ScenePair(scene, 1);
  pair.prior.normal = ExpSO3(DegToRad(20.0) * Eigen::Vector3d::UnitX()) * *pair.prior.normal;
  EstimateOptions options;
  options.solver = kAutoSolver;
  options.refine.form = RefineForm::kPrior;
  EXPECT_EQ(EstimateMotion(options, pair).solver, "3pt");
  pair.prior = MotionPrior();
  EXPECT_NE(EstimateMotion(options, pair).status, EstimateStatus::kSuccess);
}

}  // namespace
}  // namespace rigel
