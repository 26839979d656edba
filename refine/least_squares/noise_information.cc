#include "rigel/refine/least_squares/noise_information.h"

#include <algorithm>
#include <cmath>

#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {

namespace {

// Entries of a 3 x 3 matrix, column by column.
using Entries = Eigen::Matrix<double, 9, 1>;

// A match's error r = f C, f = 1 / |dC/dp|, and dr/dF = f (u p1' - v B').
struct Terms {
  Eigen::Vector2d a, b;  // J2'F p1 = dC/d(pixel2) and J1'F'p2 = dC/d(pixel1)
  Eigen::Vector3d A, B;  // J2 a and J1 b
  Eigen::Vector3d u, v;
  double gradient2, f, m;
  Entries outer;
};

void SetOuter(const Eigen::Vector3d& u, const Eigen::Vector3d& p1, Entries* outer) {
  for (int j = 0; j < 3; ++j) outer->segment<3>(3 * j) = p1[j] * u;
}

void SubtractOuter(const Eigen::Vector3d& v, const Eigen::Vector3d& B, Entries* outer) {
  for (int j = 0; j < 3; ++j) outer->segment<3>(3 * j) -= B[j] * v;
}

bool SetTerms(const GroupLinearization& linear, const RowPoint& point1, const RowPoint& point2,
              Terms* t) {
  const Eigen::Vector3d& p1 = point1.p;
  const Eigen::Vector3d& p2 = point2.p;
  const Eigen::Vector3d Fp1 = linear.F * p1;
  const double C = p2.dot(Fp1);
  t->a.noalias() = point2.J.transpose() * Fp1;
  t->b.noalias() = point1.J.transpose() * (linear.F.transpose() * p2);
  t->A.noalias() = point2.J * t->a;
  t->B.noalias() = point1.J * t->b;
  t->gradient2 = t->a.squaredNorm() + t->b.squaredNorm();
  const double size =
      0.5 * (p1.squaredNorm() * point2.J.squaredNorm() + p2.squaredNorm() * point1.J.squaredNorm());
  if (!(t->gradient2 > linear.rounding2 * size) || !std::isfinite(t->gradient2)) return false;
  t->f = 1.0 / std::sqrt(t->gradient2);
  t->m = C / t->gradient2;
  t->u = p2 - t->m * t->A;
  t->v = t->m * p2;
  SetOuter(t->u, p1, &t->outer);
  SubtractOuter(t->v, t->B, &t->outer);
  return true;
}

// The derivatives of F's entries by the motion.
Eigen::Map<const Eigen::Matrix<double, 9, 6>> ByMotion(const GroupLinearization& linear) {
  return Eigen::Map<const Eigen::Matrix<double, 9, 6>>(linear.dF[0].data());
}

// dJ/dp over f, where J is dr/d(motion): by the coordinates u1, v1, u2, v2.
Eigen::Matrix<double, 6, 4> ByMotionAndPixels(const GroupLinearization& linear,
                                              const RowPoint& point1, const RowPoint& point2,
                                              const Terms& t) {
  const Eigen::Matrix3d& F = linear.F;
  Eigen::Matrix<double, 9, 4> d_outer;
  for (int c = 0; c < 2; ++c) {
    // With p1, A changes, B does not.
    const Eigen::Vector3d d_p1 = point1.J.col(c);
    const Eigen::Vector3d Fd = F * d_p1;
    const Eigen::Vector3d d_A = point2.J * (point2.J.transpose() * Fd);
    const double shrink = t.A.dot(Fd) / t.gradient2;
    const double d_m = t.b[c] / t.gradient2 - 2.0 * t.m * shrink;
    Entries d, moved;
    SetOuter(-d_m * t.A - t.m * d_A, point1.p, &d);
    SetOuter(t.u, d_p1, &moved);
    d += moved;
    SubtractOuter(d_m * point2.p, t.B, &d);
    d_outer.col(c) = d - shrink * t.outer;
  }
  for (int c = 0; c < 2; ++c) {
    // With p2, B changes, A does not.
    const Eigen::Vector3d d_p2 = point2.J.col(c);
    const Eigen::Vector3d Fd = F.transpose() * d_p2;
    const Eigen::Vector3d d_B = point1.J * (point1.J.transpose() * Fd);
    const double shrink = t.B.dot(Fd) / t.gradient2;
    const double d_m = t.a[c] / t.gradient2 - 2.0 * t.m * shrink;
    Entries d;
    SetOuter(d_p2 - d_m * t.A, point1.p, &d);
    SubtractOuter(d_m * point2.p + t.m * d_p2, t.B, &d);
    SubtractOuter(t.v, d_B, &d);
    d_outer.col(2 + c) = d - shrink * t.outer;
  }
  return ByMotion(linear).transpose().lazyProduct(d_outer);
}

void SetFirst(const GroupLinearization& linear, const Terms& t, SampsonRow* row) {
  row->by_motion = t.f * ByMotion(linear).transpose().lazyProduct(t.outer);
  row->gradient << t.f * t.b, t.f * t.a;
  row->residual = t.f * t.m * t.gradient2;
}

}  // namespace

bool DifferentiateSampsonOnce(const GroupLinearization& linear, const RowPoint& point1,
                              const RowPoint& point2, SampsonRow* row) {
  Terms t;
  if (!SetTerms(linear, point1, point2, &t)) return false;
  SetFirst(linear, t, row);
  return true;
}

bool DifferentiateByFundamental(const GroupLinearization& linear, const RowPoint& point1,
                                const RowPoint& point2, double* residual,
                                UnalignedMatrix<9>* by_F) {
  Terms t;
  if (!SetTerms(linear, point1, point2, &t)) return false;
  *residual = t.f * t.m * t.gradient2;
  *by_F = t.f * t.outer;
  return true;
}

bool DifferentiateSampson(const GroupLinearization& linear, const RowPoint& point1,
                          const RowPoint& point2, SampsonRow* row) {
  Terms t;
  if (!SetTerms(linear, point1, point2, &t)) return false;
  SetFirst(linear, t, row);
  row->by_motion_and_pixels = t.f * ByMotionAndPixels(linear, point1, point2, t);
  return true;
}

Matrix6d NoiseInformation(const GroupLinearization& linear, const GroupedMatches& matches,
                          const MatchGroup& group, const double* weights, int max_matches) {
  const auto used = group.size - std::count(weights, weights + group.size, 0.0);
  const auto stride = std::max<long>(1, (used + max_matches - 1) / max_matches);
  Matrix6d sum = Matrix6d::Zero();
  Terms t;
  long seen = 0;
  double sampled = 0.0, all = 0.0;
  for (int i = 0; i < group.size; ++i) {
    const double w = weights[i];
    if (w == 0.0) continue;
    all += w * w;
    if (seen++ % stride != 0) continue;
    sampled += w * w;
    const RowPoint point1 = matches.Point1(group.begin + i);
    const RowPoint point2 = matches.Point2(group.begin + i);
    if (!SetTerms(linear, point1, point2, &t)) continue;
    const Eigen::Matrix<double, 6, 4> by_both =
        (w * t.f) * ByMotionAndPixels(linear, point1, point2, t);
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
    sum += NoiseInformation(groups[g], matches, group, weights.data() + group.begin,
                            std::max(group.size, 1));
  }
  return sum;
}

}  // namespace rigel
