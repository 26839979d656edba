#include "rigel/refine/search/sign_and_scale.h"

#include <algorithm>
#include <limits>

namespace rigel {
namespace {

constexpr int kMaxScaleSteps = 8;
// Times the largest arm: at this length the arms hardly change the direction of a baseline.
constexpr double kFar = 1000.0;

// At least this share of the decided matches must lie in front of their cameras.
constexpr double kMinShareInFront = 0.6;
// With fewer decided matches than this share nothing is decided.
constexpr double kMinShareDecided = 0.05;

bool Enough(const DepthCounts& counts, int looked_at) {
  return counts.decided > kMinShareDecided * looked_at;
}

void CountGroup(const GroupedMatches& matches, const MatchGroup& group, double threshold_px,
                const Pose& pose, DepthCounts* counts) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = matches.Fundamental(group, pose);
  CountDepths(matches.Rows(group), matches.Directions(group), F.data(),
              matches.MotionOf(group, pose, threshold_px), threshold_px * threshold_px, counts);
}

DepthCounts CountAll(const GroupedMatches& matches, double threshold_px, const Pose& pose) {
  DepthCounts counts;
  for (const MatchGroup& group : matches.groups()) {
    CountGroup(matches, group, threshold_px, pose, &counts);
  }
  return counts;
}

// The mean of the unit baselines of the camera pairs, each with the sign that its matches support,
// weighted by their number. Zero if nothing is decided.
Eigen::Vector3d SignedMeanBaseline(const GroupedMatches& matches, double threshold_px,
                                   const Pose& pose) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const MatchGroup& group : matches.groups()) {
    DepthCounts counts;
    CountGroup(matches, group, threshold_px, pose, &counts);
    const Rig& rig = matches.rig();
    const Eigen::Vector3d b =
        pose.R * rig.cameras[group.camera1].s + pose.t - rig.cameras[group.camera2].s;
    if (b.norm() > 0) sum += (counts.in_front - counts.behind) * b.normalized();
  }
  return sum.norm() > 0 ? Eigen::Vector3d(sum.normalized()) : sum;
}

double LargestArm(const GroupedMatches& matches, const Eigen::Matrix3d& R) {
  double largest = 0.0;
  for (const RigCamera& camera : matches.rig().cameras) {
    largest = std::max(largest, (R * camera.s - camera.s).norm());
  }
  return largest;
}

}  // namespace

bool ResolveSign(const GroupedMatches& matches, double threshold_px, Pose* pose) {
  DepthCounts counts = CountAll(matches, threshold_px, *pose);
  if (!Enough(counts, matches.size())) return true;
  if (counts.behind > counts.in_front) {
    pose->t = -pose->t;
    // The arms do not flip with t, so the depths are counted again.
    counts = CountAll(matches, threshold_px, *pose);
    if (!Enough(counts, matches.size())) return true;
  }
  return counts.in_front >= kMinShareInFront * counts.decided;
}

void ResolveSignAndScale(const GroupedMatches& matches, double threshold_px, Pose* pose) {
  const Eigen::Vector3d start = pose->t;
  const double norm = start.norm();
  const double arm = LargestArm(matches, pose->R);
  const Eigen::Vector3d mean =
      SignedMeanBaseline(matches, threshold_px, *pose) * std::max(norm, arm);
  constexpr double kSameDirection = 0.999;  // 2.6 deg
  // Or there is no mean, as nothing is decided.
  const bool mean_is_start =
      !(mean.norm() > 0) ||
      (norm >= arm && std::abs(mean.dot(start)) > kSameDirection * norm * norm);
  double best = std::numeric_limits<double>::infinity();
  Eigen::Vector3d best_t = start;
  double factor = 1.0;
  const Eigen::Vector3d directions[] = {start, -start, mean};
  for (int k = 0; k <= kMaxScaleSteps; ++k) {
    for (int i = 0; i < (mean_is_start ? 2 : 3); ++i) {
      const Eigen::Vector3d t = factor * directions[i];
      Pose candidate = *pose;
      candidate.t = t;
      const double score = matches.ScoreInFront(candidate, threshold_px, best, nullptr);
      if (score < best) {
        best = score;
        best_t = t;
      }
    }
    if (factor * norm > kFar * arm) break;
    factor *= 4.0;
  }
  pose->t = best_t;
}

}  // namespace rigel
