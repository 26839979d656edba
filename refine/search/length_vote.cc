#include "rigel/refine/search/length_vote.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace rigel {
namespace {

// Of the logarithm of a length: votes within this of one another are for one length. Errors of the
// calibration and of the rotation spread the votes by some tenths.
constexpr double kWindow = 0.2;
// Largest standard deviation of a vote, as a fraction of the length.
constexpr double kMaxSigma = 0.2;
// Fewer votes agree by chance.
constexpr size_t kMinVotes = 8;

// The logarithms of the lengths for which the matches vote.
std::vector<double> Votes(const GroupedMatches& matches, const Pose& pose, double noise_px) {
  const Eigen::Vector3d d = pose.t.normalized();
  std::vector<double> votes;
  for (const MatchGroup& group : matches.groups()) {
    if (group.camera1 == group.camera2) continue;
    const GroupedMatches::Places at = matches.PlacesOf(group, pose, true);
    const Eigen::Vector3d arm = pose.R * at.s1 - at.s2;
    // Radians: the noise of both pixels.
    const double noise = std::sqrt(2.0) * noise_px * matches.RadiansPerPixel(group);
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      const RayPair rays = matches.rays(k);
      const Eigen::Vector3d normal = (pose.R * rays.ray1.x).cross(rays.ray2.x);
      // The constraint is normal . (arm + l d) = 0.
      const double slope = normal.dot(d);
      const double length = -normal.dot(arm) / slope;
      if (!(length > 0) || !std::isfinite(length)) continue;
      const double sigma = noise * (arm + length * d).norm() / std::abs(slope);
      if (sigma < kMaxSigma * length) votes.push_back(std::log(length));
    }
  }
  return votes;
}

}  // namespace

std::vector<double> VoteOnLength(const GroupedMatches& matches, const Pose& pose, double noise_px) {
  std::vector<double> votes = Votes(matches, pose, noise_px);
  std::sort(votes.begin(), votes.end());
  // The windows with the most votes of those that overlap.
  std::vector<std::pair<size_t, double>> peaks;  // votes, logarithm of the length
  for (size_t begin = 0, end = 0; begin < votes.size(); ++begin) {
    while (end < votes.size() && votes[end] <= votes[begin] + kWindow) ++end;
    const size_t count = end - begin;
    if (count < kMinVotes) continue;
    const double middle = votes[begin + count / 2];
    if (peaks.empty() || middle - peaks.back().second > kWindow) {
      peaks.emplace_back(count, middle);
    } else if (count > peaks.back().first) {
      peaks.back() = {count, middle};
    }
  }
  std::vector<double> lengths;
  for (const auto& [count, middle] : peaks) lengths.push_back(std::exp(middle));
  return lengths;
}

}  // namespace rigel
