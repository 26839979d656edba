#include "rigel/refine/scale_search.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "rigel/refine/epipolar_residuals.h"
#include "rigel/refine/sign_and_scale.h"
#include "rigel/refine/small_engine.h"
#include "rigel/refine/uncertainty.h"

namespace rigel {
namespace {

constexpr int kMaxLengths = 12;
constexpr double kStep = 3.0;
constexpr double kHopeless = 0.7;
// The rotation found with a wrong |t| is off by a few sigma.
constexpr double kLooseFactor = 4.0;

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
  const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
  SmallEngine engine(residuals);
  std::vector<double> errors;
  std::vector<char> mask(matches.size(), 1);
  const std::vector<char> all = mask;

  int inliers = 0;
  double best =
      matches.ScoreInFront(*pose, threshold_px, std::numeric_limits<double>::infinity(), &inliers) -
      threshold_px * threshold_px;
  bool found = false;
  for (int k = 0; k < kMaxLengths; ++k, length *= kStep) {
    Pose candidate = *pose;
    candidate.t = length * direction;
    const Matrix6d information =
        SampsonInformation(matches, all, candidate) / (noise_px * noise_px);
    if (RelativeScaleSigma(information, candidate) > kHopeless) break;
    ResolveSign(matches, kLooseFactor * threshold_px, &candidate);
    SmallEngineOptions options;
    options.inverse_scale = true;
    for (const double factor : {kLooseFactor, 1.0, 1.0}) {
      options.loss_scale = factor * threshold_px;
      matches.SelectInliers(candidate, options.loss_scale, &errors, &mask);
      if (!engine.Minimize(options, mask, &candidate)) break;
    }
    const double score = matches.ScoreInFront(candidate, threshold_px, best, &inliers);
    if (score < best) {
      best = score;
      *pose = candidate;
      found = true;
    }
  }
  return found;
}

}  // namespace rigel
