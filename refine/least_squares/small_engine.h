// Least squares on the Sampson errors of a frame pair without building a ceres::Problem: what local
// optimization in RANSAC and Refine() run on.
//
// Levenberg-Marquardt on the normal equations that sampson_kernel.h sums, so that an iteration
// costs little more than a look at each match: 600 matches and a robust loss from a hypothesis that
// is 1 degree off take a tenth of the time of a Problem (rigel_benchmark --refine).
#ifndef RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_
#define RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/least_squares.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"

namespace rigel {

// The matches of weight above zero, group by group: what is left out takes no time.
struct PackedMatches {
  // `weights`: grouped order.
  void Set(const GroupedMatches& matches, const std::vector<double>& weights);

  std::vector<double> x1, y1, x2, y2, weights;
  std::vector<PixelArrays> groups;  // into the arrays above
};

// Keeps its memory from call to call: no heap after the first.
class SmallEngine {
 public:
  // `matches` must outlive this object.
  explicit SmallEngine(const GroupedMatches& matches) : matches_(matches) {}
  SmallEngine(const SmallEngine&) = delete;
  SmallEngine& operator=(const SmallEngine&) = delete;

  // Minimizes over `parameters` (in: the start, out: the best found), parameterization.size() of
  // them. `weights` multiply the residuals (grouped order; 0 leaves a match out). The residuals of
  // `prior` at the motion are multiplied by `prior_unit`, pixels, and take no loss.
  LeastSquaresSummary Solve(const LeastSquaresOptions& options,
                            const MotionParameterization& parameterization,
                            const std::vector<double>& weights, const PriorResiduals& prior,
                            double prior_unit, double* parameters);

  // Over rotation and translation and the matches with mask[k] != 0 (grouped order; as many as
  // the matches). False, and `pose` unchanged, if no step lowers the cost or the result is not
  // finite.
  bool Minimize(const LeastSquaresOptions& options, const std::vector<char>& mask, Pose* pose);

  int num_iterations() const { return num_iterations_; }  // of the last call

 private:
  const GroupedMatches& matches_;
  std::vector<double> weights_;
  PackedMatches packed_;
  int num_iterations_ = 0;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_
