// The information that the inliers of a fit give on the motion, and the covariance from it.
#ifndef RIGEL_REFINE_FIT_INFORMATION_H_
#define RIGEL_REFINE_FIT_INFORMATION_H_

#include <vector>

#include "rigel/core/eigen_types.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/least_squares.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/search/noise_model.h"
#include "rigel/refine/search/shared_pixels.h"

namespace rigel {

// A fit at its minimum. Vectors are in grouped order.
struct FittedInliers {
  LossKind loss = LossKind::kNone;
  double loss_scale_sigmas = 1.0;
  bool noise_is_given = false;
  bool is_minimum = true;  // of the Sampson errors; else no curvature is measured
  int num_parameters = 6;
  std::vector<double> factors;  // of the residuals besides 1 / sigma; 0: no inlier
  std::vector<SharedPixel> shared;
};

// Sums over the inliers, for the perturbation (d, e) of R <- Exp(d) R, t <- t + e. Their cost is
// sum rho(z^2) / 2 with z = r / sigma, and its gradient g = sum J psi(z) / sigma, psi = rho' z.
struct FitInformation {
  Matrix6d curvature = Matrix6d::Zero();  // dg, measured
  // Var g: sum v J'J / sigma^2, v the mean of psi^2; more where matches share pixels.
  Matrix6d scatter = Matrix6d::Zero();
  Matrix6d observed = Matrix6d::Zero();  // sum J'J / sigma^2
  // The part of it that the noise of the pixels makes (noise_information.h).
  Matrix6d noise = Matrix6d::Zero();
  std::vector<double> psi2_of;  // v of each camera pair
  // The derivatives of g by the errors of the calibration, kCameraErrors for each camera
  // (fundamental_derivatives.h), and what those that are stated add to Var g: X E X' for a
  // diagonal E. Without columns if no error is stated.
  Eigen::Matrix<double, 6, Eigen::Dynamic> by_calibration;
  Matrix6d calibration = Matrix6d::Zero();
};

// v is measured for each camera pair, and for few matches taken from all; with a given noise it
// is 1, and the curvature is observed - noise: the loss then costs nothing.
FitInformation InformationOfFit(const FittedInliers& fit, const GroupedMatches& matches,
                                const MatchErrors& errors, const NoiseModel& noise,
                                const Pose& pose);

// How the cost rises along the motions that the matches determine worst, over how it would with the
// curvature S. Far below 1 the minimum is a narrow one that noise made in a wider valley.
struct CostRise {
  double least = 1.0;                    // of some steps of three standard deviations
  Matrix6d widening = Matrix6d::Zero();  // what the covariance lacks
};
// With |t| as it is.
CostRise RiseOfCost(const FittedInliers& fit, const GroupedMatches& matches,
                    const NoiseModel& noise, const Pose& pose, const Matrix6d& S);
// Recorded drives have 0.9 and more, that wall 0.07 to 0.98.
inline constexpr double kMinRise = 0.7;

// S^-1 within the free directions B = `basis`, S = curvature + P, where P = `prior` is the
// information of the prior. S is taken as `min_share` to all of the observed information in any
// direction: near an epipole errors are so curved that it may be more. False if that is singular.
bool InverseCurvature(const FitInformation& information, const Matrix6d& prior,
                      const MotionBasis& basis, double min_share, Matrix6d* inverse);
inline constexpr double kMinShare = 0.25;

// The covariances that follow from S^-1: of the noise, S^-1 (V + P) S^-1, and of the calibration,
// S^-1 X E X' S^-1. The latter is the same error in all pairs of one rig.
struct FitCovariance {
  Matrix6d noise;
  Matrix6d calibration;
};
FitCovariance CovarianceOfFit(const FitInformation& information, const Matrix6d& prior,
                              const Matrix6d& inverse);

// The least part of the observed information, in any free direction, that is not due to the noise
// of the pixels. Below kMinTrueInformation the linear theory does not hold: stereo before a wall at
// 8 m then has a NEES of three times its degrees of freedom and more.
double TrueInformation(const FitInformation& information, const Matrix6d& prior,
                       const MotionBasis& basis);
inline constexpr double kMinTrueInformation = 0.75;

}  // namespace rigel

#endif  // RIGEL_REFINE_FIT_INFORMATION_H_
