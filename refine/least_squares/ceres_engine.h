// Least squares on the residuals of a frame pair as a ceres::Problem: every residual and form of
// Refine(), bundle adjustment among them. The small engine does the common ones in a fifth of the
// time.
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
// `prior` are multiplied by `prior_unit`, pixels, and take no loss; nor do algebraic ones. The
// points of a bundle adjustment start where the matches meet under `start`. options.stop is asked
// while the problem is built, too.
LeastSquaresSummary SolveWithCeres(const LeastSquaresOptions& options,
                                   const GroupedMatches& matches,
                                   const MotionParameterization& parameterization,
                                   const std::vector<double>& weights, const PriorResiduals& prior,
                                   double prior_unit, const Pose& start, double* parameters);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_
