#include "rigel/refine/search/doubt.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "rigel/core/alignment.h"
#include "rigel/core/angles.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/minimal/catalogue.h"

namespace rigel {

Doubt FindDoubt(const MotionPrior& prior, const SolverInfo& solver, const Pose& pose,
                const GroupedMatches& matches, double threshold_px, double noise_px) {
  constexpr double kNoBound = std::numeric_limits<double>::infinity();
  Doubt doubt;
  doubt.num_matches = matches.size();
  matches.Score(pose, threshold_px, kNoBound, &doubt.num_inliers);
  matches.Score(pose, 2.0 * threshold_px, kNoBound, &doubt.num_loose_inliers);
  doubt.few_inliers = doubt.num_inliers < kDoubtfulInlierRatio * doubt.num_matches;
  doubt.loose_residuals = doubt.num_loose_inliers > kDoubtfulGrowth * doubt.num_inliers;
  doubt.noise_px = noise_px;
  doubt.large_noise = noise_px > kDoubtfulNoisePx * PixelUnit(matches.rig());
  Alignment alignment;
  std::string error;
  if (solver.prior != PriorKind::kNone && MakeAlignment(prior, solver.prior, &alignment, &error)) {
    const double angle = alignment.NearestAngle(pose.R);
    doubt.from_prior = RotationError(alignment.Rotation(std::cos(angle), std::sin(angle)), pose.R);
    doubt.leaves_prior = doubt.from_prior > DegToRad(kDoubtfulPriorDeg);
  }
  return doubt;
}

std::string Doubt::Reason() const {
  std::string reason;
  const auto add = [&reason](const char* format, auto... values) {
    char text[128];
    std::snprintf(text, sizeof(text), format, values...);
    reason += (reason.empty() ? "" : "; ") + std::string(text);
  };
  if (few_inliers) {
    add("only %d of %d matches agree with the motion", num_inliers, num_matches);
  }
  if (loose_residuals) {
    add("%d more agree at twice the threshold", num_loose_inliers - num_inliers);
  }
  if (large_noise) add("their noise is %.1f px", noise_px);
  if (leaves_prior) add("the motion turned %.1f deg away from the prior", RadToDeg(from_prior));
  return reason;
}

}  // namespace rigel
