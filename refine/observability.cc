#include "rigel/refine/observability.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include <Eigen/Eigenvalues>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/core/rig_centre.h"
#include "rigel/refine/fit_information.h"
#include "rigel/refine/least_squares/fundamental_derivatives.h"
#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {
namespace {

// Standard deviation of |b| over |b| by the matches alone, all else free. A direction in which no
// information is left has this share of the observed one, which makes it not observable.
double LengthSigma(const FitInformation& information, const Pose& pose) {
  constexpr double kNothing = 1e-4;
  const double norm = pose.t.norm();
  Matrix6d inverse;
  if (!(norm > 0) ||
      !InverseCurvature(information, Matrix6d::Zero(), FullBasis(pose, true), kNothing, &inverse)) {
    return std::numeric_limits<double>::infinity();
  }
  const FitCovariance parts = CovarianceOfFit(information, Matrix6d::Zero(), inverse);
  const Matrix6d covariance = parts.noise + parts.calibration;
  const Eigen::Vector3d direction = pose.t / norm;
  return std::sqrt(direction.dot(covariance.block<3, 3>(3, 3) * direction)) / norm;
}

// Clears the factors of camera pairs whose baselines R s_i + t - s_j are far shorter than the
// longest. Without parallax, noise decides their directions, and they seem to determine the
// rotation.
void LeaveOutShortBaselines(const GroupedMatches& matches, const Pose& pose,
                            std::vector<double>* factors) {
  constexpr double kShort = 0.1;
  std::vector<double> lengths;
  for (const MatchGroup& group : matches.groups()) {
    const std::vector<RigCamera>& cameras = matches.rig().cameras;
    lengths.push_back(
        (pose.R * cameras[group.camera1].s + pose.t - cameras[group.camera2].s).norm());
  }
  const double longest = *std::max_element(lengths.begin(), lengths.end());
  for (size_t g = 0; g < lengths.size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    if (lengths[g] < kShort * longest) {
      std::fill_n(factors->begin() + group.begin, group.size, 0.0);
    }
  }
}

// What the errors of the calibration do to the motion of the body: for each camera the derivatives
// of (d, e) by its kCameraErrors.
void SetCalibration(const FitInformation& information, const Matrix6d& inverse,
                    const Matrix6d& to_body, RefineSummary* summary) {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> gain =
      -to_body * inverse * information.by_calibration;
  for (long k = 0; k < gain.cols(); k += kCameraErrors) {
    summary->calibration_gain.emplace_back(gain.middleCols<kCameraErrors>(k));
  }
  summary->calibration_covariance =
      Matrix6d(to_body * inverse * information.calibration * inverse * to_body.transpose());
}

void SetDeviations(const Matrix6d& of_rig, const Pose& body, RefineSummary* summary) {
  const Matrix6d to_body = BodyFromPointJacobian(body.R, summary->rig_center);
  const Eigen::Vector3d b = MotionOfPoint(body, summary->rig_center).t;
  summary->rig_covariance = of_rig;
  summary->covariance = Matrix6d(to_body * of_rig * to_body.transpose());
  summary->rotation_sigma = RotationSigma(of_rig);
  summary->rig_direction_sigma = DirectionSigma(of_rig, b);
  summary->length_sigma = std::sqrt(b.dot(of_rig.block<3, 3>(3, 3) * b)) / b.squaredNorm();
  summary->direction_sigma = DirectionSigma(*summary->covariance, body.t);
  summary->weakest_direction = WeakestDirection(*summary->covariance, body.t);
}

// The parallax that the noise could make, pixels: a rig that moves exceeds it.
double ParallaxLimitPx(const RefineOptions& options, const GroupedMatches& matches,
                       const Fit& fit) {
  // A given noise level is trusted. An estimated one may be too small, because of a fit to the
  // noise.
  const double noise_px =
      options.noise_px.has_value()
          ? fit.noise.sigma_px
          : std::max(fit.noise.sigma_px, kMinMatchNoisePx * PixelUnit(matches.rig()));
  return kParallaxSigmas * noise_px;
}

// What another motion that fits as well leaves of the flags.
void HeedOtherMotion(const Pose& body, RefineSummary* summary) {
  if (!summary->other_motion.has_value()) return;
  constexpr double kSigmas = 3.0;  // closer ones are the same motion
  const Pose& other = *summary->other_motion;
  const Eigen::Vector3d b = MotionOfPoint(body, summary->rig_center).t;
  const Eigen::Vector3d other_b = MotionOfPoint(other, summary->rig_center).t;
  const bool turns = RotationError(body.R, other.R) > kSigmas * summary->rotation_sigma;
  const bool leads_elsewhere =
      TranslationDirectionError(b, other_b) > kSigmas * summary->rig_direction_sigma;
  const bool is_longer =
      std::abs(std::log(other_b.norm() / b.norm())) > kSigmas * summary->relative_scale_sigma;
  if (turns) summary->rotation_observable = false;
  if (turns || leads_elsewhere) {
    summary->rig_translation_observable = summary->translation_observable = false;
  }
  if (turns || leads_elsewhere || is_longer) summary->scale_observable = false;
  if (!turns && !leads_elsewhere && !is_longer) summary->other_motion.reset();
}

void SetFlags(RefineSummary* summary, bool at_limit) {
  if (!summary->covariance || !summary->exceeds_chance) return;
  summary->rotation_observable = RadToDeg(summary->rotation_sigma) <= kRotationObservableDeg;
  const bool moves = std::isfinite(summary->parallax_px)
                         ? summary->parallax_px > summary->parallax_limit_px
                         : summary->relative_scale_sigma * kParallaxSigmas < 1.0;
  summary->rig_translation_observable =
      moves && RadToDeg(summary->rig_direction_sigma) <= kDirectionObservableDeg;
  summary->translation_observable = summary->rig_translation_observable && !at_limit &&
                                    RadToDeg(summary->direction_sigma) <= kDirectionObservableDeg;
  summary->scale_observable =
      summary->translation_observable && summary->relative_scale_sigma <= kScaleObservableRatio;
}

}  // namespace

