#include "rigel/core/rig_centre.h"

#include <cmath>

namespace rigel {

Eigen::Vector3d RigCentre(const Rig& rig) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (rig.cameras.empty()) return sum;
  // From the first camera on: of positions far from the origin only differences are exact.
  const Eigen::Vector3d first = rig.cameras[0].s;
  for (const RigCamera& camera : rig.cameras) sum += camera.s - first;
  return first + sum / static_cast<double>(rig.size());
}

Rig WithOrigin(const Rig& rig, const Eigen::Vector3d& origin) {
  Rig moved = rig;
  for (RigCamera& camera : moved.cameras) camera.s -= origin;
  return moved;
}

Pose MotionOfPoint(const Pose& body, const Eigen::Vector3d& point) {
  return {body.R, body.t + (body.R * point - point)};
}

Pose MotionOfBody(const Pose& of_point, const Eigen::Vector3d& point) {
  return MotionOfPoint(of_point, -point);
}

Matrix6d BodyFromPointJacobian(const Eigen::Matrix3d& R, const Eigen::Vector3d& point) {
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.block<3, 3>(3, 0) = Skew(R * point);
  return jacobian;
}

Pose WithBodyLength(const Pose& body, const Eigen::Vector3d& point, double length) {
  const Eigen::Vector3d b = MotionOfPoint(body, point).t;
  const double norm = b.norm();
  if (!(norm > 0)) return body;
  // |l d + a| = length for the direction d of b and a = c - R c.
  const Eigen::Vector3d d = b / norm;
  const Eigen::Vector3d a = point - body.R * point;
  const double along = d.dot(a);
  const double root2 = along * along + length * length - a.squaredNorm();
  const double of_b = root2 > 0 ? std::sqrt(root2) - along : 0.0;
  return MotionOfBody({body.R, (of_b > 0 ? of_b : length) * d}, point);
}

}  // namespace rigel
