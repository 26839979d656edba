#include "rigel/problems/images/frame_stamps.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "rigel/core/median.h"
#include "rigel/problems/io/csv.h"

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

StampFrames GroupStamps(const std::vector<Stamps>& cameras, std::optional<double> tolerance_ms) {
  // Nanoseconds: larger doubles cannot be converted to int64_t.
  constexpr double kMaxTolerance = 9e18;
  const int64_t tolerance =
      tolerance_ms ? static_cast<int64_t>(std::min(std::round(*tolerance_ms * 1e6), kMaxTolerance))
                   : DefaultSyncTolerance(cameras.front());
  StampFrames result;
  result.within = Milliseconds(tolerance) +
                  (tolerance_ms ? "" : ", a tenth of the frame interval") +
                  " (--sync_tolerance_ms)";
  std::vector<StampFrame>& frames = result.frames;
  for (size_t k = 0; k < cameras.size(); ++k) {
    Stamps times;
    for (const StampFrame& frame : frames) times.push_back(frame.time);
    std::vector<bool> has_partner(cameras[k].size(), false);
    for (const auto& [frame, index] : PairStamps(times, cameras[k], tolerance)) {
      frames[frame].images[k] = index;
      has_partner[index] = true;
      result.largest = std::max(result.largest, std::abs(cameras[k][index] - times[frame]));
    }
    for (size_t index = 0; index < cameras[k].size(); ++index) {
      if (has_partner[index]) continue;
      StampFrame alone{cameras[k][index], std::vector<int>(cameras.size(), -1)};
      alone.images[k] = static_cast<int>(index);
      frames.push_back(std::move(alone));
    }
    std::sort(frames.begin(), frames.end(),
              [](const StampFrame& a, const StampFrame& b) { return a.time < b.time; });
  }
  if (result.largest > 0) {
    result.setting = "sync_tolerance_ms " + (tolerance_ms ? CsvNumber(*tolerance_ms) : "default");
  }
  return result;
}

bool IsSyncTolerance(std::optional<double> tolerance_ms, std::string* error) {
  if (!tolerance_ms || (std::isfinite(*tolerance_ms) && *tolerance_ms >= 0)) return true;
  *error = "sync_tolerance_ms: expected a number from 0";
  return false;
}

std::string Milliseconds(int64_t nanoseconds) {
  return CsvNumber(static_cast<double>(nanoseconds) / 1e6) + " ms";
}

}  // namespace rigel
