// Least squares on the residuals of a frame pair as a ceres::Problem: every residual and form of
// Refine(), bundle adjustment among them. The small engine does the common ones in a fifth of the
// time.
#ifndef RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_
#define RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_

#include <functional>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/core/stop.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"
#include "rigel/refine/least_squares/small_engine.h"
#include "rigel/refine/refine.h"

namespace rigel {

// Minimizes over `parameters` (in: the start, out: the best found), parameterization.size() of
// them. Of `options` the form (bundle or not), the residual, the loss and the number of iterations
// count. `weights` multiply the residuals (grouped order; 0 leaves a match out), `noise_px` is the
// unit of the loss's scale and of the residuals of `prior`; the points of a bundle adjustment start
// where the matches meet under `start`. `stop` is asked while the problem is built and after each
// iteration; `progress` (null: not) is called after each, with its number, from 0, and the cost.
LeastSquaresSummary SolveWithCeres(const RefineOptions& options, const GroupedMatches& matches,
                                   const MotionParameterization& parameterization,
                                   const std::vector<double>& weights, const PriorResiduals& prior,
                                   double noise_px, const Pose& start, Stop* stop,
                                   const std::function<void(int, double)>* progress,
                                   double* parameters);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_CERES_ENGINE_H_
