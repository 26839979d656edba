#include "rigel/refine/least_squares/reprojection_cost.h"

#include <cmath>

#include "rigel/core/cheirality.h"
#include "rigel/core/rays.h"

namespace rigel {

ReprojectionCost::ReprojectionCost(const Rig& rig, const Match& match, const Pose& pose,
                                   const MotionBasis& basis, int size, double weight,
                                   const bool* stopped)
    : camera1_(rig.cameras[match.camera1]),
      camera2_(rig.cameras[match.camera2]),
      match_(match),
      pose_(pose),
      basis_(basis),
      weight_(weight),
      stopped_(stopped) {
  set_num_residuals(4);
  mutable_parameter_block_sizes()->push_back(size);
  mutable_parameter_block_sizes()->push_back(3);
}

ReprojectionCost::Point ReprojectionCost::Triangulate(const Rig& rig, const Match& match,
                                                      const Pose& pose) {
  const RayPair rays = MakeRayPair(rig, match);
  Depths depths;
  if (!TriangulateDepths(pose, rays, &depths) || !depths.BothPositive()) return {0.0, 0.0, 0.0};
  const double ray_length = rig.cameras[match.camera1].intrinsics.Normalize(match.pixel1).norm();
  const double rho = ray_length / depths.d1;
  return {0.0, 0.0, std::isfinite(rho) ? rho : 0.0};
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  if (stopped_ != nullptr && *stopped_) return false;
  const double du = parameters[1][0];
  const double dv = parameters[1][1];
  const double rho = parameters[1][2];
  const PinholeCamera& c1 = camera1_.intrinsics;
  const PinholeCamera& c2 = camera2_.intrinsics;
  const Eigen::Matrix3d RQ = pose_.R * camera1_.Q;
  const Eigen::Vector3d Rs = pose_.R * camera1_.s;
  const Eigen::Vector3d b = Rs + pose_.t - camera2_.s;
  const Eigen::Vector3d turned = RQ * c1.Normalize(match_.pixel1 + Eigen::Vector2d(du, dv));
  // rho times the point in camera 2.
  const Eigen::Vector3d y = camera2_.Q.transpose() * (turned + rho * b);
  // A point in the plane of the camera has no image. Ceres then rejects the step.
  if (!(std::abs(y.z()) > 1e-12)) return false;
  const Eigen::Vector2d projected = c2.Project(y);
  residuals[0] = weight_ * du;
  residuals[1] = weight_ * dv;
  residuals[2] = weight_ * (projected.x() - match_.pixel2.x());
  residuals[3] = weight_ * (projected.y() - match_.pixel2.y());
  if (jacobians == nullptr) return true;

  Eigen::Matrix<double, 2, 3> by_body;  // of the projection by rho times the point in f2
  by_body << c2.fx / y.z(), 0.0, -c2.fx * y.x() / (y.z() * y.z()),  //
      0.0, c2.fy / y.z(), -c2.fy * y.y() / (y.z() * y.z());
  by_body *= weight_ * camera2_.Q.transpose();
  if (jacobians[0] != nullptr) {
    const int size = static_cast<int>(basis_.cols());
    Eigen::Map<Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], 4, size);
    J.topRows<2>().setZero();
    for (int m = 0; m < size; ++m) {
      const Eigen::Vector3d w = basis_.block<3, 1>(0, m);
      J.block<2, 1>(2, m) =
          by_body * (w.cross(turned) + rho * (w.cross(Rs) + basis_.block<3, 1>(3, m)));
    }
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> J(jacobians[1]);
    J.topRows<2>() << weight_, 0.0, 0.0, 0.0, weight_, 0.0;
    J.block<2, 1>(2, 0) = by_body * RQ.col(0) / c1.fx;
    J.block<2, 1>(2, 1) = by_body * RQ.col(1) / c1.fy;
    J.block<2, 1>(2, 2) = by_body * b;
  }
  return true;
}

}  // namespace rigel
