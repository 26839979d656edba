#include "rigel/core/pose.h"

#include <cmath>

#include <Eigen/LU>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

// Radians, below which the series of sin(x/2)/x and atan2(x, w)/x are exact to rounding.
constexpr double kSmallAngle = 1e-6;

}  // namespace

Pose Pose::FromQuaternion(const UnalignedQuaternion& q, const Eigen::Vector3d& t) {
  Pose pose;
  pose.R = q.normalized().toRotationMatrix();
  pose.t = t;
  return pose;
}

UnalignedQuaternion Pose::Quaternion() const {
  UnalignedQuaternion q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

Pose Pose::Inverse() const {
  Pose inverse;
  inverse.R = R.transpose();
  inverse.t = -(inverse.R * t);
  return inverse;
}

Pose operator*(const Pose& c_from_b, const Pose& b_from_a) {
  Pose c_from_a;
  c_from_a.R = c_from_b.R * b_from_a.R;
  c_from_a.t = c_from_b.R * b_from_a.t + c_from_b.t;
  return c_from_a;
}

bool IsRotation(const Eigen::Matrix3d& R) {
  // Of the norm of R'R - I: what files with seven digits keep.
  constexpr double kMaxError = 1e-6;
  const Eigen::Matrix3d RtR = R.transpose() * R;
  return R.allFinite() && (RtR - Eigen::Matrix3d::Identity()).norm() < kMaxError &&
         !(R.determinant() < 0);
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d RotationY(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  Eigen::Matrix3d R;
  R << c, 0, s, 0, 1, 0, -s, 0, c;
  return R;
}

Eigen::Matrix3d ExpSO3(const Eigen::Vector3d& omega) {
  // Through the unit quaternion: exactly orthonormal for any angle. sin(x/2)/x by its series
  // where the quotient would lose digits.
  const double angle = omega.norm();
  const double half = 0.5 * angle;
  const double k = angle > kSmallAngle ? std::sin(half) / angle : 0.5 - angle * angle / 48.0;
  const Eigen::Quaterniond q(std::cos(half), k * omega.x(), k * omega.y(), k * omega.z());
  return q.normalized().toRotationMatrix();
}

Eigen::Vector3d LogSO3(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sin_half = q.vec().norm();
  // atan2(x, w)/x -> 1/w - x^2/(3 w^3).
  const double k = sin_half > kSmallAngle ? 2.0 * std::atan2(sin_half, q.w()) / sin_half
                                          : 2.0 / q.w() * (1.0 - sin_half * sin_half / 3.0);
  return k * q.vec();
}

Eigen::Matrix3d LeftJacobianSO3(const Eigen::Vector3d& omega) {
  const double a2 = omega.squaredNorm();
  const double a = std::sqrt(a2);
  const Eigen::Matrix3d W = Skew(omega);
  // (1 - cos a)/a^2 and (a - sin a)/a^3, by series where they would cancel.
  constexpr double kCancelling = 1e-3;  // radians: half the digits of a - sin a are left
  double p = 0.5 - a2 / 24.0;
  double q = 1.0 / 6.0 - a2 / 120.0;
  if (a > kCancelling) {
    const double sin_half = std::sin(0.5 * a);
    p = 2.0 * sin_half * sin_half / a2;
    q = (a - std::sin(a)) / (a2 * a);
  }
  return Eigen::Matrix3d::Identity() + p * W + q * W * W;
}

namespace {

// ad of the screw (w, v): w x ., and v x . below.
Matrix6d AdjointOfScrew(const Vector6d& screw) {
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = Skew(screw.head<3>());
  ad.bottomLeftCorner<3, 3>() = Skew(screw.tail<3>());
  return ad;
}

// Exp(screw + d) = Exp(J d) Exp(screw) to first order: sum of ad^n / (n + 1)!. Turns are at most
// pi, so that later terms are below the rounding.
Matrix6d LeftJacobianOfScrew(const Vector6d& screw) {
  constexpr int kTerms = 24;  // pi^24 / 25! is 1e-13
  const Matrix6d ad = AdjointOfScrew(screw);
  Matrix6d term = Matrix6d::Identity(), sum = term;
  for (int n = 1; n < kTerms; ++n) {
    term = (ad * term / (n + 1.0)).eval();
    sum += term;
  }
  return sum;
}

// (d, e) of a pose from the perturbation Exp(d, v) on its left: e = v + d x t.
Matrix6d FromLeftPerturbation(const Pose& pose) {
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.bottomLeftCorner<3, 3>() = -Skew(pose.t);
  return jacobian;
}

}  // namespace

Vector6d ScrewOf(const Pose& motion) {
  Vector6d screw;
  screw.head<3>() = LogSO3(motion.R);
  screw.tail<3>() = LeftJacobianSO3(screw.head<3>()).inverse() * motion.t;
  return screw;
}

Pose PartOfScrew(const Vector6d& screw, double share) {
  if (share == 0) return Pose();
  const Eigen::Vector3d turn = share * screw.head<3>();
  return {ExpSO3(turn), LeftJacobianSO3(turn) * (share * screw.tail<3>())};
}

Pose PartOfMotion(const Pose& motion, double share) {
  return share == 0 ? Pose() : PartOfScrew(ScrewOf(motion), share);
}

Matrix6d PartOfMotionJacobian(const Pose& motion, double share) {
  const Vector6d screw = ScrewOf(motion);
  const Eigen::Matrix<double, 6, 6> by_screw = share *
                                               FromLeftPerturbation(PartOfMotion(motion, share)) *
                                               LeftJacobianOfScrew(share * screw);
  const Eigen::Matrix<double, 6, 6> motion_by_screw =
      FromLeftPerturbation(motion) * LeftJacobianOfScrew(screw);
  return by_screw * motion_by_screw.inverse();
}

Eigen::Matrix3d SmallestRotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d v = a.cross(b);
  const double c = a.dot(b);
  if (c < 0) {
    // Half a turn about an axis across a, then the rest from -a: near b = -a the cross product has
    // lost its digits, but an axis made perpendicular to a has not.
    const Eigen::Vector3d across = v - a * (a.dot(v) / a.squaredNorm());
    constexpr double kOpposite = 1e-15;  // b = -a but for rounding: any axis across a will do
    const Eigen::Vector3d axis = across.norm() > kOpposite
                                     ? Eigen::Vector3d(across.normalized())
                                     : Eigen::Vector3d(TangentBasis(a).col(0));
    return SmallestRotation(-a, b) * ExpSO3(kPi * axis);
  }
  const double sin_angle = v.norm();
  constexpr double kTiny = 1e-12;  // radians, where the angle is its sine to rounding
  if (sin_angle < kTiny) return ExpSO3(v);
  return ExpSO3(std::atan2(sin_angle, c) / sin_angle * v);
}

Matrix3x2d TangentBasis(const Eigen::Vector3d& v) {
  // Start from the axis that v is least aligned with.
  int axis = 0;
  v.cwiseAbs().minCoeff(&axis);
  Matrix3x2d basis;
  basis.col(0) = v.cross(Eigen::Vector3d::Unit(axis)).normalized();
  basis.col(1) = v.cross(basis.col(0));
  return basis;
}

}  // namespace rigel
