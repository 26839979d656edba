#include "rigel/problems/cramer_rao.h"

#include <string>

#include "rigel/minimal/alignment.h"
#include "rigel/refine/prior_residuals.h"

namespace rigel {

std::optional<CramerRaoBound> ComputeCramerRaoBound(const RefineOptions& options,
                                                    const FramePair& pair) {
  std::string error;
  if (!pair.truth.has_value() || !pair.noise_px.has_value() || !pair.IsValid(&error)) {
    return std::nullopt;
  }
  const Pose& truth = *pair.truth;
  const GroupedMatches matches(pair.rig, pair.matches);
  std::vector<double> errors;
  matches.SquaredErrors(truth, &errors);
  std::vector<char> mask(errors.size());
  for (size_t k = 0; k < errors.size(); ++k) {
    mask[k] = errors[k] < options.threshold_px * options.threshold_px ? 1 : 0;
  }
  Matrix6d information =
      SampsonInformation(matches, mask, truth) / (*pair.noise_px * *pair.noise_px);
  if (options.use_prior) {
    const PriorResiduals prior(pair.prior, options.prior_kind, truth);
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian J;
    prior.Evaluate(truth, &r, &J);
    information += J.transpose() * J;
  }

  CramerRaoBound bound;
  bound.relative_scale = RelativeScaleSigma(information, truth);
  const bool scale_free = bound.relative_scale <= kScaleObservableRatio;
  MotionBasis basis = FullBasis(truth, scale_free);
  const bool prior_exact =
      options.form == RefineForm::kPrior || options.form == RefineForm::kPriorDepths;
  if (prior_exact) {
    // The angle about the known direction, and t: all of it, in the plane, or without its length.
    Alignment alignment;
    if (!MakeAlignment(pair.prior, options.prior_kind, &alignment, &error)) return std::nullopt;
    const bool planar = options.prior_kind == PriorKind::kPlanar;
    const Eigen::Vector3d axis = alignment.AxisInFrame2();
    const Eigen::Vector3d direction = truth.t.normalized();
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3> t_basis;
    if (planar) {
      if (scale_free) {
        t_basis = TangentBasis(axis);
      } else {
        t_basis = axis.cross(direction);
      }
    } else if (scale_free) {
      t_basis = Eigen::Matrix3d::Identity();
    } else {
      t_basis = TangentBasis(direction);
    }
    basis.setZero(6, 1 + t_basis.cols());
    basis.block<3, 1>(0, 0) = axis;
    basis.block(3, 1, 3, t_basis.cols()) = t_basis;
  }
  if (!CovarianceOfBasis(information, basis, &bound.covariance)) return std::nullopt;
  bound.rotation = RotationSigma(bound.covariance);
  bound.direction = DirectionSigma(bound.covariance, truth.t);
  return bound;
}

}  // namespace rigel
