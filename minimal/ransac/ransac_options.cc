#include "rigel/minimal/ransac/ransac_options.h"

#include <cmath>

namespace rigel {

bool RansacOptions::IsValid(std::string* error) const {
  if (!(threshold_px >= 0) || !std::isfinite(threshold_px)) {
    *error = "threshold_px must be positive and finite, or 0 for auto";
    return false;
  }
  // Beyond these its square loses precision or overflows.
  if (threshold_px != kAutoThresholdPx &&
      (threshold_px < kMinThresholdPx || threshold_px > kMaxThresholdPx)) {
    *error = "threshold_px must lie in 1e-12 to 1e12";
    return false;
  }
  if (score != ScoreKind::kMsac && score != ScoreKind::kInlierCount) {
    *error = "score is no ScoreKind";
    return false;
  }
  if (!(confidence > 0 && confidence < 1)) {
    *error = "confidence must lie in (0, 1)";
    return false;
  }
  if (max_iterations < 1) {
    *error = "max_iterations must be at least 1";
    return false;
  }
  if (min_iterations < 0) {
    *error = "min_iterations must not be negative";
    return false;
  }
  if (num_finalists < 0 || num_finalists > kMaxFinalists) {
    *error = "num_finalists must lie in 0.." + std::to_string(kMaxFinalists);
    return false;
  }
  if (max_scored < 1) {
    *error = "max_scored must be at least 1";
    return false;
  }
  if (!(max_work_us > 0)) {
    *error = "max_work_us must be positive";
    return false;
  }
  return true;
}

}  // namespace rigel
