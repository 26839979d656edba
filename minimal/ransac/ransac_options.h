// The options of RANSAC: threshold, score, iterations, limits of the work.
#ifndef RIGEL_MINIMAL_RANSAC_RANSAC_OPTIONS_H_
#define RIGEL_MINIMAL_RANSAC_RANSAC_OPTIONS_H_

#include <cstdint>
#include <string>

#include "rigel/core/pixel_unit.h"

namespace rigel {

// Capacity, hypotheses. Each takes the time of a local optimization, so more are of no use.
inline constexpr int kMaxFinalists = 16;

enum class ScoreKind {
  kMsac,  // sum min(r^2, threshold^2), Torr and Zisserman 2000
  // Number of outliers, Fischler and Bolles 1981. Among hypotheses with the same number the first
  // wins. For comparisons with published figures; scoring never stops early.
  kInlierCount,
};

struct RansacOptions {
  // Largest Sampson error of an inlier, pixels, 1e-12 to 1e12; three sigma of the image noise is a
  // good value. kAutoThresholdPx: 1.5, or 1/300 of the shortest focal length if that is less. Only
  // EstimateMotion() takes this value, and replaces it.
  double threshold_px = kAutoThresholdPx;
  double confidence = 0.9999;  // in (0, 1): probability that a sample of inliers was drawn
  // Iterations, at most: with 4 matches a sample, enough for 82 percent of outliers.
  int max_iterations = 10000;  // >= 1
  // Iterations, at least. Because of noise most samples of inliers give poor hypotheses. Others:
  // rigel_benchmark --ransac=ablation.
  int min_iterations = 100;  // >= 0
  bool local_optimization = true;
  // Draws from the matches of best score first, if they have scores.
  bool prosac = true;
  // Stops scoring a hypothesis that can no longer win. Changes only the time.
  bool early_termination = true;
  // Scores a hypothesis on a subset first and drops it if it is unlikely to win (bail-out test,
  // Capel 2005). It loses at most one winner in a thousand. Not for kInlierCount.
  bool bail_out = true;
  ScoreKind score = ScoreKind::kMsac;
  // Number of hypotheses that are locally optimized after the loop: those that score best at a
  // loose threshold and differ from one another and from the best. They help if the prior has an
  // error. Then no minimal hypothesis fits well at the threshold, and the one that fits best may be
  // far from the truth. 0 to kMaxFinalists. Others: rigel_benchmark --ransac=ablation.
  int num_finalists = 4;
  // If there are more matches, hypotheses are scored on so many, drawn evenly over their order.
  // They separate good and bad hypotheses as well as all matches do, and bound the time. Samples
  // are drawn from all matches. Fewer: rigel_benchmark --ransac=ablation.
  int max_scored = 4096;  // >= 1
  // Bound of the work, microseconds of one core of 2020: a frame pair takes a second or two at
  // most. The work is counted, not timed, so the result is the same on every machine. With the
  // defaults only 6pt-stewenius, and rigs with thousands of camera pairs, reach it before
  // max_iterations (rigel_benchmark --ransac=hostile).
  double max_work_us = 1.5e6;  // > 0; may be infinite
  uint64_t seed = 1;

  // False with a message in `error` (not null) if a member is out of its range.
  bool IsValid(std::string* error) const;
};

}  // namespace rigel

#endif  // RIGEL_MINIMAL_RANSAC_RANSAC_OPTIONS_H_
