#include "rigel/refine/least_squares/epipolar_residuals.h"

#include <cmath>

#include "rigel/refine/least_squares/fundamental_derivatives.h"
#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {

void LinearizeGroups(const GroupedMatches& matches, ResidualKind kind, const Pose& pose,
                     const MotionBasis* basis, std::vector<GroupLinearization>* groups) {
  groups->resize(matches.groups().size());
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    GroupLinearization& linear = (*groups)[g];
    const bool of_rays = kind != ResidualKind::kSampson;
    linear.F = FundamentalOf(matches, group, pose, of_rays);
    linear.rounding2 = Rounding2(linear.F);
    if (basis == nullptr) continue;
    const Eigen::Matrix<double, 9, Eigen::Dynamic, Eigen::ColMajor, 9, 6> by_parameters =
        FundamentalByMotion(matches, group, pose, of_rays) * *basis;
    for (int m = 0; m < basis->cols(); ++m) {
      linear.dF[m] = Eigen::Map<const RowMajor3d>(by_parameters.col(m).data());
    }
  }
}

EpipolarResiduals::EpipolarResiduals(const GroupedMatches& matches, ResidualKind kind)
    : matches_(&matches), kind_(kind) {
  const int n = matches.size();
  group_of_.resize(n);
  p1_.resize(n);
  p2_.resize(n);
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    const Camera& c1 = matches.rig().cameras[group.camera1].intrinsics;
    const Camera& c2 = matches.rig().cameras[group.camera2].intrinsics;
    const Pixel scale1 = c1.PixelsPerRadian(), scale2 = c2.PixelsPerRadian();
    weight_.push_back(kind == ResidualKind::kAngular
                          ? 0.25 * (scale1.x() + scale1.y() + scale2.x() + scale2.y())
                          : 1.0);
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      const Match& m = matches.matches()[k];
      group_of_[k] = static_cast<int>(g);
      if (kind == ResidualKind::kSampson) {
        p1_[k] = matches.Point1(k);
        p2_[k] = matches.Point2(k);
      } else {
        p1_[k].p = AlongRay(c1, m.pixel1).normalized();
        p2_[k].p = AlongRay(c2, m.pixel2).normalized();
      }
    }
  }
}

double EpipolarResiduals::Evaluate(const std::vector<GroupLinearization>& groups, int k,
                                   int num_parameters, double* jacobian, int stride) const {
  const int g = group_of_[k];
  const GroupLinearization& linear = groups[g];
  const Eigen::Vector3d& p1 = p1_[k].p;
  const Eigen::Vector3d& p2 = p2_[k].p;
  Eigen::Vector3d A = linear.F * p1;
  Eigen::Vector3d B = linear.F.transpose() * p2;
  const double C = p2.dot(A);

  // dr/dF = u p1' - v B': for the algebraic residual that is p2 p1'.
  double r = C;
  Eigen::Vector3d u = p2;
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  if (kind_ != ResidualKind::kAlgebraic) {
    double gradient2;
    double size = p1.squaredNorm() + p2.squaredNorm();
    if (kind_ == ResidualKind::kSampson) {
      const UnalignedMatrix<3, 2>& J1 = p1_[k].J;
      const UnalignedMatrix<3, 2>& J2 = p2_[k].J;
      const Eigen::Vector2d a = J2.transpose() * A;
      const Eigen::Vector2d b = J1.transpose() * B;
      gradient2 = a.squaredNorm() + b.squaredNorm();
      size = 0.5 * (p1.squaredNorm() * J2.squaredNorm() + p2.squaredNorm() * J1.squaredNorm());
      A = J2 * a;
      B = J1 * b;
    } else {
      // Tangent parts: p2.A = p1.B = C.
      A -= C * p2;
      B -= C * p1;
      gradient2 = A.squaredNorm() + B.squaredNorm();
    }
    if (!(gradient2 > linear.rounding2 * size) || !std::isfinite(gradient2)) {
      for (int m = 0; m < num_parameters && jacobian != nullptr; ++m) jacobian[m * stride] = 0.0;
      return 0.0;
    }
    // d(gradient^2)/2 = A.(dF p1) + B.(dF'p2) for both kinds.
    const double w = weight_[g] / std::sqrt(gradient2);
    const double s = C / gradient2;
    r = w * C;
    u = w * (p2 - s * A);
    v = w * s * p2;
  }
  if (jacobian != nullptr) {
    const Eigen::Matrix3d dr_dF = u * p1.transpose() - v * B.transpose();
    for (int m = 0; m < num_parameters; ++m) {
      jacobian[m * stride] = dr_dF.cwiseProduct(linear.dF[m]).sum();
    }
  }
  return r;
}

}  // namespace rigel
