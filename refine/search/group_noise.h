// Image noise that differs between camera pairs.
//
// Matches between cameras are often noisier than those of one camera: another exposure, a wider
// baseline, what is left of the calibration's error. Where the residuals say so the matches of each
// camera pair are weighed by their own noise.
#ifndef RIGEL_REFINE_SEARCH_GROUP_NOISE_H_
#define RIGEL_REFINE_SEARCH_GROUP_NOISE_H_

#include <vector>

#include "rigel/core/grouped_matches.h"

namespace rigel {

// A camera pair's noise is taken as that of all unless its median residual is off by more than so
// many of its standard errors, 1.17 / sqrt(n) of itself.
inline constexpr double kGroupNoiseSigmas = 4.0;
// And by this factor at most.
inline constexpr double kMaxGroupNoiseRatio = 4.0;

// For each group of `matches` the noise of all inliers over its own, from the medians of the
// inliers' residuals: 1 where they do not differ. `squared_errors` (pixels^2) and `inliers` (0 or
// 1) are in grouped order; `median_px` is that of all inliers.
std::vector<double> GroupNoiseWeights(const GroupedMatches& matches,
                                      const std::vector<double>& squared_errors,
                                      const std::vector<char>& inliers, double median_px);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_GROUP_NOISE_H_
