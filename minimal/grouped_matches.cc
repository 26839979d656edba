#include "rigel/minimal/grouped_matches.h"

#include <algorithm>
#include <numeric>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"

namespace rigel {
namespace {

bool LiesBehind(const Pose& pose, const RayPair& rays, double min_sin_parallax) {
  const Cheirality cheirality = TestCheirality(pose, rays, min_sin_parallax);
  return cheirality == Cheirality::kBehind || cheirality == Cheirality::kMixed;
}

}  // namespace

std::vector<Match> EvenSubset(const std::vector<Match>& matches, size_t count) {
  count = std::min(count, matches.size());
  std::vector<Match> subset;
  subset.reserve(count);
  for (size_t k = 0; k < count; ++k) subset.push_back(matches[k * matches.size() / count]);
  return subset;
}

GroupedMatches::GroupedMatches(const Rig& rig, const std::vector<Match>& matches) : rig_(rig) {
  const int n = static_cast<int>(matches.size());
  original_.resize(n);
  std::iota(original_.begin(), original_.end(), 0);
  std::stable_sort(original_.begin(), original_.end(), [&](int a, int b) {
    const Match& m = matches[a];
    const Match& o = matches[b];
    return m.camera1 != o.camera1 ? m.camera1 < o.camera1 : m.camera2 < o.camera2;
  });
  matches_.reserve(n);
  rays_.reserve(n);
  pixels_.resize(4 * static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) {
    const Match& m = matches[original_[k]];
    if (groups_.empty() || groups_.back().camera1 != m.camera1 ||
        groups_.back().camera2 != m.camera2) {
      groups_.push_back({m.camera1, m.camera2, k, 0});
    }
    ++groups_.back().size;
    matches_.push_back(m);
    rays_.push_back(MakeRayPair(rig, m));
    const PinholeCamera& c1 = rig.cameras[m.camera1].intrinsics;
    const PinholeCamera& c2 = rig.cameras[m.camera2].intrinsics;
    pixels_[k] = m.pixel1.x() - c1.cx;
    pixels_[n + k] = m.pixel1.y() - c1.cy;
    pixels_[2 * n + k] = m.pixel2.x() - c2.cx;
    pixels_[3 * n + k] = m.pixel2.y() - c2.cy;
  }
}

PixelArrays GroupedMatches::Pixels(const MatchGroup& group) const {
  const double* x1 = pixels_.data() + group.begin;
  const size_t n = matches_.size();
  return {x1, x1 + n, x1 + 2 * n, x1 + 3 * n, group.size};
}

Eigen::Matrix3d GroupedMatches::Fundamental(const MatchGroup& group, const Pose& pose) const {
  const RigCamera& camera1 = rig_.cameras[group.camera1];
  const RigCamera& camera2 = rig_.cameras[group.camera2];
  return CentredFundamental(EssentialMatrix(pose, camera1, camera2), camera1.intrinsics,
                            camera2.intrinsics);
}

double GroupedMatches::Score(const Pose& pose, double threshold_px, double bound,
                             int* num_inliers) const {
  *num_inliers = 0;
  double sum = 0.0;
  for (const MatchGroup& group : groups_) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = Fundamental(group, pose);
    sum += TruncatedSampsonSum(Pixels(group), F.data(), threshold_px * threshold_px, bound - sum,
                               num_inliers);
    if (!(sum <= bound)) break;
  }
  return sum;
}

double GroupedMatches::DecidedParallax(const MatchGroup& group, double threshold_px) const {
  const PinholeCamera& c1 = rig_.cameras[group.camera1].intrinsics;
  const PinholeCamera& c2 = rig_.cameras[group.camera2].intrinsics;
  return 2.0 * threshold_px / std::min({c1.fx, c1.fy, c2.fx, c2.fy});
}

double GroupedMatches::ScoreInFront(const Pose& pose, double threshold_px, double bound,
                                    int* num_inliers) const {
  *num_inliers = 0;
  const double t2 = threshold_px * threshold_px;
  double sum = 0.0;
  // Blocks of a fixed size, so that no memory has to be held for all errors.
  constexpr int kBlock = 64;
  double errors[kBlock];
  for (const MatchGroup& group : groups_) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = Fundamental(group, pose);
    const double min_sin_parallax = DecidedParallax(group, threshold_px);
    for (int begin = group.begin; begin < group.begin + group.size; begin += kBlock) {
      const int size = std::min(kBlock, group.begin + group.size - begin);
      SquaredSampsonErrors(Pixels({group.camera1, group.camera2, begin, size}), F.data(), errors);
      for (int k = 0; k < size; ++k) {
        const bool inlier = errors[k] < t2 && !LiesBehind(pose, rays_[begin + k], min_sin_parallax);
        sum += inlier ? errors[k] : t2;
        *num_inliers += inlier ? 1 : 0;
      }
      if (!(sum <= bound)) return sum;
    }
  }
  return sum;
}

int GroupedMatches::SelectInliers(const Pose& pose, double threshold_px,
                                  std::vector<double>* errors, std::vector<char>* inliers) const {
  SquaredErrors(pose, errors);
  inliers->resize(matches_.size());
  const double t2 = threshold_px * threshold_px;
  int count = 0;
  for (const MatchGroup& group : groups_) {
    const double min_sin_parallax = DecidedParallax(group, threshold_px);
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      const bool inlier = (*errors)[k] < t2 && !LiesBehind(pose, rays_[k], min_sin_parallax);
      (*inliers)[k] = inlier ? 1 : 0;
      count += inlier ? 1 : 0;
    }
  }
  return count;
}

void GroupedMatches::SquaredErrors(const Pose& pose, std::vector<double>* errors) const {
  errors->resize(matches_.size());
  for (const MatchGroup& group : groups_) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = Fundamental(group, pose);
    SquaredSampsonErrors(Pixels(group), F.data(), errors->data() + group.begin);
  }
}

}  // namespace rigel
