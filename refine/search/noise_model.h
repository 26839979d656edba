// The noise of the matches and the outliers among them: what weights, gates and tests read.
//
// Sampson errors of inliers are normal with one standard deviation a camera pair. Matches between
// cameras are often noisier than those of one camera: because of the exposure, a wider baseline, or
// errors of the calibration. Errors of outliers are uniform near zero: they are counted in a band
// of larger errors, and their share is taken out below the gate. The gate cuts off a part of the
// inliers too; the standard deviation is corrected for it. It follows the noise: from the threshold
// on, gate and noise are computed in turns until they stand.
#ifndef RIGEL_REFINE_SEARCH_NOISE_MODEL_H_
#define RIGEL_REFINE_SEARCH_NOISE_MODEL_H_

#include <optional>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// The errors of all matches at a motion, in grouped order.
struct MatchErrors {
  std::vector<double> squared;  // squared Sampson errors, pixels^2
  std::vector<char> in_front;   // 1: the match does not lie behind a camera

  // `threshold_px`: noise of this size decides no depth.
  void Set(const GroupedMatches& matches, const Pose& pose, double threshold_px);
};

// Residuals beyond this many sigma are more likely outliers (uniform in the image) than inliers
// with Gaussian noise. A gate at 3 sigma costs 2 to 3 percent of the accuracy.
inline constexpr double kGateSigmas = 6.0;
// Thresholds of scores, signs and doubts: nearly all inliers are below, and few outliers.
inline constexpr double kThresholdSigmas = 3.0;
// The band in which outliers are counted, in gates.
inline constexpr double kBandBegin = 8.0;
inline constexpr double kBandEnd = 24.0;

struct NoiseModel {
  double sigma_px = 1.0;                // of all inliers
  std::vector<double> sigma_of;         // of each camera pair (matches.groups()), pixels
  std::vector<double> gate_of;          // its gate, pixels: larger errors are outliers
  std::vector<double> outliers_per_px;  // its outliers per pixel of the error, near zero
};

struct NoiseOptions {
  double threshold_px = 1.5;       // the first gate
  bool keep_threshold = false;     // it is the gate of all camera pairs, whatever the noise
  std::optional<double> noise_px;  // the noise of all camera pairs, if it is known
  double min_noise_px = 0.0;
};

// The noise from the errors. `num_parameters` of the motion were fitted to the inliers. `before` is
// the noise at a motion nearby, from which the gates start; null: from the threshold.
NoiseModel EstimateNoise(const NoiseOptions& options, const GroupedMatches& matches,
                         const MatchErrors& errors, int num_parameters, const NoiseModel* before);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_NOISE_MODEL_H_
