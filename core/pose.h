// Rigid motion of the body between the two moments, and the rotation group SO(3).
//
// Conventions of the whole library (docs/conventions.md):
//   X_2 = R X_1 + t     body frame f1 at time 1, f2 at time 2; metres
//   perturbation        R <- Exp(d) R (left, radians), t <- t + e (metres), rotation first
//   quaternions         w x y z (Hamilton) in files
#ifndef RIGEL_CORE_POSE_H_
#define RIGEL_CORE_POSE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/core/eigen_types.h"

namespace rigel {

// f2_from_f1: X_2 = R X_1 + t. Invariant: R is a rotation (R'R = I, det R = 1).
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  // q need not be of unit length; it must not be zero.
  static Pose FromQuaternion(const UnalignedQuaternion& q, const Eigen::Vector3d& t);

  // Unit quaternion with w >= 0.
  UnalignedQuaternion Quaternion() const;

  Pose Inverse() const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& X) const { return R * X + t; }

  bool AllFinite() const { return R.allFinite() && t.allFinite(); }
};
static_assert(kSameLayoutEverywhere<Pose>, "no member of Pose may be aligned");

// c_from_a = c_from_b * b_from_a.
Pose operator*(const Pose& c_from_b, const Pose& b_from_a);

// True if R is finite and a rotation: R'R = I to 1e-6, det R > 0.
bool IsRotation(const Eigen::Matrix3d& R);

// [v]x, so that Skew(v) * w = v x w.
Eigen::Matrix3d Skew(const Eigen::Vector3d& v);

// Rotation about Y by `angle` (paper eq. d1).
Eigen::Matrix3d RotationY(double angle);

// Rotation vector (axis times angle, radians) to rotation matrix and back. Accurate near zero;
// Log is accurate near pi too, where it returns one of the two equivalent vectors.
Eigen::Matrix3d ExpSO3(const Eigen::Vector3d& omega);
Eigen::Vector3d LogSO3(const Eigen::Matrix3d& R);

// Left Jacobian: ExpSO3(omega + d) = ExpSO3(J d) ExpSO3(omega) to first order in d.
Eigen::Matrix3d LeftJacobianSO3(const Eigen::Vector3d& omega);

// The share of a motion with constant velocity: the angular velocity and that of the origin are
// constant in the body's own frame, so the body moves on a screw. 1 is all of it, 0 none; it may be
// negative. Parts of one motion commute.
Pose PartOfMotion(const Pose& motion, double share);

// The same in two steps, for several parts of one motion: the screw, rotation vector first.
Vector6d ScrewOf(const Pose& motion);
Pose PartOfScrew(const Vector6d& screw, double share);

// The perturbation (d, e) of that part by the perturbation of the motion, for R <- Exp(d) R,
// t <- t + e of both.
Matrix6d PartOfMotionJacobian(const Pose& motion, double share);

// The smallest rotation M with M a = b for unit vectors a, b; for b = -a a half turn about some
// axis perpendicular to a.
Eigen::Matrix3d SmallestRotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// Two unit vectors that complete the unit vector v to a right-handed orthonormal basis, as the
// columns of a 3x2 matrix. A continuous choice is not promised.
Matrix3x2d TangentBasis(const Eigen::Vector3d& v);

}  // namespace rigel

#endif  // RIGEL_CORE_POSE_H_
