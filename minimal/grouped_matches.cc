#include "rigel/minimal/grouped_matches.h"

#include <algorithm>
#include <numeric>

#include "rigel/core/epipolar.h"

namespace rigel {

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
  pixels_.resize(4 * static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) {
    const Match& m = matches[original_[k]];
    if (groups_.empty() || groups_.back().camera1 != m.camera1 ||
        groups_.back().camera2 != m.camera2) {
      groups_.push_back({m.camera1, m.camera2, k, 0});
    }
    ++groups_.back().size;
    matches_.push_back(m);
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

void GroupedMatches::SquaredErrors(const Pose& pose, std::vector<double>* errors) const {
  errors->resize(matches_.size());
  for (const MatchGroup& group : groups_) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = Fundamental(group, pose);
    SquaredSampsonErrors(Pixels(group), F.data(), errors->data() + group.begin);
  }
}

}  // namespace rigel
