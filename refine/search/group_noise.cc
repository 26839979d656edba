#include "rigel/refine/search/group_noise.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/median.h"

namespace rigel {

std::vector<double> GroupNoiseWeights(const GroupedMatches& matches,
                                      const std::vector<double>& squared_errors,
                                      const std::vector<char>& inliers, double median_px) {
  std::vector<double> weights(matches.groups().size(), 1.0);
  if (matches.groups().size() < 2 || !(median_px > 0.0)) return weights;
  std::vector<double> own;
  for (size_t g = 0; g < weights.size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    own.clear();
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (inliers[k]) own.push_back(squared_errors[k]);
    }
    if (own.empty()) continue;
    // Logarithm of the ratio of the two noise levels.
    const double ratio = 0.5 * std::log(MedianInPlace(&own) / (median_px * median_px));
    const double standard_error = 1.17 / std::sqrt(static_cast<double>(own.size()));
    // Also false for infinity, which a median of zero gives.
    if (!(std::abs(ratio) > kGroupNoiseSigmas * standard_error) || !std::isfinite(ratio)) continue;
    weights[g] = std::clamp(std::exp(-ratio), 1.0 / kMaxGroupNoiseRatio, kMaxGroupNoiseRatio);
  }
  return weights;
}

}  // namespace rigel
