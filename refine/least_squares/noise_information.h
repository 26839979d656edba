// What the noise of the pixels adds to the information of a motion.
//
// J, the derivative of a Sampson error r by the motion, depends on the pixels p. With noise of
// sigma on each coordinate of p, J'J / sigma^2 is in the mean larger than at the exact pixels: by
// D = sum (dJ/dp)(dJ/dp)', which does not depend on sigma. In scenes of small depth range D is the
// larger part. Let H be J'J / sigma^2 at the measured pixels. The curvature of the cost is H - D in
// the mean, and the variance of its gradient is H. So the covariance of the motion is
// (H - D)^-1 H (H - D)^-1.
//
// Derivatives by the motion are those of the perturbation R <- Exp(d) R, t <- t + e: d (radians),
// then e (metres).
#ifndef RIGEL_REFINE_LEAST_SQUARES_NOISE_INFORMATION_H_
#define RIGEL_REFINE_LEAST_SQUARES_NOISE_INFORMATION_H_

#include <vector>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/epipolar_residuals.h"

namespace rigel {

// The derivatives of one match's Sampson error. Pixel coordinates in the order u1, v1, u2, v2.
struct SampsonRow {
  double residual;                             // r, pixels
  Vector6d by_motion;                          // J, pixels
  UnalignedMatrix<4> gradient;                 // dr/dp of an exact match: of unit length
  UnalignedMatrix<6, 4> by_motion_and_pixels;  // dJ/dp
};

// Of a match with these points, in the camera pair of `linear` (LinearizeGroups() of kSampson by
// all six parameters). How their J changes with the pixels is left out: for pinholes it does not,
// and for others it turns dr/dp by less than the pixel noise over the focal length. False at an
// epipole, where the error is zero by definition and has no derivatives.
bool DifferentiateSampson(const GroupLinearization& linear, const RowPoint& point1,
                          const RowPoint& point2, SampsonRow* row);

// The same without dJ/dp, which takes most of the time.
bool DifferentiateSampsonOnce(const GroupLinearization& linear, const RowPoint& point1,
                              const RowPoint& point2, SampsonRow* row);

// r and its derivative by the entries of F, column by column. `linear` needs F and rounding2 only.
bool DifferentiateByFundamental(const GroupLinearization& linear, const RowPoint& point1,
                                const RowPoint& point2, double* residual, UnalignedMatrix<9>* by_F);

// D = sum w^2 (dJ/dp)(dJ/dp)' over the matches at `pose`; `weights` (grouped order, 0 leaves a
// match out) are those of SampsonInformation(), which is D's H once it is divided by the variance
// of the noise. A match with a noise of its own adds the same to D whatever that noise is: leave
// 1 / sigma out of the weights.
Matrix6d NoiseInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                          const Pose& pose);

// The same of the matches of one camera pair, from at most `max_matches` of those that have a
// weight (`weights`: of the group's matches), evenly spaced, in proportion.
Matrix6d NoiseInformation(const GroupLinearization& linear, const GroupedMatches& matches,
                          const MatchGroup& group, const double* weights, int max_matches);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_NOISE_INFORMATION_H_
