// Least squares on the Sampson errors of a frame pair, without a ceres::Problem. Refine() and the
// local optimization in RANSAC use it.
//
// Levenberg-Marquardt on the normal equations that sampson_kernel.h sums. With 600 matches, a
// robust loss and a start 1 degree off it takes a tenth of the time of a Problem (rigel_benchmark
// --refine).
#ifndef RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_
#define RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/least_squares.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"

namespace rigel {

// The matches of weight above zero, group by group, so that the others take no time.
struct PackedMatches {
  // `weights`: grouped order.
  void Set(const GroupedMatches& matches, const std::vector<double>& weights);

  std::vector<double> x1, y1, x2, y2, general, weights;
  std::vector<RowArrays> groups;  // into the arrays above
};

// Keeps its memory from call to call: no heap allocation after the first.
class SmallEngine {
 public:
  // `matches` must outlive this object.
  explicit SmallEngine(const GroupedMatches& matches) : matches_(matches) {}
  SmallEngine(const SmallEngine&) = delete;
  SmallEngine& operator=(const SmallEngine&) = delete;

  // Minimizes over `parameters` (in: the start, out: the best found), parameterization.size() of
  // them. `weights` multiply the residuals (grouped order; 0 leaves a match out). The residuals of
  // `prior` at the motion are multiplied by `prior_unit`, pixels, and have no loss.
  LeastSquaresSummary Solve(const LeastSquaresOptions& options,
                            const MotionParameterization& parameterization,
                            const std::vector<double>& weights, const PriorResiduals& prior,
                            double prior_unit, double* parameters);

  // Minimizes over rotation and translation, for the matches with mask[k] != 0 (grouped order, one
  // entry for each match). False, and `pose` unchanged, if no step lowers the cost, the result is
  // not finite, or t = 0.
  bool Minimize(const LeastSquaresOptions& options, const std::vector<char>& mask,
                const PriorResiduals& prior, double prior_unit, Pose* pose);

  int num_iterations() const { return num_iterations_; }  // of the last call

 private:
  const GroupedMatches& matches_;
  std::vector<double> weights_;
  PackedMatches packed_;
  int num_iterations_ = 0;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_
