#include "rigel/refine/least_squares/reprojection_cost.h"

#include <cmath>

#include "rigel/core/cheirality.h"
#include "rigel/core/rays.h"
#include "rigel/core/row_point.h"

namespace rigel {

namespace {

// The image of X and its derivative. A pinhole's formula also has one for points behind it: their
// errors are finite, and a step towards them is compared with others.
bool ImageOf(const Camera& camera, const Eigen::Vector3d& X, Pixel* pixel, Matrix2x3d* J) {
  if (!camera.IsPinhole()) return Project(camera, X, pixel, J);
  if (!(std::abs(X.z()) > 1e-12)) return false;
  const double fx = camera.fx(), fy = camera.fy(), z2 = X.z() * X.z();
  *pixel = {fx * X.x() / X.z() + camera.cx(), fy * X.y() / X.z() + camera.cy()};
  *J << fx / X.z(), 0.0, -fx * X.x() / z2,  //
      0.0, fy / X.z(), -fy * X.y() / z2;
  return true;
}

}  // namespace

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
  const double ray_length = AlongRay(rig.cameras[match.camera1].intrinsics, match.pixel1).norm();
  const double rho = ray_length / depths.d1;
  return {0.0, 0.0, std::isfinite(rho) ? rho : 0.0};
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  if (stopped_ != nullptr && *stopped_) return false;
  const double du = parameters[1][0];
  const double dv = parameters[1][1];
  const double rho = parameters[1][2];
  const Eigen::Matrix3d RQ = pose_.R * camera1_.Q;
  const Eigen::Vector3d Rs = pose_.R * camera1_.s;
  const Eigen::Vector3d b = Rs + pose_.t - camera2_.s;
  const RowPoint ray = RayPointOf(camera1_, match_.pixel1 + Eigen::Vector2d(du, dv));
  const Eigen::Vector3d turned = RQ * ray.p;
  // rho times the point in camera 2.
  const Eigen::Vector3d y = camera2_.Q.transpose() * (turned + rho * b);
  // Where there is no image, or no ray, Ceres rejects the step.
  Pixel projected;
  Matrix2x3d by_y;
  if (!y.allFinite() || !ImageOf(camera2_.intrinsics, y, &projected, &by_y)) return false;
  residuals[0] = weight_ * du;
  residuals[1] = weight_ * dv;
  residuals[2] = weight_ * (projected.x() - match_.pixel2.x());
  residuals[3] = weight_ * (projected.y() - match_.pixel2.y());
  if (jacobians == nullptr) return true;

  // By rho times the point in f2.
  const Eigen::Matrix<double, 2, 3> by_body = weight_ * by_y * camera2_.Q.transpose();
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
    J.block<2, 2>(2, 0) = by_body * RQ * ray.J;
    J.block<2, 1>(2, 2) = by_body * b;
  }
  return true;
}

}  // namespace rigel
