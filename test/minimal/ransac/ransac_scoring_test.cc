// Which hypotheses are scored, and what their scores decide.
#include "rigel/minimal/ransac/ransac.h"

#include <limits>

#include <gtest/gtest.h>

#include "rigel/test/minimal/ransac/line_solver.h"

namespace rigel {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Ransac, EarlyStopsDoNotChangeTheResult) {
  LineSolver solver(40, 80);
  const RansacResult<Line> bounded = Fit(solver);
  solver.use_bound = false;
  const RansacResult<Line> full = Fit(solver);
  EXPECT_TRUE(bounded.best == full.best);
  EXPECT_TRUE(bounded.best_minimal == full.best_minimal);
  EXPECT_EQ(bounded.iterations, full.iterations);
}

TEST(Ransac, AHypothesisThatBailsOutIsNotScored) {
  LineSolver solver(40, 80);
  RansacOptions options;
  options.local_optimization = false;
  const RansacResult<Line> all = Fit(solver, options);
  EXPECT_GT(solver.bail_outs, 0);
  EXPECT_LT(solver.bail_outs, all.hypotheses) << "there is nothing to lose to before the first";
  solver.bail_out_always = true;
  solver.quick_scores = 0;
  EXPECT_TRUE(Fit(solver, options).found);
  EXPECT_EQ(solver.quick_scores, 1) << "the first wins";
  solver.bail_outs = 0;
  options.bail_out = false;
  EXPECT_TRUE(all.best == Fit(solver, options).best);
  EXPECT_EQ(solver.bail_outs, 0);
  options.bail_out = true;
  options.score = ScoreKind::kInlierCount;
  Fit(solver, options);
  EXPECT_EQ(solver.bail_outs, 0) << "a count is no sum";
}

TEST(Ransac, IgnoresNanHypotheses) {
  LineSolver solver(60, 60);
  const RansacResult<Line> expected = Fit(solver);
  solver.nan_first = true;
  const RansacResult<Line> result = Fit(solver);
  EXPECT_TRUE(result.found);
  EXPECT_TRUE(result.best == expected.best);
  EXPECT_EQ(result.hypotheses, 2 * expected.hypotheses);
}

TEST(Ransac, IgnoresNanScores) {
  // Where the quick score lets a NaN through.
  LineSolver solver(60, 60);
  const RansacResult<Line> expected = Fit(solver);
  solver.nan_first = true;
  solver.zero_quick_score = true;
  const RansacResult<Line> result = Fit(solver);
  EXPECT_TRUE(result.best == expected.best);
  EXPECT_TRUE(result.best_minimal == expected.best_minimal);
}

TEST(Ransac, TriesEverySolutionOfASample) {
  LineSolver solver(60, 60);
  const RansacResult<Line> expected = Fit(solver);
  solver.minus_twin = true;
  const RansacResult<Line> result = Fit(solver);
  EXPECT_TRUE(result.best == expected.best);
  EXPECT_EQ(result.hypotheses, 2 * result.iterations);
}

TEST(Ransac, TheQuickScoreSavesTheFullOneAndDecidesNothing) {
  LineSolver solver(40, 80);
  const RansacResult<Line> quick = Fit(solver);
  EXPECT_EQ(solver.quick_scores, quick.hypotheses);
  EXPECT_LT(solver.scores, 40) << "only for hypotheses that lead, and the finalists";
  // The loosest of all bounds, 0, rejects nothing.
  solver.zero_quick_score = true;
  const RansacResult<Line> full = Fit(solver);
  EXPECT_TRUE(quick.best == full.best);
  EXPECT_TRUE(quick.best_minimal == full.best_minimal);
  EXPECT_EQ(quick.score, full.score);
  EXPECT_EQ(quick.iterations, full.iterations);
}

TEST(Ransac, WhatIsNotAdmittedIsNotFound) {
  LineSolver solver(60, 60);
  solver.admit_none = true;
  const RansacResult<Line> result = Fit(solver);
  EXPECT_FALSE(result.found);
  EXPECT_GT(result.hypotheses, 0);
  EXPECT_EQ(solver.optimizations, 0);
}

TEST(Ransac, AModelThatAdmitChangedIsScoredAnew) {
  // Admit turns -2 x - 1 into 2 x - 1, or a wrong line into another wrong one.
  LineSolver solver(60, 60);
  solver.flip_negative = true;
  const RansacResult<Line> result = Fit(solver);
  ASSERT_TRUE(result.found);
  int inliers = 0;
  EXPECT_EQ(solver.Score(result.best_minimal, kInf, &inliers), result.minimal_score);
  EXPECT_EQ(solver.Score(result.best, kInf, &inliers), result.score);
  EXPECT_EQ(inliers, result.num_inliers);
  EXPECT_GE(result.best_minimal.slope, 0.0);
}

}  // namespace
}  // namespace rigel
