// Information, covariance and what of a motion can be observed.
//
// All in the perturbation R <- Exp(d) R, t <- t + e: rotation (radians) first, then translation
// (metres).
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
// ... and a fifth of the matches move along their epipolar lines by more than this many sigma of
// the image noise beyond what the rotation moves them. Without translation the matches still fit
// some direction, as well as their noise does, and the covariance does not know it.
inline constexpr double kParallaxSigmas = 5.0;
// Matchers are no better than this, pixels (times PixelUnit()), however well the matches fit; a fit
// to noise would seem to be.
inline constexpr double kMinMatchNoisePx = 0.1;
// Without intra-camera matches |t| has to exceed kParallaxSigmas of its own standard deviations.
// Rotation is observable if its largest standard deviation is at most this.
inline constexpr double kRotationObservableDeg = 10.0;

// J'J of the Sampson residuals of the matches, each times its weight (grouped order; 0 leaves it
// out), at `pose`, over the full six parameters; to be divided by the variance of the image noise.
Matrix6d SampsonInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                            const Pose& pose);

// Matches near an epipole. Their Sampson error is not linear within the noise: sigma |F_2x2| is the
// gradient's own error. An epipole that moves onto such a match makes its error vanish, whatever
// the motion is. So the error is multiplied by g^2 / (g^2 + kEpipoleSigmas^2 sigma^2 |F_2x2|^2), g
// the gradient: by one half at kEpipoleSigmas / sqrt(2) sigma from both epipoles, and it costs the
// few matches that are so near.
inline constexpr double kEpipoleSigmas = 20.0;

// That factor of each match (grouped order) at `pose`.
void EpipoleWeights(const GroupedMatches& matches, const Pose& pose, double noise_px,
                    std::vector<double>* weights);

// The same over the variance noise_px^2, without what looks like information and is not, because
// the Sampson error is not linear within the noise there: matches near an epipole count by their
// EpipoleWeights, and camera pairs whose baseline R s_i + t - s_j is so short that the other
// matches cannot tell it from zero do not count: the others are those that are longer or of more
// parallax.
Matrix6d ReliableInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                             const Pose& pose, double noise_px);

// B (B' information B)^-1 B' for the free directions B = `basis` (6 x k). False, and `covariance`
// left alone, if the information of the free directions is singular.
bool CovarianceOfBasis(const Matrix6d& information, const MotionBasis& basis, Matrix6d* covariance);

// The basis of the free rotation with t on the sphere |t| = const (5 columns), or t free (6).
MotionBasis FullBasis(const Pose& pose, bool scale_free);

// The basis where the prior is exact: the angle about the known direction, and t: free, without
// its length, or with planar motion in the plane.
MotionBasis PriorBasis(const Pose& pose, const Alignment& alignment, bool scale_free);

// Standard deviation of |t| over |t| when everything is free; infinity where it is not determined.
double RelativeScaleSigma(const Matrix6d& information, const Pose& pose);

// sqrt(trace) of the rotation block, radians; of the translation block projected off t over |t|,
// radians.
double RotationSigma(const Matrix6d& covariance);
double DirectionSigma(const Matrix6d& covariance, const Eigen::Vector3d& t);

// The motion that the matches determine worst, in words, by one standard deviation: "turn by 0.012
// deg about (0.1, 1.0, 0.0) with t by 0.0210 m along (1.0, 0.0, 0.1)". Rotation and t over |t|
// count alike. Axes are those of the body frame at time 2. Empty at t = 0.
std::string WeakestDirection(const Matrix6d& covariance, const Eigen::Vector3d& t);

// What 80 percent of the intra-camera matches of the mask stay below: the angle in pixels by which
// a match moves besides the rotation, times the share |t| / (|t| + |R s - s|) of it that the body's
// translation can have made and not the camera's arm. Infinity if there are none.
double ParallaxPercentilePx(const GroupedMatches& matches, const std::vector<char>& mask,
                            const Pose& pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_UNCERTAINTY_H_