void SetParallax(const RefineOptions& options, const GroupedMatches& matches, const Fit& fit,
                 RefineSummary* summary) {
  summary->parallax_px = ParallaxPercentilePx(matches, fit.inliers, fit.pose);
  summary->parallax_limit_px = ParallaxLimitPx(options, matches, fit);
}

bool OnALine(const GroupedMatches& matches, const Fit& fit) {
  // Times the noise: the least spread of points that are on no line. A cell of 0.1 m at 10 m has 2.
  constexpr double kLeastSpread = 5.0;
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    const RayArrays rays = matches.Directions(group);
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    int count = 0;
    for (int k = 0; k < group.size; ++k) {
      if (!fit.inliers[group.begin + k]) continue;
      const Eigen::Vector3d x(rays.x1[k], rays.y1[k], rays.z1[k]);
      moment += x * x.transpose();
      ++count;
    }
    const double noise = fit.noise.sigma_of[g] * matches.RadiansPerPixel(group);
    const double spread2 =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment, Eigen::EigenvaluesOnly)
            .eigenvalues()(0);
    if (spread2 > kLeastSpread * kLeastSpread * noise * noise * count) return false;
  }
  return true;
}

void DescribeStanding(const GroupedMatches& matches, const Eigen::Vector3d& point,
                      const StandingMotion& motion, RefineSummary* summary) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  summary->stands = true;
  summary->rig_center = point + RigCentre(matches.rig());
  const Matrix6d to_rig =
      BodyFromPointJacobian(motion.pose.R, Eigen::Vector3d(-RigCentre(matches.rig())));
  SetDeviations(to_rig * motion.covariance * to_rig.transpose(), MotionOfBody(motion.pose, point),
                summary);
  summary->relative_scale_sigma = summary->length_sigma = kInfinity;
  summary->covariance_valid = true;
  summary->rotation_observable =
      summary->exceeds_chance && RadToDeg(summary->rotation_sigma) <= kRotationObservableDeg;
}

