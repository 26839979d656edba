#include "rigel/minimal/ransac/ransac.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Line {
  double slope = 0.0;
  double offset = 0.0;
  bool operator==(const Line& other) const {
    return slope == other.slope && offset == other.offset;
  }
};

// y = slope x + offset through points, the simplest thing that RANSAC can fit. Counts the calls.
class LineSolver {
 public:
  using Model = Line;
  using Solutions = std::vector<Line>;

  // y = 2 x - 1 with noise 0.1, and outliers anywhere in [-50, 50].
  LineSolver(int num_inliers, int num_outliers, double noise = 0.1, uint64_t seed = 1) {
    Random random(seed);
    for (int k = 0; k < num_inliers + num_outliers; ++k) {
      const double x = random.Uniform(-10.0, 10.0);
      const double good = 2.0 * x - 1.0 + noise * random.Normal();
      const double bad = random.Uniform(-50.0, 50.0);
      x_.push_back(x);
      y_.push_back(k < num_inliers ? good : bad);
    }
  }

  // `count` more points, of y = -3 x + 2 with noise.
  void AddFalling(int count, double noise, uint64_t seed) {
    Random random(seed);
    for (int k = 0; k < count; ++k) {
      const double x = random.Uniform(-10.0, 10.0);
      x_.push_back(x);
      y_.push_back(-3.0 * x + 2.0 + noise * random.Normal());
    }
  }

  int num_data() const { return static_cast<int>(x_.size()); }
  int sample_size() const { return 2; }

  bool Draw(Random* random, int* sample) const {
    ++draws;
    if (num_data() < 2 || draws > max_draws) return false;
    sample[0] = random->Index(num_data());
    sample[1] = random->Index(num_data() - 1);
    if (sample[1] >= sample[0]) ++sample[1];
    return true;
  }

  double Work(int num_solutions) const { return 1.0 + num_solutions; }
  int MinimalSolver(const int* sample, Solutions* solutions) const {
    solutions->clear();
    const double dx = x_[sample[1]] - x_[sample[0]];
    if (dx == 0.0) return 0;
    Line line;
    line.slope = (y_[sample[1]] - y_[sample[0]]) / dx;
    line.offset = y_[sample[0]] - line.slope * x_[sample[0]];
    if (nan_first) solutions->push_back({kNan, kNan});
    solutions->push_back(line);
    if (minus_twin) solutions->push_back({-line.slope, line.offset});
    return static_cast<int>(solutions->size());
  }

  // As the score of what Admit makes of the line, or lower.
  double QuickScore(Line line, double bound) const {
    ++quick_scores;
    if (zero_quick_score) return 0.0;
    if (flip_negative && line.slope < 0) line.slope = -line.slope;
    int inliers = 0;
    --scores;
    return Score(line, bound, &inliers);
  }

  double Score(const Line& line, double bound, int* inliers) const {
    ++scores;
    return TruncatedSum(line, 1.0, bound, inliers);
  }

  bool Admit(Line* line) const {
    if (admit_none) return false;
    if (flip_negative && line->slope < 0) line->slope = -line->slope;
    return true;
  }

  bool LocalOptimize(Line* line) const {
    ++optimizations;
    if (refuse_optimization) return false;
    if (spoil_optimization) {
      line->slope += 100.0;
      return true;
    }
    return LeastSquares(1.0, line);
  }

  bool BailsOut(const Line&, double best) const {
    ++bail_outs;
    EXPECT_TRUE(std::isfinite(best));
    return bail_out_always;
  }

  double LooseScore(const Line& line, double bound) const {
    int inliers = 0;
    return TruncatedSum(line, 9.0, bound, &inliers);
  }

  bool OptimizeLoosely(Line* line) const {
    ++loose_optimizations;
    if (spoil_optimization) {
      line->slope += 100.0;
      return true;
    }
    return LeastSquares(9.0, line) && LeastSquares(1.0, line);
  }

  bool Similar(const Line& a, const Line& b) const {
    return std::abs(a.slope - b.slope) < 0.5 && std::abs(a.offset - b.offset) < 5.0;
  }

  mutable int draws = 0;
  mutable int scores = 0;
  mutable int quick_scores = 0;
  mutable int optimizations = 0;
  mutable int bail_outs = 0;
  mutable int loose_optimizations = 0;
  int max_draws = 1 << 30;
  bool nan_first = false;
  bool minus_twin = false;
  bool use_bound = true;
  bool admit_none = false;
  bool flip_negative = false;
  bool spoil_optimization = false;
  bool zero_quick_score = false;
  bool refuse_optimization = false;
  bool bail_out_always = false;

 private:
  double TruncatedSum(const Line& line, double threshold2, double bound, int* inliers) const {
    double sum = 0.0;
    *inliers = 0;
    for (size_t k = 0; k < x_.size(); ++k) {
      const double r = y_[k] - line.slope * x_[k] - line.offset;
      // A NaN goes into the sum: the score is NaN.
      sum += r * r >= threshold2 ? threshold2 : r * r;
      *inliers += r * r < threshold2;
      if (use_bound && sum > bound) return sum;
    }
    return sum;
  }

  // On the points within the threshold.
  bool LeastSquares(double threshold2, Line* line) const {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t k = 0; k < x_.size(); ++k) {
      const double r = y_[k] - line->slope * x_[k] - line->offset;
      if (!(r * r < threshold2)) continue;
      n += 1;
      sx += x_[k];
      sy += y_[k];
      sxx += x_[k] * x_[k];
      sxy += x_[k] * y_[k];
    }
    const double determinant = n * sxx - sx * sx;
    if (!(determinant > 1e-9)) return false;
    line->slope = (n * sxy - sx * sy) / determinant;
    line->offset = (sy - line->slope * sx) / n;
    return true;
  }

  std::vector<double> x_, y_;
};

RansacResult<Line> Fit(const LineSolver& solver, const RansacOptions& options = RansacOptions()) {
  std::vector<Line> solutions;
  return Ransac(solver, options, &solutions);
}

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

TEST(RansacOptions, SaysWhatIsWrong) {
  std::string error = "untouched";
  EXPECT_TRUE(RansacOptions().IsValid(&error));
  EXPECT_EQ(error, "untouched");
  struct Case {
    const char* name;
    void (*damage)(RansacOptions*);
  };
  const Case cases[] = {
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = 1e-13; }},
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = -1.0; }},
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = kNan; }},
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = kInf; }},
      {"confidence", [](RansacOptions* o) { o->confidence = 0.0; }},
      {"confidence", [](RansacOptions* o) { o->confidence = 1.0; }},
      {"confidence", [](RansacOptions* o) { o->confidence = kNan; }},
      {"max_iterations", [](RansacOptions* o) { o->max_iterations = 0; }},
      {"min_iterations", [](RansacOptions* o) { o->min_iterations = -1; }},
      {"num_finalists", [](RansacOptions* o) { o->num_finalists = -1; }},
      {"num_finalists", [](RansacOptions* o) { o->num_finalists = kMaxFinalists + 1; }},
  };
  for (const Case& c : cases) {
    RansacOptions options;
    c.damage(&options);
    EXPECT_FALSE(options.IsValid(&error)) << c.name;
    EXPECT_THAT(error, HasSubstr(c.name));
  }
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
