#include "rigel/refine/group_noise.h"

#include <algorithm>
#include <cmath>

namespace rigel {
namespace {

double MedianOf(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<long>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace

std::vector<double> GroupNoiseWeights(const GroupedMatches& matches,
                                      const std::vector<double>& squared_errors,
                                      const std::vector<char>& inliers) {
  std::vector<double> weights(matches.groups().size(), 1.0);
  if (matches.groups().size() < 2) return weights;
  std::vector<double> all, own;
  all.reserve(inliers.size());
  for (size_t k = 0; k < inliers.size(); ++k) {
    if (inliers[k]) all.push_back(squared_errors[k]);
  }
  const double median2 = all.empty() ? 0.0 : MedianOf(&all);
  if (!(median2 > 0.0)) return weights;
  for (size_t g = 0; g < weights.size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    own.clear();
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (inliers[k]) own.push_back(squared_errors[k]);
    }
    if (own.empty()) continue;
    // log of the ratio of the noises.
    const double ratio = 0.5 * std::log(MedianOf(&own) / median2);
    const double standard_error = 1.17 / std::sqrt(static_cast<double>(own.size()));
    // Also false for the infinity of a median of zero.
    if (!(std::abs(ratio) > kGroupNoiseSigmas * standard_error) || !std::isfinite(ratio)) continue;
    weights[g] = std::clamp(std::exp(-ratio), 1.0 / kMaxGroupNoiseRatio, kMaxGroupNoiseRatio);
  }
  return weights;
}

}  // namespace rigel