void DescribeObservability(const RefineOptions& options, const GroupedMatches& matches,
                           const Eigen::Vector3d& point, const Fitter& fitter, const Fit& fit,
                           RefineSummary* summary) {
  FittedInliers inliers;
  inliers.loss = options.loss;
  inliers.loss_scale_sigmas = options.loss_scale_sigmas;
  inliers.noise_is_given = options.noise_px.has_value();
  inliers.is_minimum =
      options.form != RefineForm::kBundle && options.residual == ResidualKind::kSampson;
  const MotionBasis basis = fitter.FreeDirections(fit.pose);
  inliers.num_parameters = static_cast<int>(basis.cols());
  inliers.factors = fit.factors;
  inliers.shared = SharedWithin(fitter.shared(), fit.inliers);
  summary->length_held = options.hold_distance;
  const Pose body = MotionOfBody(fit.pose, point);
  if (!std::isfinite(summary->parallax_px) ||
      !(summary->parallax_px > summary->parallax_limit_px)) {
    LeaveOutShortBaselines(matches, fit.pose, &inliers.factors);
  }
  const FitInformation information =
      InformationOfFit(inliers, matches, fit.errors, fit.noise, fit.pose);

  summary->rig_center = point + RigCentre(matches.rig());
  const Eigen::Vector3d b = MotionOfPoint(body, summary->rig_center).t;
  summary->rig_direction = b.norm() > 0 ? Eigen::Vector3d(b.normalized()) : b;
  summary->relative_scale_sigma = LengthSigma(information, fit.pose);
  const Matrix6d prior = fitter.PriorInformation(fit.pose);
  Matrix6d inverse;
  if (InverseCurvature(information, prior, basis, kMinShare, &inverse)) {
    // The fitted point is the rig's centre, or the body's origin if |t| is held.
    const Matrix6d to_rig =
        BodyFromPointJacobian(fit.pose.R, Eigen::Vector3d(-RigCentre(matches.rig())));
    FitCovariance parts = CovarianceOfFit(information, prior, inverse);
    CostRise rise;
    if (inliers.is_minimum && basis.cols() >= 5) {
      rise = RiseOfCost(inliers, matches, fit.noise, fit.pose, information.curvature);
    }
    parts.noise += rise.widening;
    SetDeviations(to_rig * (parts.noise + parts.calibration) * to_rig.transpose(), body, summary);
    if (information.by_calibration.cols() > 0) {
      SetCalibration(information, inverse,
                     BodyFromPointJacobian(body.R, summary->rig_center) * to_rig, summary);
    }
    const double share = TrueInformation(information, prior, basis);
    summary->covariance_valid = share >= kMinTrueInformation && rise.least >= kMinRise;
    if (share >= kMinTrueInformation && !summary->covariance_valid) {
      summary->covariance_note =
          "the minimum is one of several that the noise makes in a wider valley of the cost";
    } else if (!summary->covariance_valid) {
      char text[160];
      std::snprintf(text, sizeof(text),
                    "only %.0f percent of the information in one direction of the motion are not "
                    "due to the noise of the pixels",
                    100.0 * std::max(share, 0.0));
      summary->covariance_note = text;
    }
  } else {
    summary->covariance_note = "the matches do not determine the motion";
  }
  constexpr double kNearLimit = 0.99;
  SetFlags(summary, b.norm() > kNearLimit * fitter.max_length());
  HeedOtherMotion(body, summary);
  if (OnALine(matches, fit)) {
    summary->rotation_observable = summary->translation_observable = false;
    summary->rig_translation_observable = summary->scale_observable = false;
    summary->covariance_valid = false;
    summary->covariance_note = "the points of each camera pair lie on a line or in one place";
  }
}

}  // namespace rigel
