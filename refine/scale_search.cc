#include "rigel/refine/scale_search.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "rigel/refine/sign_and_scale.h"
#include "rigel/refine/small_engine.h"
#include "rigel/refine/uncertainty.h"

namespace rigel {
namespace {

constexpr int kMaxLengths = 12;
constexpr double kStep = 3.0;
constexpr double kHopeless = 0.7;
constexpr double kFar = 1000.0;
// The rotation found with a wrong |t| is off by a few sigma.
constexpr double kLooseFactor = 4.0;

// So many tell one minimum from another.
constexpr size_t kSubset = 200;

double ShortestLength(const GroupedMatches& matches, const Eigen::Matrix3d& R) {
  double shortest = 0.0;
  for (const MatchGroup& group : matches.groups()) {
    const Eigen::Vector3d& s1 = matches.rig().cameras[group.camera1].s;
    const Eigen::Vector3d& s2 = matches.rig().cameras[group.camera2].s;
    const double baseline = (R * s1 - s2).norm();
    shortest = std::max(shortest, (group.camera1 == group.camera2 ? 0.5 : 0.03) * baseline);
  }
  return shortest;
}

}  // namespace

bool SearchScale(const GroupedMatches& matches, double threshold_px, double noise_px, Pose* pose) {
  const double norm = pose->t.norm();
  double length = ShortestLength(matches, pose->R);
  if (!(norm > 0) || !(length > 0)) return false;
  const Eigen::Vector3d direction = pose->t / norm;
  const GroupedMatches subset(matches.rig(), EvenSubset(matches.matches(), kSubset));
  SmallEngine engine(subset);
  std::vector<double> errors;
  std::vector<char> mask(subset.size(), 1);
  const std::vector<char> all = mask;

  // Shortest first, in the end one so long that the arms do not matter.
  std::vector<double> lengths;
  const double share = subset.size() / static_cast<double>(matches.size());
  for (int k = 0; k < kMaxLengths; ++k, length *= kStep) {
    Pose at = *pose;
    at.t = length * direction;
    const Matrix6d information =
        SampsonInformation(subset, all, at) / (share * noise_px * noise_px);
    if (RelativeScaleSigma(information, at) > kHopeless) break;
    lengths.push_back(length);
  }
  lengths.push_back(std::max(kFar * ShortestLength(matches, pose->R), kStep * length));

  int inliers = 0;
  const auto score_of = [&](const GroupedMatches& scored, const Pose& motion) {
    return scored.ScoreInFront(motion, threshold_px, std::numeric_limits<double>::infinity(),
                               &inliers);
  };
  const double outlier = threshold_px * threshold_px;
  double best = std::numeric_limits<double>::infinity();
  Pose found = *pose;
  // The start takes its place among the lengths.
  bool start_pending = true;
  const auto consider = [&](const Pose& candidate) {
    const double score = score_of(subset, candidate);
    if (!(score < best - outlier)) return;
    best = score;
    found = candidate;
  };
  for (auto it = lengths.rbegin(); it != lengths.rend(); ++it) {
    if (start_pending && norm > *it) {
      consider(*pose);
      start_pending = false;
    }
    Pose candidate = *pose;
    candidate.t = *it * direction;
    ResolveSign(subset, kLooseFactor * threshold_px, &candidate);
    SmallEngineOptions options;
    options.inverse_scale = true;
    for (const double factor : {kLooseFactor, 1.0, 1.0}) {
      options.loss_scale = factor * threshold_px;
      subset.SelectInliers(candidate, options.loss_scale, &errors, &mask);
      if (!engine.Minimize(options, mask, &candidate)) break;
    }
    consider(candidate);
  }
  if (start_pending) consider(*pose);
  // What the subset prefers must not be worse for all.
  if (found.t == pose->t || !(score_of(matches, found) < score_of(matches, *pose) + outlier)) {
    return false;
  }
  *pose = found;
  return true;
}

}  // namespace rigel
