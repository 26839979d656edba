#include "rigel/problems/cramer_rao.h"

#include <algorithm>
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
  const double gate = std::max(options.threshold_px, kGateSigmas * *pair.noise_px);
  for (size_t k = 0; k < errors.size(); ++k) {
    mask[k] = errors[k] < gate * gate ? 1 : 0;
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
  const bool scale_free =
      options.scale == ScaleMode::kFree ||
      (options.scale == ScaleMode::kAuto && bound.relative_scale <= kScaleObservableRatio);
  MotionBasis basis = FullBasis(truth, scale_free);
  const bool prior_exact =
      options.form == RefineForm::kPrior || options.form == RefineForm::kPriorDepths;
  if (prior_exact) {
    Alignment alignment;
    if (!MakeAlignment(pair.prior, options.prior_kind, &alignment, &error)) return std::nullopt;
    basis = PriorBasis(truth, alignment, scale_free);
  }
  if (!CovarianceOfBasis(information, basis, &bound.covariance)) return std::nullopt;
  bound.rotation = RotationSigma(bound.covariance);
  bound.direction = DirectionSigma(bound.covariance, truth.t);
  return bound;
}

}  // namespace rigel
