#include "rigel/refine/least_squares/noise_information.h"

#include <algorithm>
#include <cmath>

#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {

namespace {

// Entries of a 3 x 3 matrix, column by column.
using Entries = Eigen::Matrix<double, 9, 1>;

// A match's error r = f C, f = 1 / |dC/dp|, and dr/dF = f (u p1' - v b').
struct Terms {
  Eigen::Vector3d a, b;  // dC/dp2 and dC/dp1; the third entries are no pixel coordinates: 0
  Eigen::Vector3d u, v;
  double gradient2, f, m;
  Entries outer;
};

void SetOuter(const Eigen::Vector3d& u, const Eigen::Vector3d& p1, Entries* outer) {
  for (int j = 0; j < 3; ++j) outer->segment<3>(3 * j) = p1[j] * u;
}

bool SetTerms(const GroupLinearization& linear, const Eigen::Vector3d& p1,
              const Eigen::Vector3d& p2, Terms* t) {
  t->a.noalias() = linear.F * p1;
  const double C = p2.dot(t->a);
  t->b.noalias() = linear.F.transpose() * p2;
  t->a.z() = t->b.z() = 0.0;
  t->gradient2 = t->a.squaredNorm() + t->b.squaredNorm();
  if (!(t->gradient2 > linear.rounding2 * (p1.squaredNorm() + p2.squaredNorm())) ||
      !std::isfinite(t->gradient2)) {
    return false;
  }
  t->f = 1.0 / std::sqrt(t->gradient2);
  t->m = C / t->gradient2;
  t->u = p2 - t->m * t->a;
  t->v = t->m * p2;
  SetOuter(t->u, p1, &t->outer);
  for (int j = 0; j < 2; ++j) t->outer.segment<3>(3 * j) -= t->b[j] * t->v;
  return true;
}

// The derivatives of F's entries by the motion.
Eigen::Map<const Eigen::Matrix<double, 9, 6>> ByMotion(const GroupLinearization& linear) {
  return Eigen::Map<const Eigen::Matrix<double, 9, 6>>(linear.dF[0].data());
}

// dJ/dp over f, where J is dr/d(motion): by the coordinates u1, v1, u2, v2.
Eigen::Matrix<double, 6, 4> ByMotionAndPixels(const GroupLinearization& linear,
                                              const Eigen::Vector3d& p1, const Eigen::Vector3d& p2,
                                              const Terms& t) {
  const Eigen::Matrix3d& F = linear.F;
  Eigen::Matrix<double, 9, 4> d_outer;
  for (int c = 0; c < 4; ++c) {
    Entries d;
    const bool first = c < 2;
    const int k = first ? c : c - 2;
    // Of a or b, of p1 or p2.
    const Eigen::Vector3d d_ab =
        first ? Eigen::Vector3d(F(0, k), F(1, k), 0.0) : Eigen::Vector3d(F(k, 0), F(k, 1), 0.0);
    const double d_C = first ? t.b[k] : t.a[k];
    const double shrink = (first ? t.a : t.b).dot(d_ab) / t.gradient2;
    const double d_m = d_C / t.gradient2 - 2.0 * t.m * shrink;
    Eigen::Vector3d d_u = -d_m * t.a;
    Eigen::Vector3d d_v = d_m * p2;
    if (first) {
      d_u -= t.m * d_ab;
    } else {
      d_u[k] += 1.0;
      d_v[k] += t.m;
    }
    SetOuter(d_u, p1, &d);
    if (first) d.segment<3>(3 * k) += t.u;
    for (int j = 0; j < 2; ++j) {
      d.segment<3>(3 * j) -= t.b[j] * d_v;
      if (!first) d.segment<3>(3 * j) -= d_ab[j] * t.v;
    }
    d_outer.col(c) = d - shrink * t.outer;
  }
  return ByMotion(linear).transpose().lazyProduct(d_outer);
}

void SetFirst(const GroupLinearization& linear, const Terms& t, SampsonRow* row) {
  row->by_motion = t.f * ByMotion(linear).transpose().lazyProduct(t.outer);
  row->gradient << t.f * t.b.x(), t.f * t.b.y(), t.f * t.a.x(), t.f * t.a.y();
  row->residual = t.f * t.m * t.gradient2;
}

}  // namespace

bool DifferentiateSampsonOnce(const GroupLinearization& linear, const Eigen::Vector3d& p1,
                              const Eigen::Vector3d& p2, SampsonRow* row) {
  Terms t;
  if (!SetTerms(linear, p1, p2, &t)) return false;
  SetFirst(linear, t, row);
  return true;
}

bool DifferentiateSampson(const GroupLinearization& linear, const Eigen::Vector3d& p1,
                          const Eigen::Vector3d& p2, SampsonRow* row) {
  Terms t;
  if (!SetTerms(linear, p1, p2, &t)) return false;
  SetFirst(linear, t, row);
  row->by_motion_and_pixels = t.f * ByMotionAndPixels(linear, p1, p2, t);
  return true;
}

Matrix6d NoiseInformation(const GroupLinearization& linear, const PixelArrays& pixels,
                          const double* weights, int max_matches) {
  const auto used = pixels.size - std::count(weights, weights + pixels.size, 0.0);
  const auto stride = std::max<long>(1, (used + max_matches - 1) / max_matches);
  Matrix6d sum = Matrix6d::Zero();
  Terms t;
  long seen = 0;
  double sampled = 0.0, all = 0.0;
  for (int i = 0; i < pixels.size; ++i) {
    const double w = weights[i];
    if (w == 0.0) continue;
    all += w * w;
    if (seen++ % stride != 0) continue;
    sampled += w * w;
    const Eigen::Vector3d p1(pixels.x1[i], pixels.y1[i], 1.0);
    const Eigen::Vector3d p2(pixels.x2[i], pixels.y2[i], 1.0);
    if (!SetTerms(linear, p1, p2, &t)) continue;
    const Eigen::Matrix<double, 6, 4> by_both = (w * t.f) * ByMotionAndPixels(linear, p1, p2, t);
    sum += by_both.lazyProduct(by_both.transpose());
  }
  return sampled > 0 ? Matrix6d(sum * (all / sampled)) : sum;
}

Matrix6d NoiseInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                          const Pose& pose) {
  const MotionBasis basis = FullBasis(pose, true);
  std::vector<GroupLinearization> groups;
  LinearizeGroups(matches, ResidualKind::kSampson, pose, &basis, &groups);
  Matrix6d sum = Matrix6d::Zero();
  for (size_t g = 0; g < groups.size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    sum += NoiseInformation(groups[g], matches.Pixels(group), weights.data() + group.begin,
                            std::max(group.size, 1));
  }
  return sum;
}

}  // namespace rigel
