// The options of RANSAC: score, numbers of iterations and what else ends the loop.
#ifndef RIGEL_MINIMAL_RANSAC_RANSAC_OPTIONS_H_
#define RIGEL_MINIMAL_RANSAC_RANSAC_OPTIONS_H_

#include <cstdint>
#include <string>

#include "rigel/core/pixel_unit.h"

namespace rigel {

// Hypotheses: the room that is kept for them. Each takes the time of a local optimization.
inline constexpr int kMaxFinalists = 16;

enum class ScoreKind {
  kMsac,  // sum min(r^2, threshold^2), Torr and Zisserman 2000
  // Number of matches that are no inliers, as of Fischler and Bolles 1981: of hypotheses with as
  // many inliers the first wins. For comparisons with published figures; it never stops early.
  kInlierCount,
};

struct RansacOptions {
  // In 1e-12 to 1e12; 3 sigma keeps the estimate efficient. kAutoThresholdPx: 1.5, or 1/300 of the
  // shortest focal length where that is less; for EstimateMotion(), which resolves it.
  double threshold_px = kAutoThresholdPx;
  double confidence = 0.9999;  // in (0, 1): that one sample of inliers was drawn
  int max_iterations = 10000;  // >= 1
  // At least so many: noise makes most samples of inliers poor hypotheses.
  int min_iterations = 100;  // >= 0
  bool local_optimization = true;
  // Samples from the matches of best score first, where they have scores.
  bool prosac = true;
  // Scoring stops where a hypothesis can no longer win. Changes the time alone.
  bool early_termination = true;
  // A hypothesis is left where some of the matches say that it can hardly win (bail-out test, Capel
  // 2005): of those that would, at most one in a thousand is lost. For scores that are sums.
  bool bail_out = true;
  ScoreKind score = ScoreKind::kMsac;
  // After the loop, so many hypotheses are locally optimized that do best at a loose threshold and
  // differ from one another and from the best: where the prior is off, no minimal hypothesis fits
  // well at the threshold, and the one that fits best may be far from the truth. 0 to
  // kMaxFinalists.
  int num_finalists = 4;
  // Of more matches than these, hypotheses are scored on so many, drawn evenly over their order:
  // they tell good from bad as well as all do, and time stays bounded. The samples come from all.
  int max_scored = 4096;  // >= 1
  // The loop ends once its work, counted and not timed, so that the result is the same on every
  // machine, would have taken about so long on one core of 2020. At the defaults only
  // 6pt-stewenius, and rigs with thousands of camera pairs, come to that before max_iterations.
  double max_work_us = 1.5e6;  // > 0; may be infinite
  uint64_t seed = 1;

  bool IsValid(std::string* error) const;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_RANSAC_OPTIONS_H_
