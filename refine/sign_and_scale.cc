#include "rigel/refine/sign_and_scale.h"

#include <algorithm>
#include <limits>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/rays.h"

namespace rigel {
namespace {

constexpr int kMaxLookedAt = 100;
constexpr int kMaxScaleSteps = 8;

// At least this share of the matches that can tell must lie in front of their cameras.
constexpr double kMinShareInFront = 0.6;
// Fewer decided matches than this share say nothing.
constexpr double kMinShareDecided = 0.05;

struct LookedAt {
  RayPair rays;
  Eigen::Vector3d p1, p2;  // centred pixels
  double min_sin_parallax;
  int group;
};

struct Subset {
  LookedAt items[kMaxLookedAt];
  int size = 0;
};

void ChooseSubset(const GroupedMatches& matches, double threshold_px, Subset* subset) {
  const int n = matches.size();
  const int count = std::min(n, kMaxLookedAt);
  size_t group = 0;
  for (int i = 0; i < count; ++i) {
    const int k = static_cast<int>(static_cast<long long>(i) * n / count);
    while (k >= matches.groups()[group].begin + matches.groups()[group].size) ++group;
    const Match& m = matches.matches()[k];
    const Rig& rig = matches.rig();
    const PinholeCamera& c1 = rig.cameras[m.camera1].intrinsics;
    const PinholeCamera& c2 = rig.cameras[m.camera2].intrinsics;
    subset->items[subset->size++] = {
        matches.rays(k), CentredPixel(c1, m.pixel1), CentredPixel(c2, m.pixel2),
        matches.DecidedParallax(matches.groups()[group], threshold_px), static_cast<int>(group)};
  }
}

// Calls visit(item, squared Sampson error, cheirality) for each match of the subset.
template <class Visit>
void VisitSubset(const GroupedMatches& matches, const Subset& subset, const Pose& pose,
                 const Visit& visit) {
  int group = -1;
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  for (int i = 0; i < subset.size; ++i) {
    const LookedAt& item = subset.items[i];
    if (item.group != group) {
      group = item.group;
      F = matches.Fundamental(matches.groups()[group], pose);
    }
    const double r = SampsonError(F, item.p1, item.p2);
    visit(item, r * r, TestCheirality(pose, item.rays, item.min_sin_parallax));
  }
}

struct Votes {
  int in_front = 0;
  int behind = 0;
  int decided = 0;  // with those of mixed depths
  bool Enough(int looked_at) const { return decided > kMinShareDecided * looked_at; }
};

Votes CountVotes(const GroupedMatches& matches, const Subset& subset, double t2, const Pose& pose) {
  Votes votes;
  VisitSubset(matches, subset, pose, [&](const LookedAt&, double r2, Cheirality cheirality) {
    if (!(r2 < t2)) return;
    votes.in_front += cheirality == Cheirality::kInFront;
    votes.behind += cheirality == Cheirality::kBehind;
    votes.decided += cheirality != Cheirality::kUndecided;
  });
  return votes;
}

// The mean of the unit baselines of the camera pairs, each with the sign that its matches want and
// weighted by their number; zero if nothing is decided.
Eigen::Vector3d SignedMeanBaseline(const GroupedMatches& matches, const Subset& subset, double t2,
                                   const Pose& pose) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  VisitSubset(matches, subset, pose, [&](const LookedAt& item, double r2, Cheirality cheirality) {
    if (!(r2 < t2)) return;
    const int sign = cheirality == Cheirality::kInFront  ? 1
                     : cheirality == Cheirality::kBehind ? -1
                                                         : 0;
    const Eigen::Vector3d b = pose.R * item.rays.ray1.s + pose.t - item.rays.ray2.s;
    if (b.norm() > 0) sum += sign * b.normalized();
  });
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
  Subset subset;
  ChooseSubset(matches, threshold_px, &subset);
  const double t2 = threshold_px * threshold_px;
  Votes votes = CountVotes(matches, subset, t2, *pose);
  if (!votes.Enough(subset.size)) return true;
  if (votes.behind > votes.in_front) {
    pose->t = -pose->t;
    // The arms do not flip with t, so the depths have to be looked at again.
    votes = CountVotes(matches, subset, t2, *pose);
    if (!votes.Enough(subset.size)) return true;
  }
  return votes.in_front >= kMinShareInFront * votes.decided;
}

void ResolveSignAndScale(const GroupedMatches& matches, double threshold_px, Pose* pose) {
  Subset subset;
  ChooseSubset(matches, threshold_px, &subset);
  const double t2 = threshold_px * threshold_px;
  const Eigen::Vector3d start = pose->t;
  const Eigen::Vector3d mean = SignedMeanBaseline(matches, subset, t2, *pose) *
                               std::max(start.norm(), LargestArm(matches, pose->R));
  double best = std::numeric_limits<double>::infinity();
  Eigen::Vector3d best_t = start;
  double factor = 1.0;
  for (int k = 0; k <= kMaxScaleSteps; ++k) {
    for (const Eigen::Vector3d& t :
         {Eigen::Vector3d(factor * start), Eigen::Vector3d(-factor * start),
          Eigen::Vector3d(factor * mean)}) {
      Pose candidate = *pose;
      candidate.t = t;
      double score = 0.0;
      VisitSubset(matches, subset, candidate,
                  [&](const LookedAt&, double r2, Cheirality cheirality) {
                    const bool possible =
                        cheirality == Cheirality::kInFront || cheirality == Cheirality::kUndecided;
                    score += possible && r2 < t2 ? r2 : t2;
                  });
      if (score < best) {
        best = score;
        best_t = t;
      }
    }
    factor *= 4.0;
  }
  pose->t = best_t;
}

}  // namespace rigel
