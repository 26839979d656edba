#include "rigel/problems/images/stereo_stamps.h"

#include <algorithm>
#include <cstdlib>

#include "rigel/core/median.h"

namespace rigel {
namespace {

// Index of the stamp nearest to `time`; there is one at least.
int Nearest(const Stamps& stamps, int64_t time) {
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), time);
  const int index = static_cast<int>(after - stamps.begin());
  if (after == stamps.begin()) return 0;
  if (after == stamps.end()) return index - 1;
  return time - stamps[index - 1] <= *after - time ? index - 1 : index;
}

}  // namespace

int64_t DefaultSyncTolerance(const Stamps& stamps) {
  if (stamps.size() < 2) return 0;
  std::vector<int64_t> intervals;
  for (size_t k = 1; k < stamps.size(); ++k) intervals.push_back(stamps[k] - stamps[k - 1]);
  return MedianInPlace(&intervals) / 10;
}

std::vector<std::pair<int, int>> PairStamps(const Stamps& stamps1, const Stamps& stamps2,
                                            int64_t tolerance) {
  std::vector<std::pair<int, int>> pairs;
  if (stamps2.empty()) return pairs;
  for (int k = 0; k < static_cast<int>(stamps1.size()); ++k) {
    const int partner = Nearest(stamps2, stamps1[k]);
    if (std::abs(stamps2[partner] - stamps1[k]) > tolerance) continue;
    if (Nearest(stamps1, stamps2[partner]) == k) pairs.emplace_back(k, partner);
  }
  return pairs;
}

}  // namespace rigel
