// Names of the enumerations of refine.h, and the reports of a RefineSummary.
#include <cmath>
#include <cstdio>

#include "rigel/core/angles.h"
#include "rigel/core/enum_names.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/refine.h"

namespace rigel {
namespace {

constexpr EnumName<RefineForm> kFormNames[] = {{RefineForm::kFull, "full"},
                                               {RefineForm::kPrior, "prior"},
                                               {RefineForm::kDepths, "depths"},
                                               {RefineForm::kPriorDepths, "prior-depths"},
                                               {RefineForm::kBundle, "bundle"}};

constexpr EnumName<ResidualKind> kResidualNames[] = {{ResidualKind::kSampson, "sampson"},
                                                     {ResidualKind::kAngular, "angular"},
                                                     {ResidualKind::kAlgebraic, "algebraic"}};

constexpr EnumName<Termination> kTerminationNames[] = {
    {Termination::kNotRun, "not run"},
    {Termination::kConverged, "converged"},
    {Termination::kIterationLimit, "iteration limit"},
    {Termination::kDegenerate, "degenerate"},
    {Termination::kFailure, "failure"},
    {Termination::kStopped, "stopped"}};

}  // namespace

const char* RefineFormName(RefineForm form) { return NameOf(kFormNames, form); }
bool ParseRefineForm(std::string_view name, RefineForm* form) {
  return FindValue(kFormNames, name, form);
}
const char* ResidualName(ResidualKind kind) { return NameOf(kResidualNames, kind); }
bool ParseResidual(std::string_view name, ResidualKind* kind) {
  return FindValue(kResidualNames, name, kind);
}
const char* TerminationName(Termination termination) {
  return NameOf(kTerminationNames, termination);
}

std::string RefineSummary::BriefReport() const {
  char text[256];
  std::snprintf(
      text, sizeof(text),
      "%s: %d inliers, %d rounds, %d iterations, cost %.6g -> %.6g, median residual %.3f px",
      message.c_str(), num_inliers, num_rounds, num_iterations, initial_cost, final_cost,
      median_residual_px);
  return text;
}

const CameraPairFit* RefineSummary::OnlyCameraPair() const {
  const CameraPairFit* only = nullptr;
  for (const CameraPairFit& fit : camera_pairs) {
    if (fit.inliers == 0) continue;
    if (only != nullptr) return nullptr;
    only = &fit;
  }
  return only != nullptr && only->camera1 != only->camera2 ? only : nullptr;
}

namespace {

std::string WhyNoRotation(const RefineSummary& summary) {
  char text[256];
  const double sigma_deg = RadToDeg(summary.rotation_sigma);
  if (!summary.exceeds_chance) {
    std::snprintf(text, sizeof(text),
                  "%d matches agree: too few, or no more than chance allows, to determine a motion",
                  summary.num_inliers);
  } else if (summary.covariance && sigma_deg <= kRotationObservableDeg) {
    // Of points on a line the linear theory states a sigma that means nothing.
    return "the motion is not observable: " + summary.covariance_note;
  } else if (summary.covariance && sigma_deg < 180) {
    std::snprintf(text, sizeof(text), "the standard deviation of the rotation is %.1f deg",
                  sigma_deg);
  } else {
    std::snprintf(text, sizeof(text), "the %d matches that agree do not determine the rotation",
                  summary.num_inliers);
  }
  return text;
}

}  // namespace

std::string RefineSummary::ObservabilityReport() const {
  if (termination == Termination::kStopped) {
    return "it is not known what is observable: the refinement was not done (" + message + ")";
  }
  char text[256];
  if (other_motion.has_value() && !translation_observable) {
    std::snprintf(text, sizeof(text), "another motion fits as well, which turns by %.1f deg",
                  RadToDeg(LogSO3(other_motion->R).norm()));
    return text;
  }
  if (!rotation_observable) return WhyNoRotation(*this);
  if (stands) {
    std::snprintf(text, sizeof(text),
                  "|t| is consistent with zero: the rotation alone explains both components of the "
                  "pixels, noise %.3g px",
                  noise_px);
    return text;
  }
  if (!translation_observable) {
    // Relative standard deviation of |t| from which on |t| counts as not determined at all.
    constexpr double kNothingKnown = 10.0;
    const CameraPairFit* only = OnlyCameraPair();
    if (only != nullptr) {
      std::snprintf(
          text, sizeof(text),
          "|t| is not determined by one camera pair: %d-%d gives the direction of its own "
          "baseline, (%.3f, %.3f, %.3f) from camera %d at time 2 to camera %d at time 1, in the "
          "body "
          "frame of time 2",
          only->camera1, only->camera2, only->baseline[0], only->baseline[1], only->baseline[2],
          only->camera2, only->camera1);
    } else if (parallax_px >= 0 && !std::isfinite(parallax_px) &&
               !(relative_scale_sigma < kNothingKnown)) {
      std::snprintf(text, sizeof(text), "|t| is not determined by the camera pairs that agree");
    } else if (parallax_px >= 0 && !std::isfinite(parallax_px)) {
      std::snprintf(text, sizeof(text),
                    "|t| is consistent with zero: its standard deviation is %.0f percent of it",
                    100 * relative_scale_sigma);
    } else if (parallax_px >= 0 && !(parallax_px > parallax_limit_px)) {
      std::snprintf(
          text, sizeof(text),
          "|t| is consistent with zero: 80%% of the matches move < %.3g px, noise %.3g px",
          parallax_px, noise_px);
    } else if (direction_sigma >= 0) {
      std::snprintf(text, sizeof(text),
                    "the standard deviation of the translation direction is %.1f deg",
                    RadToDeg(direction_sigma));
    } else {
      std::snprintf(text, sizeof(text), "the matches do not determine it");
    }
    return text;
  }
  if (!scale_observable) {
    return "direction of translation observable, scale not (standard deviation of |t| above " +
           std::to_string(static_cast<int>(100 * kScaleObservableRatio)) + " percent)";
  }
  std::snprintf(text, sizeof(text), "all observable, standard deviation of |t| %.2f percent",
                100 * relative_scale_sigma);
  return weakest_direction.empty() ? std::string(text) : text + ("; weakest: " + weakest_direction);
}

}  // namespace rigel
