#include "rigel/core/grouped_matches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "rigel/core/epipolar.h"
#include "rigel/core/median.h"
#include "rigel/core/rig_centre.h"

namespace rigel {
namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// Positions of the matches sorted by camera1, then camera2: where they are not yet, by a stable
// counting sort, camera2 first.
std::vector<int> GroupedOrder(int num_cameras, const std::vector<Match>& matches) {
  std::vector<int> order(matches.size());
  std::iota(order.begin(), order.end(), 0);
  const auto comes_first = [](const Match& a, const Match& b) {
    return a.camera1 != b.camera1 ? a.camera1 < b.camera1 : a.camera2 < b.camera2;
  };
  if (std::is_sorted(matches.begin(), matches.end(), comes_first)) return order;
  std::vector<int> sorted(matches.size());
  for (int Match::*camera : {&Match::camera2, &Match::camera1}) {
    std::vector<int> next(num_cameras + 1);
    for (const Match& match : matches) ++next[match.*camera + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (const int k : order) sorted[next[matches[k].*camera]++] = k;
    order.swap(sorted);
  }
  return order;
}

// Both sides of a match.
using PointPair = std::array<RowPoint, 2>;

// Those of the matches of `order`. Takes the matches out of it that have a pixel without a ray.
std::vector<PointPair> PointsOf(const Rig& rig, const std::vector<Match>& matches,
                                std::vector<int>* order) {
  std::vector<PointPair> points;
  points.reserve(order->size());
  size_t kept = 0;
  for (const int k : *order) {
    const Match& m = matches[k];
    points.push_back({RowPointOf(rig.cameras[m.camera1], m.pixel1),
                      RowPointOf(rig.cameras[m.camera2], m.pixel2)});
    const bool has_rays =
        !std::isnan(points.back()[0].p.z()) && !std::isnan(points.back()[1].p.z());
    if (has_rays) {
      (*order)[kept++] = k;
    } else {
      points.pop_back();
    }
  }
  order->resize(kept);
  return points;
}

// In the body frame.
Eigen::Vector3d DirectionOf(const RigCamera& camera, const Pixel& pixel, const RowPoint& point) {
  return camera.intrinsics.IsPinhole() ? MakeRay(camera, pixel).x : camera.Q * point.p;
}

double MedianSigma(const MatchColumns& columns) {
  std::vector<double> all = columns.sigma1;
  all.insert(all.end(), columns.sigma2.begin(), columns.sigma2.end());
  return MedianInPlace(&all);
}

}  // namespace

GroupedMatches::GroupedMatches(const Rig& rig, const std::vector<Match>& matches,
                               const MatchColumns& columns, double interval)
    : rig_(rig),
      original_(GroupedOrder(rig.size(), matches)),
      num_given_(static_cast<int>(matches.size())) {
  const std::vector<double>* sigmas[2] = {&columns.sigma1, &columns.sigma2};
  const bool has_sigmas = !sigmas[0]->empty() || !sigmas[1]->empty();
  const double typical = has_sigmas ? MedianSigma(columns) : 1.0;
  general_ = has_sigmas ||
             std::any_of(rig.cameras.begin(), rig.cameras.end(),
                         [](const RigCamera& camera) { return !camera.intrinsics.IsPinhole(); });
  const std::vector<PointPair> points = PointsOf(rig, matches, &original_);

  for (const RigCamera& camera : rig.cameras) {
    unproject_.emplace_back(camera.Q * Unprojection(camera));
  }
  SetTimes(interval);
  const size_t n = points.size();
  matches_.reserve(n);
  rows_.resize((general_ ? 4 + kGeneralArrays : 4) * n + kKernelPadding);
  directions_.resize(6 * n + kKernelPadding);
  for (size_t k = 0; k < n; ++k) {
    const Match& m = matches[original_[k]];
    if (groups_.empty() || groups_.back().camera1 != m.camera1 ||
        groups_.back().camera2 != m.camera2) {
      groups_.push_back({m.camera1, m.camera2, static_cast<int>(k), 0});
    }
    ++groups_.back().size;
    matches_.push_back(m);
    if (!columns.landmark.empty()) landmarks_.push_back(columns.landmark[original_[k]]);
    for (int side = 0; side < 2; ++side) {
      const RowPoint& point = points[k][side];
      const Eigen::Vector3d x = side == 0 ? DirectionOf(rig.cameras[m.camera1], m.pixel1, point)
                                          : DirectionOf(rig.cameras[m.camera2], m.pixel2, point);
      for (int i = 0; i < 3; ++i) directions_[(3 * side + i) * n + k] = x[i];
      const double factor = sigmas[side]->empty() ? 1.0 : (*sigmas[side])[original_[k]] / typical;
      SetPoint(k, side, point, factor, n);
    }
  }
}

void GroupedMatches::SetTimes(double interval) {
  if (!(interval > 0)) return;
  for (const RigCamera& camera : rig_.cameras) later_.push_back(camera.time_offset / interval);
  if (std::all_of(later_.begin(), later_.end(), [](double a) { return a == 0; })) later_.clear();
}

void GroupedMatches::SetPoint(size_t k, int side, const RowPoint& point, double factor, size_t n) {
  double* row = rows_.data() + k;
  row[2 * side * n] = point.p.x();
  row[(2 * side + 1) * n] = point.p.y();
  if (!general_) return;
  row += 4 * n;
  row[side * n] = point.p.z();
  for (int i = 0; i < 6; ++i) row[(2 + 6 * side + i) * n] = factor * point.J(i / 2, i % 2);
}

GroupedMatches GroupedMatches::WithOrigin(const Eigen::Vector3d& origin) const {
  GroupedMatches moved = *this;
  moved.rig_ = rigel::WithOrigin(rig_, origin);
  return moved;
}

std::vector<size_t> GroupedMatches::StretchBegins(size_t count) const {
  const size_t n = matches_.size();
  // floor(i n / count) for i = 0, 1, ..., count; divisions would take longer than all the rest.
  std::vector<size_t> begins(count + 1);
  for (size_t i = 0, k = 0, remainder = 0; i <= count; ++i) {
    begins[i] = k;
    if (i == count) break;
    k += n / count;
    remainder += n % count;
    if (remainder >= count) {
      remainder -= count;
      ++k;
    }
  }
  return begins;
}

GroupedMatches GroupedMatches::EvenSubset(size_t count) const {
  std::vector<size_t> taken = StretchBegins(std::min(count, matches_.size()));
  taken.pop_back();
  return Subset(taken);
}

GroupedMatches GroupedMatches::DrawnSubset(size_t count) const {
  std::vector<size_t> taken = StretchBegins(std::min(count, matches_.size()));
  uint64_t state = 1;
  for (size_t i = 0; i + 1 < taken.size(); ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX
    taken[i] += (state >> 32) * (taken[i + 1] - taken[i]) >> 32;
  }
  taken.pop_back();
  return Subset(taken);
}

GroupedMatches GroupedMatches::Subset(const std::vector<size_t>& taken) const {
  const size_t n = matches_.size(), count = taken.size();
  GroupedMatches subset;
  subset.rig_ = rig_;
  subset.unproject_ = unproject_;
  subset.later_ = later_;
  subset.num_given_ = static_cast<int>(count);
  subset.original_.resize(count);
  std::iota(subset.original_.begin(), subset.original_.end(), 0);
  subset.matches_.reserve(count);
  for (const size_t k : taken) subset.matches_.push_back(matches_[k]);
  if (!landmarks_.empty()) {
    for (const size_t k : taken) subset.landmarks_.push_back(landmarks_[k]);
  }
  subset.general_ = general_;
  const size_t num_arrays = general_ ? 4 + kGeneralArrays : 4;
  subset.rows_.resize(num_arrays * count + kKernelPadding);
  subset.directions_.resize(6 * count + kKernelPadding);
  const auto take = [&](const double* coordinate, double* result) {
    for (size_t i = 0; i < count; ++i) result[i] = coordinate[taken[i]];
  };
  for (size_t c = 0; c < num_arrays; ++c) {
    take(rows_.data() + c * n, subset.rows_.data() + c * count);
  }
  for (int c = 0; c < 6; ++c) {
    take(directions_.data() + c * n, subset.directions_.data() + c * count);
  }
  size_t next = 0;
  for (const MatchGroup& group : groups_) {
    const size_t begin = next;
    const size_t end = static_cast<size_t>(group.begin) + static_cast<size_t>(group.size);
    while (next < count && taken[next] < end) ++next;
    if (next == begin) continue;
    subset.groups_.push_back(
        {group.camera1, group.camera2, static_cast<int>(begin), static_cast<int>(next - begin)});
  }
  return subset;
}

RayPair GroupedMatches::rays(int k) const {
  const size_t n = matches_.size();
  const double* x = directions_.data() + k;
  return {{{x[0], x[n], x[2 * n]}, rig_.cameras[matches_[k].camera1].s},
          {{x[3 * n], x[4 * n], x[5 * n]}, rig_.cameras[matches_[k].camera2].s}};
}

RowArrays GroupedMatches::Rows(const MatchGroup& group) const {
  const double* x1 = rows_.data() + group.begin;
  const size_t n = matches_.size();
  return {x1, x1 + n, x1 + 2 * n, x1 + 3 * n, group.size, general_ ? x1 + 4 * n : nullptr, n};
}

RowPoint GroupedMatches::PointAt(int k, int side) const {
  const double* row = rows_.data() + k;
  const size_t n = matches_.size();
  RowPoint point;
  point.p = {row[2 * side * n], row[(2 * side + 1) * n], 1.0};
  point.J.setIdentity();
  if (!general_) return point;
  row += 4 * n;
  point.p.z() = row[side * n];
  for (int i = 0; i < 6; ++i) point.J(i / 2, i % 2) = row[(2 + 6 * side + i) * n];
  return point;
}

RayArrays GroupedMatches::Directions(const MatchGroup& group) const {
  const double* x1 = directions_.data() + group.begin;
  const size_t n = matches_.size();
  return {x1, x1 + n, x1 + 2 * n, x1 + 3 * n, x1 + 4 * n, x1 + 5 * n};
}

GroupMotion GroupedMatches::MotionOf(const MatchGroup& group, const Pose& pose,
                                     double threshold_px) const {
  GroupMotion motion;
  Eigen::Map<RowMajor3d>(motion.R) = pose.R;
  // Of depths only signs are wanted: that cameras fire at other times hardly changes them.
  Eigen::Map<Eigen::Vector3d>(motion.b) =
      Baseline(pose, rig_.cameras[group.camera1].s, rig_.cameras[group.camera2].s);
  const double min_sin_parallax = DecidedParallax(group, threshold_px);
  motion.min_sin2 = min_sin_parallax * min_sin_parallax;
  return motion;
}

GroupedMatches::Places GroupedMatches::PlacesOf(const MatchGroup& group, const Pose& pose,
                                                bool of_rays) const {
  const RigCamera& c1 = rig_.cameras[group.camera1];
  const RigCamera& c2 = rig_.cameras[group.camera2];
  Places places = {of_rays ? c1.Q : unproject_[group.camera1],
                   of_rays ? c2.Q : unproject_[group.camera2], c1.s, c2.s};
  if (!HasTimes()) return places;
  const Vector6d screw = ScrewOf(pose);
  const Pose part1 = PartOfScrew(screw, -later_[group.camera1]);
  const Pose part2 =
      group.camera1 == group.camera2 ? part1 : PartOfScrew(screw, -later_[group.camera2]);
  return {part1.R * places.A1, part2.R * places.A2, part1 * c1.s, part2 * c2.s};
}

Matrix6d GroupedMatches::PlaceByMotion(int camera, const Pose& pose) const {
  if (later_.empty()) return Matrix6d::Zero();
  const Pose part = PartOfMotion(pose, -later_[camera]);
  Matrix6d by_motion = PartOfMotionJacobian(pose, -later_[camera]);
  // s = R s_k + t of the part.
  by_motion.bottomRows<3>() -=
      (Skew(part.R * rig_.cameras[camera].s) * by_motion.topRows<3>()).eval();
  return by_motion;
}

Eigen::Matrix3d GroupedMatches::Fundamental(const MatchGroup& group, const Pose& pose) const {
  if (HasTimes()) {
    const Places at = PlacesOf(group, pose, false);
    return at.A2.transpose() * Skew(Baseline(pose, at.s1, at.s2)) * pose.R * at.A1;
  }
  // The same, as RANSAC calls it for each hypothesis.
  const Eigen::Vector3d b =
      Baseline(pose, rig_.cameras[group.camera1].s, rig_.cameras[group.camera2].s);
  const Eigen::Matrix3d RA = pose.R * unproject_[group.camera1];
  Eigen::Matrix3d bRA;
  for (int k = 0; k < 3; ++k) bRA.col(k) = b.cross(RA.col(k));
  return unproject_[group.camera2].transpose() * bRA;
}

double GroupedMatches::Score(const Pose& pose, double threshold_px, double bound,
                             int* num_inliers) const {
  if (num_inliers != nullptr) *num_inliers = 0;
  double sum = 0.0;
  for (const MatchGroup& group : groups_) {
    if (sum > bound) break;
    const RowMajor3d F = Fundamental(group, pose);
    sum = TruncatedSampsonSum(Rows(group), F.data(), threshold_px * threshold_px, bound, sum,
                              num_inliers);
  }
  return sum;
}

double GroupedMatches::RadiansPerPixel(const MatchGroup& group) const {
  const Pixel scale1 = rig_.cameras[group.camera1].intrinsics.PixelsPerRadian();
  const Pixel scale2 = rig_.cameras[group.camera2].intrinsics.PixelsPerRadian();
  return 1.0 / std::min(scale1.minCoeff(), scale2.minCoeff());
}

double GroupedMatches::DecidedParallax(const MatchGroup& group, double threshold_px) const {
  return 2.0 * threshold_px * RadiansPerPixel(group);
}

double GroupedMatches::ScoreInFront(const Pose& pose, double threshold_px, double bound,
                                    int* num_inliers) const {
  if (num_inliers != nullptr) *num_inliers = 0;
  double sum = 0.0;
  for (const MatchGroup& group : groups_) {
    if (sum > bound) break;
    const RowMajor3d F = Fundamental(group, pose);
    sum = TruncatedSampsonSumInFront(Rows(group), Directions(group), F.data(),
                                     MotionOf(group, pose, threshold_px),
                                     threshold_px * threshold_px, bound, sum, num_inliers);
  }
  return sum;
}

int GroupedMatches::SelectInliers(const Pose& pose, double threshold_px,
                                  std::vector<double>* errors, std::vector<char>* inliers) const {
  errors->resize(matches_.size());
  inliers->resize(matches_.size());
  int count = 0;
  for (const MatchGroup& group : groups_) {
    const RowMajor3d F = Fundamental(group, pose);
    count += SelectInFront(Rows(group), Directions(group), F.data(),
                           MotionOf(group, pose, threshold_px), threshold_px * threshold_px,
                           errors->data() + group.begin, inliers->data() + group.begin);
  }
  return count;
}

void GroupedMatches::SquaredErrors(const Pose& pose, std::vector<double>* errors) const {
  errors->resize(matches_.size());
  for (const MatchGroup& group : groups_) {
    const RowMajor3d F = Fundamental(group, pose);
    SquaredSampsonErrors(Rows(group), F.data(), errors->data() + group.begin);
  }
}

}  // namespace rigel
