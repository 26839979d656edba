// Local optimization, in the loop and of the finalists.
#include "rigel/minimal/ransac/ransac.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "rigel/test/minimal/ransac/line_solver.h"

namespace rigel {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Ransac, BestMinimalIsTheBestHypothesisBeforeLocalOptimization) {
  const LineSolver solver(60, 60);
  RansacOptions options;
  options.min_iterations = 500;
  options.max_iterations = 500;
  const RansacResult<Line> with = Fit(solver, options);
  options.local_optimization = false;
  const RansacResult<Line> without = Fit(solver, options);
  // The same samples, so the same minimal hypotheses; optimization must not raise the bar.
  EXPECT_TRUE(with.best_minimal == without.best_minimal);
  EXPECT_EQ(with.minimal_score, without.minimal_score);
  EXPECT_TRUE(without.best == without.best_minimal);
  EXPECT_LT(with.score, with.minimal_score);
  EXPECT_FALSE(with.best == with.best_minimal);
}

TEST(Ransac, OptimizesOnlyHypothesesThatLead) {
  const LineSolver solver(60, 60);
  const RansacResult<Line> result = Fit(solver);
  EXPECT_GT(solver.optimizations, 0);
  EXPECT_LT(solver.optimizations, 20)
      << "about the logarithm of " << result.hypotheses << ", and the finalists";
}

// The best hypotheses are of the rising line, whose points have less noise; the falling one has
// more of them and wins once it is optimized.
TEST(Ransac, AFinalistCanWin) {
  int num_better = 0;
  for (uint64_t seed = 0; seed < 30; ++seed) {
    LineSolver solver(50, 0, 0.01, seed);
    solver.AddFalling(60, 0.35, seed + 100);
    solver.refuse_optimization = true;
    RansacOptions options;
    options.seed = seed;
    options.num_finalists = 0;
    const RansacResult<Line> without = Fit(solver, options);
    EXPECT_EQ(solver.loose_optimizations, 0);
    options.num_finalists = 6;
    const RansacResult<Line> with = Fit(solver, options);
    EXPECT_LE(solver.loose_optimizations, 6 + 1);  // and the best one
    // Finalists come after the loop and change nothing of it.
    EXPECT_EQ(with.iterations, without.iterations);
    EXPECT_TRUE(with.best_minimal == without.best_minimal);
    EXPECT_LE(with.score, without.score);
    int inliers = 0;
    EXPECT_EQ(solver.Score(with.best, kInf, &inliers), with.score);
    EXPECT_EQ(inliers, with.num_inliers);
    // The best line itself may get better, too.
    if (with.score < without.score && with.best.slope < 0) {
      ++num_better;
      EXPECT_NEAR(with.best.slope, -3.0, 0.1);
    }
  }
  // 10 when this was written; in the others a falling line leads already.
  EXPECT_GE(num_better, 5);
}

TEST(Ransac, OptimizesNoMoreFinalistsThanAskedFor) {
  for (const int num_finalists : {0, 1, 6, kMaxFinalists}) {
    const LineSolver solver(40, 80);
    RansacOptions options;
    options.num_finalists = num_finalists;
    Fit(solver, options);
    // With the best line, of which the finalist that resembles it is left out.
    EXPECT_LE(solver.loose_optimizations, num_finalists > 0 ? num_finalists + 1 : 0);
    // It stops after two that do not help.
    EXPECT_GE(solver.loose_optimizations, std::min(num_finalists, 2));
  }
}

TEST(Ransac, ABadOptimizationIsNotTaken) {
  LineSolver solver(60, 60);
  solver.spoil_optimization = true;
  const RansacResult<Line> result = Fit(solver);
  EXPECT_GT(solver.optimizations, 0);
  EXPECT_TRUE(result.best == result.best_minimal);
  EXPECT_EQ(result.score, result.minimal_score);
}

}  // namespace
}  // namespace rigel
