// Lines through points: the simplest thing that RANSAC can fit, for its tests.
#ifndef RIGEL_TEST_MINIMAL_RANSAC_LINE_SOLVER_H_
#define RIGEL_TEST_MINIMAL_RANSAC_LINE_SOLVER_H_

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/minimal/ransac/ransac.h"

namespace rigel {

struct Line {
  double slope = 0.0;
  double offset = 0.0;
  bool operator==(const Line& other) const {
    return slope == other.slope && offset == other.offset;
  }
};

// y = slope x + offset through points. Counts the calls.
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
    if (nan_first) solutions->push_back({std::nan(""), std::nan("")});
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

inline RansacResult<Line> Fit(const LineSolver& solver,
                              const RansacOptions& options = RansacOptions()) {
  std::vector<Line> solutions;
  return Ransac(solver, options, &solutions);
}

}  // namespace rigel

#endif  // RIGEL_TEST_MINIMAL_RANSAC_LINE_SOLVER_H_
