// The solver "auto": what it takes, and that a wrong prior costs time and not accuracy.
#include "rigel/refine/solver_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> Names(const MotionPrior& prior) {
  std::vector<std::string> names;
  for (const SolverInfo* solver : SuggestSolvers(prior)) names.emplace_back(solver->name);
  return names;
}

TEST(SolverChoice, TakesTheMostConstrainedThatThePriorAllows) {
  MotionPrior prior;
  EXPECT_EQ(Names(prior), (std::vector<std::string>{"5pt+1", "6pt-ventura", "17pt-li"}));
  prior.axis = Eigen::Vector3d::UnitY();
  EXPECT_EQ(Names(prior),
            (std::vector<std::string>{"4pt-axis", "5pt+1", "6pt-ventura", "17pt-li"}));
  prior.gravity1 = prior.gravity2 = Eigen::Vector3d::UnitY();
  EXPECT_EQ(Names(prior),
            (std::vector<std::string>{"4pt", "4pt-axis", "5pt+1", "6pt-ventura", "17pt-li"}));
  prior.normal = Eigen::Vector3d::UnitY();
  EXPECT_EQ(Names(prior), (std::vector<std::string>{"3pt", "4pt", "4pt-axis", "5pt+1",
                                                    "6pt-ventura", "17pt-li"}));
  EXPECT_STREQ(SuggestSolver(prior).name, "3pt");
  // A direction that is none is no prior.
  prior.normal->setZero();
  EXPECT_EQ(Names(prior).front(), "4pt");
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
    others += wrong.solver == "5pt+1" && wrong.solver != right.solver;
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
  EXPECT_EQ(EstimateMotion(options, pair).trials.size(), 1u);
  pair.prior = MotionPrior();
  EXPECT_NE(EstimateMotion(options, pair).status, EstimateStatus::kSuccess);
}

// Rings of as many cameras as matches: of no camera pair are there five.
TEST(SolverChoice, RigsWithoutFiveMatchesInOneCameraPairAreSolved) {
  for (const int cameras : {8, 16}) {
    SceneOptions scene;
    scene.ring = true;
    scene.num_cameras = cameras;
    scene.num_matches = 4 * cameras;
    scene.rotation_axis = RotationAxisPattern::kRandom;
    scene.rotation_deg = 12.0;
    scene.motion = MotionPattern::kRandom;
    for (const bool wrong_prior : {false, true}) {
      FramePair pair = ScenePair(scene, cameras);
      pair.prior = MotionPrior();
      if (wrong_prior) pair.prior.axis = Eigen::Vector3d::UnitY();
      const MotionEstimate estimate = EstimateMotion(EstimateOptions(), pair);
      ASSERT_EQ(estimate.status, EstimateStatus::kSuccess) << estimate.message;
      EXPECT_EQ(estimate.solver, "6pt-ventura");
      EXPECT_LT(RotationErrorDeg(*pair.truth, estimate.pose), 0.3) << cameras;
      bool told = false;
      for (const SolverTrial& trial : estimate.trials) {
        told = told || (trial.solver == "5pt+1" && trial.note == "no camera pair has 5 matches");
      }
      EXPECT_TRUE(told);
      EXPECT_FALSE(estimate.doubtful) << estimate.doubt;
    }
  }
}

// A body whose down is z, and a prior that says it is y.
TEST(SolverChoice, AWrongAxisIsToldAndAutoFindsTheMotion) {
  for (int index = 0; index < 5; ++index) {
    SceneOptions scene;
    scene.num_matches = 400;
    scene.rotation_deg = 12.0;
    FramePair pair = ScenePair(scene, index);
    pair.prior.gravity1 = pair.prior.gravity2 = Eigen::Vector3d::UnitZ();
    pair.prior.axis = pair.prior.normal = Eigen::Vector3d::UnitZ();
    EstimateOptions options;
    const MotionEstimate found = EstimateMotion(options, pair);
    ASSERT_EQ(found.status, EstimateStatus::kSuccess) << found.message;
    EXPECT_EQ(found.solver, "5pt+1");
    EXPECT_LT(RotationErrorDeg(*pair.truth, found.pose), 0.2);
    EXPECT_FALSE(found.doubtful) << found.doubt;
    EXPECT_THAT(found.trials[0].note, HasSubstr("doubtful: "));
    options.solver = "4pt-axis";
    options.ransac.max_iterations = 1000;
    const MotionEstimate wrong = EstimateMotion(options, pair);
    if (!wrong.HasMotion()) continue;
    EXPECT_TRUE(wrong.doubtful);
    EXPECT_NE(wrong.doubt, "");
  }
}

// All together make no more iterations than one alone may.
TEST(SolverChoice, TheSolversShareOneBudget) {
  SceneOptions scene;
  scene.outlier_share = 1.0;
  const FramePair pair = ScenePair(scene, 3);
  for (const int budget : {1, 7, 150, 1000}) {
    EstimateOptions options;
    options.ransac.max_iterations = budget;
    const MotionEstimate estimate = EstimateMotion(options, pair);
    EXPECT_LE(estimate.iterations, budget);
    EXPECT_GE(estimate.iterations, std::min(budget, 100));
    EXPECT_FALSE(estimate.HasMotion()) << budget;
  }
}

// A motion that contradicts its prior and is found without one as well is that of the latter.
TEST(SolverChoice, AConfirmedMotionIsNotDoubtedForItsPrior) {
  int confirmed = 0;
  for (int index = 0; index < 20; ++index) {
    SceneOptions scene;
    scene.num_matches = 400;
    scene.rotation_deg = 5.0;
    scene.rotation_axis = RotationAxisPattern::kRandom;
    FramePair pair = ScenePair(scene, index);
    pair.prior.gravity1 = pair.prior.gravity2 = Eigen::Vector3d::UnitY();
    pair.prior.axis = pair.prior.normal = Eigen::Vector3d::UnitY();
    const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
    ASSERT_EQ(e.status, EstimateStatus::kSuccess) << e.message;
    EXPECT_THAT(e.doubt, testing::Not(HasSubstr("away from the prior"))) << e.solver;
    for (const SolverTrial& trial : e.trials) EXPECT_NE(trial.note, "") << trial.solver;
    confirmed += e.solver == "5pt+1" ? 1 : 0;
  }
  EXPECT_GE(confirmed, 10);
}

}  // namespace
}  // namespace rigel
