// The normal equations of the Sampson errors of a frame pair, by the motion.
#ifndef RIGEL_REFINE_LEAST_SQUARES_NORMAL_EQUATIONS_H_
#define RIGEL_REFINE_LEAST_SQUARES_NORMAL_EQUATIONS_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/sampson_kernel.h"

namespace rigel {

// `rounding2` of SumSampson() for a matrix F.
double Rounding2(const Eigen::Matrix3d& F);

// By the perturbation R <- Exp(w) R, t <- t + e: w (radians), then e (metres).
struct MotionNormalEquations {
  double cost = 0.0;
  Vector6d gradient = Vector6d::Zero();
  Matrix6d curvature = Matrix6d::Zero();
};

// Adds the result of SumSampson() at `pose` for `rows` and their weights: all matches of the
// group or some of them. Which parts are asked for does not change the bits of the cost.
void AddNormalEquations(const SampsonKernelOptions& options, const GroupedMatches& matches,
                        const MatchGroup& group, const RowArrays& rows, const double* weights,
                        const Pose& pose, SampsonParts parts, MotionNormalEquations* sum);

// Adds the equations of errors over their noise, sigma pixels, under a loss whose scale is so many
// sigma: of all matches of the group with their weights.
void AddRobustEquations(LossKind loss, double loss_scale_sigmas, double sigma,
                        const GroupedMatches& matches, const MatchGroup& group,
                        const double* weights, const Pose& pose, SampsonParts parts,
                        MotionNormalEquations* sum);

// w^2 J C J' of each match of the group. J is the derivative of its Sampson error (pixels) by that
// perturbation, w its weight, C = `covariance`. If C is the covariance of the motion from these
// matches with unit noise, this is the leverage of the match: 0 to 1. The sum over all matches is
// then the number of parameters.
void Leverages(const GroupedMatches& matches, const MatchGroup& group, const Pose& pose,
               const double* weights, const Matrix6d& covariance, double* leverages);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_NORMAL_EQUATIONS_H_
