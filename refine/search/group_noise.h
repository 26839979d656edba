// Image noise that differs between camera pairs.
//
// Matches between cameras are often noisier than those of one camera: because of the exposure, a
// wider baseline, or errors of the calibration. If the residuals show this, the matches of each
// camera pair are weighted by their own noise.
#ifndef RIGEL_REFINE_SEARCH_GROUP_NOISE_H_
#define RIGEL_REFINE_SEARCH_GROUP_NOISE_H_

#include <vector>

#include "rigel/core/grouped_matches.h"

namespace rigel {

// A camera pair has the noise of all matches, unless its median residual differs from theirs by
// more than so many standard errors. The standard error is 1.17 / sqrt(n) of the median.
inline constexpr double kGroupNoiseSigmas = 4.0;
// Largest factor between the noise of a pair and that of all.
inline constexpr double kMaxGroupNoiseRatio = 4.0;

// For each group of `matches`: the noise of all inliers over the noise of its own, estimated by the
// medians of the residuals. 1 if they do not differ. `squared_errors` (pixels^2) and `inliers` (0
// or 1) are in grouped order; `median_px` is the median residual of all inliers.
std::vector<double> GroupNoiseWeights(const GroupedMatches& matches,
                                      const std::vector<double>& squared_errors,
                                      const std::vector<char>& inliers, double median_px);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_GROUP_NOISE_H_
