// What the loop finds, and after how many iterations.
#include "rigel/minimal/ransac/ransac.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/minimal/ransac/line_solver.h"

namespace rigel {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Ransac, FindsTheModelAmongOutliers) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const LineSolver solver(60, 60, 0.1, seed);
    const RansacResult<Line> result = Fit(solver);
    ASSERT_TRUE(result.found);
    EXPECT_NEAR(result.best.slope, 2.0, 0.02) << seed;
    EXPECT_NEAR(result.best.offset, -1.0, 0.1) << seed;
    EXPECT_GE(result.num_inliers, 60);
    EXPECT_LT(result.num_inliers, 75);
  }
}

TEST(Ransac, ReportsTheScoreAndInliersOfItsModels) {
  const LineSolver solver(60, 60);
  const RansacResult<Line> result = Fit(solver);
  int inliers = 0;
  EXPECT_EQ(solver.Score(result.best, kInf, &inliers), result.score);
  EXPECT_EQ(inliers, result.num_inliers);
  EXPECT_EQ(solver.Score(result.best_minimal, kInf, &inliers), result.minimal_score);
}

TEST(Ransac, IsDeterministicPerSeed) {
  const LineSolver solver(40, 80);
  RansacOptions options;
  options.local_optimization = false;
  const RansacResult<Line> first = Fit(solver, options);
  const RansacResult<Line> second = Fit(solver, options);
  EXPECT_TRUE(first.best == second.best);
  EXPECT_EQ(first.score, second.score);
  EXPECT_EQ(first.iterations, second.iterations);
  EXPECT_EQ(first.hypotheses, second.hypotheses);
  options.seed = 2;
  EXPECT_FALSE(first.best == Fit(solver, options).best) << "the seed is used";
}

TEST(Ransac, InlierCountKeepsTheFirstHypothesisWithTheMostInliers) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const LineSolver solver(60, 60, 0.5, seed);
    RansacOptions options;
    options.score = ScoreKind::kInlierCount;
    options.local_optimization = false;
    options.min_iterations = options.max_iterations = 200;
    const RansacResult<Line> result = Fit(solver, options);
    Random random(options.seed);
    int most = -1;
    Line best;
    std::vector<Line> lines;
    for (int k = 0; k < 200; ++k) {
      int sample[2];
      solver.Draw(&random, sample);
      solver.MinimalSolver(sample, &lines);
      for (const Line& line : lines) {
        int inliers = 0;
        solver.Score(line, kInf, &inliers);
        if (inliers <= most) continue;
        most = inliers;
        best = line;
      }
    }
    EXPECT_TRUE(result.best_minimal == best) << seed;
    EXPECT_EQ(result.num_inliers, most) << seed;
    EXPECT_EQ(result.score, 120 - most) << seed;
  }
}

TEST(Ransac, NeverExceedsMaxIterations) {
  for (const int max_iterations : {1, 2, 17}) {
    // One inlier: nothing good will be found, and min_iterations asks for more.
    const LineSolver solver(1, 99);
    RansacOptions options;
    options.max_iterations = max_iterations;
    const RansacResult<Line> result = Fit(solver, options);
    EXPECT_EQ(result.iterations, max_iterations);
    EXPECT_EQ(solver.draws, max_iterations);
  }
}

TEST(Ransac, IterationsAdaptToTheShareOfInliers) {
  RansacOptions options;
  options.min_iterations = 0;
  const RansacResult<Line> easy = Fit(LineSolver(100, 0), options);
  EXPECT_LE(easy.iterations, 10);
  // 36 of 120 inliers or a few more by chance: (0.3)^2 = 0.09, 98 iterations at 0.9999.
  const RansacResult<Line> hard = Fit(LineSolver(36, 84), options);
  const int needed = IterationsNeeded(hard.num_inliers / 120.0, 2, options.confidence, 10000);
  EXPECT_GE(hard.iterations, needed);
  EXPECT_LE(hard.iterations, needed + 40);
  EXPECT_GT(needed, 60);
  options.confidence = 0.5;
  EXPECT_LT(Fit(LineSolver(36, 84), options).iterations, hard.iterations);
  options.min_iterations = 300;
  EXPECT_EQ(Fit(LineSolver(36, 84), options).iterations, 300);
}

TEST(Ransac, StopsWhereNoSampleCanBeDrawn) {
  LineSolver solver(60, 60);
  solver.max_draws = 0;
  RansacResult<Line> result = Fit(solver);
  EXPECT_FALSE(result.found);
  EXPECT_EQ(result.hypotheses, 0);
  EXPECT_EQ(solver.draws, 1);
  // After a few good ones the best so far remains.
  LineSolver later(60, 0);
  later.max_draws = 3;
  result = Fit(later);
  EXPECT_TRUE(result.found);
  EXPECT_EQ(later.draws, 4);
  EXPECT_FALSE(Fit(LineSolver(1, 0)).found) << "fewer data than a sample";
  EXPECT_FALSE(Fit(LineSolver(0, 0)).found);
}

TEST(Ransac, IterationsNeeded) {
  // log(1 - confidence) / log(1 - ratio^size), rounded up.
  EXPECT_EQ(IterationsNeeded(0.5, 4, 0.99, 10000), 72);
  EXPECT_EQ(IterationsNeeded(0.5, 4, 0.9999, 10000), 143);
  EXPECT_EQ(IterationsNeeded(0.7, 3, 0.99, 10000), 11);
  EXPECT_EQ(IterationsNeeded(0.5, 17, 0.9999, 10000), 10000) << "1.2 million";
  EXPECT_EQ(IterationsNeeded(0.5, 4, 0.99, 50), 50);
  EXPECT_EQ(IterationsNeeded(1.0, 4, 0.99, 10000), 1);
  EXPECT_EQ(IterationsNeeded(1.5, 4, 0.99, 10000), 1);
  EXPECT_EQ(IterationsNeeded(0.999999, 1, 0.5, 10000), 1);
  EXPECT_EQ(IterationsNeeded(0.0, 4, 0.99, 10000), 10000);
  EXPECT_EQ(IterationsNeeded(-0.1, 4, 0.99, 10000), 10000);
  EXPECT_EQ(IterationsNeeded(kNan, 4, 0.99, 10000), 10000);
  // ratio^size below 1e-16 must not become log(1) = 0 and a division by it.
  EXPECT_EQ(IterationsNeeded(1e-6, 4, 0.99, 10000), 10000);
}

struct NotASolver {
  using Model = Line;
  using Solutions = std::vector<Line>;
  int num_data() const { return 0; }
};

TEST(Ransac, TheConceptIsChecked) {
  EXPECT_TRUE(IsRansacSolver<LineSolver>::value);
  EXPECT_FALSE(IsRansacSolver<NotASolver>::value);
  EXPECT_FALSE(IsRansacSolver<int>::value);
}

}  // namespace
}  // namespace rigel
