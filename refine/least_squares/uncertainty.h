// The information and the covariance of a motion, and the limits of what counts as observable.
//
// All matrices are 6 x 6 in the perturbation R <- Exp(d) R, t <- t + e: rotation (radians) first,
// then translation (metres).
#ifndef RIGEL_REFINE_LEAST_SQUARES_UNCERTAINTY_H_
#define RIGEL_REFINE_LEAST_SQUARES_UNCERTAINTY_H_

#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/alignment.h"
#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/motion_parameterization.h"

namespace rigel {

// Scale is observable if the standard deviation of |t| is at most this fraction of |t|.
inline constexpr double kScaleObservableRatio = 0.05;
// The direction of t is observable if its standard deviation is at most this ...
inline constexpr double kDirectionObservableDeg = 10.0;
// ... and a fifth of the intra-camera matches move by more than this many sigma of the image noise,
// without the part that the rotation moves them. Without translation the matches still fit some
// direction as well as their noise allows, and the covariance does not show this. If there are no
// intra-camera matches, |t| has to exceed this many of its own standard deviations.
inline constexpr double kParallaxSigmas = 5.0;
// Least noise of a matcher that is assumed here, pixels (times PixelUnit()). A fit to the noise has
// smaller residuals than the noise.
inline constexpr double kMinMatchNoisePx = 0.1;
// Rotation is observable if its standard deviation (RotationSigma) is at most this.
inline constexpr double kRotationObservableDeg = 10.0;

// J'J of the Sampson residuals (pixels) at `pose`, over all six parameters. Each residual is
// multiplied by its weight (grouped order; 0 leaves a match out). Divide by the variance of the
// image noise to get the information.
Matrix6d SampsonInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                            const Pose& pose);

// Weights of matches near an epipole. There the Sampson error is not linear within the noise: the
// gradient g itself has an error of sigma |F_2x2|. If the epipole moves onto such a match, its
// error vanishes for any motion. So the error is multiplied by g^2 / (g^2 + kEpipoleSigmas^2
// sigma^2 |F_2x2|^2). That is one half at a distance of kEpipoleSigmas / sqrt(2) sigma from both
// epipoles. Few matches are so near.
inline constexpr double kEpipoleSigmas = 20.0;

// That factor of each match (grouped order) at `pose`.
void EpipoleWeights(const GroupedMatches& matches, const Pose& pose, double noise_px,
                    std::vector<double>* weights);

// The covariance B (B' information B)^-1 B' for the free directions B = `basis` (6 x k). False, and
// `covariance` unchanged, if the information of the free directions is singular.
bool CovarianceOfBasis(const Matrix6d& information, const MotionBasis& basis, Matrix6d* covariance);

// The basis of the free rotation with t on the sphere |t| = const (5 columns), or t free (6).
MotionBasis FullBasis(const Pose& pose, bool scale_free);

// The basis if the prior is exact: the angle about the known direction, and t. With planar motion t
// is in the plane. Without `scale_free` its length is held.
MotionBasis PriorBasis(const Pose& pose, const Alignment& alignment, bool scale_free);

// Standard deviation of |t| over |t| if all parameters are free. Infinity if it is not determined.
double RelativeScaleSigma(const Matrix6d& information, const Pose& pose);

// RotationSigma: sqrt(trace) of the rotation block, radians. DirectionSigma: sqrt(trace) of the
// translation block projected perpendicular to t, over |t|, radians.
double RotationSigma(const Matrix6d& covariance);
double DirectionSigma(const Matrix6d& covariance, const Eigen::Vector3d& t);

// The motion that the matches determine worst, in words, by one standard deviation: "turn by 0.012
// deg about (0.1, 1.0, 0.0) with t by 0.0210 m along (1.0, 0.0, 0.1)". Rotation and t over |t|
// count alike. Axes are those of the body frame at time 2. Empty at t = 0.
std::string WeakestDirection(const Matrix6d& covariance, const Eigen::Vector3d& t);

// The 80th percentile of the parallax of the intra-camera matches of the mask, pixels: the angle by
// which a match moves without the part of the rotation. It is multiplied by |t| / (|t| + |R s -
// s|), the share that can come from the body's translation and not from the camera's arm R s - s.
// Infinity if there are no such matches.
double ParallaxPercentilePx(const GroupedMatches& matches, const std::vector<char>& mask,
                            const Pose& pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_UNCERTAINTY_H_
