#include "rigel/refine/least_squares/normal_equations.h"

#include <limits>

#include <Eigen/Geometry>

namespace rigel {
namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// Returns the group's F, and fills its derivatives.
RowMajor3d Differentiate(const GroupedMatches& matches, const MatchGroup& group, const Pose& pose,
                         FundamentalDerivatives* D) {
  const RigCamera& c1 = matches.rig().cameras[group.camera1];
  const RigCamera& c2 = matches.rig().cameras[group.camera2];
  const Eigen::Vector3d Rs = pose.R * c1.s;
  const Eigen::Vector3d b = Rs + pose.t - c2.s;
  const Eigen::Matrix3d right = pose.R * matches.UnprojectionToBody(group.camera1);
  const Eigen::Matrix3d& left = matches.UnprojectionToBody(group.camera2);
  RowMajor3d F;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d l = left.col(i);
    const Eigen::Vector3d lb = l.cross(b);
    for (int j = 0; j < 3; ++j) {
      // F_ij = l.(b x r); r depends on R, b on R and t.
      const Eigen::Vector3d r = right.col(j);
      const Eigen::Vector3d rl = r.cross(l);
      const Eigen::Vector3d by_w = Rs.cross(rl) + r.cross(lb);
      F(i, j) = b.dot(rl);
      double* d = D->d[3 * i + j];
      for (int k = 0; k < 3; ++k) {
        d[k] = by_w[k];
        d[3 + k] = rl[k];
      }
      d[6] = d[7] = 0.0;
    }
  }
  return F;
}

// Times |p|^2 |J|^2: the rounding error of a squared gradient of zero.
double Rounding2(const RowMajor3d& F) {
  constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();
  return kRounding * kRounding * F.squaredNorm();
}

}  // namespace

void AddNormalEquations(const SampsonKernelOptions& options, const GroupedMatches& matches,
                        const MatchGroup& group, const RowArrays& rows, const double* weights,
                        const Pose& pose, SampsonParts parts, MotionNormalEquations* sum) {
  FundamentalDerivatives D;
  const RowMajor3d F = Differentiate(matches, group, pose, &D);
  SampsonSums sums;
  SumSampson(options, rows, weights, F.data(), Rounding2(F), parts, &sums);
  sum->cost += sums.cost;
  if (parts == SampsonParts::kAll) {
    AddProjected(sums, D, sum->gradient.data(), sum->curvature.data());
  } else if (parts == SampsonParts::kGradient) {
    for (int i = 0; i < 9; ++i) {
      sum->gradient += sums.g[i] * Eigen::Map<const Vector6d>(D.d[i]);
    }
  }
}

void Leverages(const GroupedMatches& matches, const MatchGroup& group, const Pose& pose,
               const double* weights, const Matrix6d& covariance, double* leverages) {
  FundamentalDerivatives D;
  const RowMajor3d F = Differentiate(matches, group, pose, &D);
  const Eigen::Map<const Eigen::Matrix<double, 9, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<8>>
      by_motion(D.d[0]);
  const Eigen::Matrix<double, 9, 9> C = by_motion * covariance * by_motion.transpose();
  SampsonLeverages(matches.Rows(group), weights, F.data(), C.data(), Rounding2(F), leverages);
}

}  // namespace rigel
