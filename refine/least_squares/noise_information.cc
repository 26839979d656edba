#include "rigel/refine/least_squares/noise_information.h"

#include <cmath>

#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {

bool DifferentiateSampson(const GroupLinearization& linear, const Eigen::Vector3d& p1,
                          const Eigen::Vector3d& p2, SampsonRow* row) {
  const Eigen::Matrix3d& F = linear.F;
  // dC/dp2 and dC/dp1; the third entries are no pixel coordinates.
  Eigen::Vector3d a = F * p1;
  const double C = p2.dot(a);
  Eigen::Vector3d b = F.transpose() * p2;
  a.z() = b.z() = 0.0;
  const double gradient2 = a.squaredNorm() + b.squaredNorm();
  if (!(gradient2 > linear.rounding2 * (p1.squaredNorm() + p2.squaredNorm())) ||
      !std::isfinite(gradient2)) {
    return false;
  }
  // As in epipolar_residuals.cc: dr/dF = f (u p1' - v b').
  const double f = 1.0 / std::sqrt(gradient2);
  const double m = C / gradient2;
  const Eigen::Vector3d u = p2 - m * a;
  const Eigen::Vector3d v = m * p2;
  const Eigen::Matrix3d outer = u * p1.transpose() - v * b.transpose();
  for (int k = 0; k < 6; ++k) row->by_motion[k] = f * outer.cwiseProduct(linear.dF[k]).sum();
  row->gradient << f * b.x(), f * b.y(), f * a.x(), f * a.y();
  for (int c = 0; c < 4; ++c) {
    // Of all of the above by the coordinate c.
    Eigen::Vector3d d_p1 = Eigen::Vector3d::Zero(), d_p2 = d_p1, d_a = d_p1, d_b = d_p1;
    if (c < 2) {
      d_p1[c] = 1.0;
      d_a.head<2>() = F.block<2, 1>(0, c);
    } else {
      d_p2[c - 2] = 1.0;
      d_b.head<2>() = F.block<1, 2>(c - 2, 0);
    }
    const double d_C = c < 2 ? b[c] : a[c - 2];
    const double shrink = (a.dot(d_a) + b.dot(d_b)) / gradient2;
    const double d_m = d_C / gradient2 - 2.0 * m * shrink;
    const Eigen::Vector3d d_u = d_p2 - d_m * a - m * d_a;
    const Eigen::Vector3d d_v = d_m * p2 + m * d_p2;
    const Eigen::Matrix3d d_outer = d_u * p1.transpose() + u * d_p1.transpose() -
                                    d_v * b.transpose() - v * d_b.transpose() - shrink * outer;
    for (int k = 0; k < 6; ++k) {
      row->by_motion_and_pixels(k, c) = f * d_outer.cwiseProduct(linear.dF[k]).sum();
    }
  }
  return true;
}

Matrix6d NoiseInformation(const GroupedMatches& matches, const std::vector<double>& weights,
                          const Pose& pose) {
  const MotionBasis basis = FullBasis(pose, true);
  std::vector<GroupLinearization> groups;
  LinearizeGroups(matches, ResidualKind::kSampson, pose, &basis, &groups);
  Matrix6d sum = Matrix6d::Zero();
  SampsonRow row;
  for (size_t g = 0; g < groups.size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    const PixelArrays pixels = matches.Pixels(group);
    for (int i = 0; i < group.size; ++i) {
      const double w = weights[group.begin + i];
      if (w == 0.0 || !DifferentiateSampson(groups[g], {pixels.x1[i], pixels.y1[i], 1.0},
                                            {pixels.x2[i], pixels.y2[i], 1.0}, &row)) {
        continue;
      }
      const UnalignedMatrix<6, 4> weighted = w * row.by_motion_and_pixels;
      sum.noalias() += weighted * weighted.transpose();
    }
  }
  return sum;
}

}  // namespace rigel
