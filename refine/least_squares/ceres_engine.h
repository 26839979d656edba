// Least squares on the residuals of a frame pair by a ceres::Problem: for every residual and form
// of Refine(), including bundle adjustment. The small engine takes a fifth of the time for the
// common ones (rigel_benchmark --refine).
#ifndef RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_
#define RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/least_squares.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"

namespace rigel {

// Minimizes over `parameters` (in: the start, out: the best found), parameterization.size() of
// them. `weights` multiply the residuals (grouped order; 0 leaves a match out). The residuals of
// `prior` are multiplied by `prior_unit`, pixels. They have no loss; nor have algebraic residuals.
// The points of a bundle adjustment start where the rays of the matches meet under `start`.
// options.stop is also asked while the problem is built.
LeastSquaresSummary SolveWithCeres(const LeastSquaresOptions& options,
                                   const GroupedMatches& matches,
                                   const MotionParameterization& parameterization,
                                   const std::vector<double>& weights, const PriorResiduals& prior,
                                   double prior_unit, const Pose& start, double* parameters);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_
