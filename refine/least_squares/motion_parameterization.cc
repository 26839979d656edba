#include "rigel/refine/least_squares/motion_parameterization.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"

namespace rigel {

bool MotionParameterization::Set(RotationForm rotation, TranslationForm translation,
                                 const Pose& start, const Alignment& alignment,
                                 const RayPair& reference, const LengthRange& range) {
  rotation_ = rotation;
  translation_ = translation;
  start_ = start;
  alignment_ = alignment;
  reference_ = reference;
  rotation_size_ = rotation == RotationForm::kFree ? 3 : 1;
  if (rotation == RotationForm::kAngle) {
    start_angle_ = alignment.NearestAngle(start.R);
    start_.R = alignment.Rotation(std::cos(start_angle_), std::sin(start_angle_));
  }
  norm_ = start.t.norm();
  const Eigen::Vector3d normal = alignment.AxisInFrame2();
  return translation.depths ? SetDepths(normal) : SetDirection(normal, range);
}

bool MotionParameterization::SetDirection(const Eigen::Vector3d& normal, const LengthRange& range) {
  if (!(norm_ > 0)) return false;
  if (translation_.planar) {
    const Eigen::Vector3d in_plane = start_.t - normal * normal.dot(start_.t);
    // A t along the normal has only rounding in the plane.
    constexpr double kRounding = 1e-9;
    if (!(in_plane.norm() > kRounding * norm_)) return false;
    direction_ = in_plane.normalized();
    tangent_.col(0) = normal.cross(direction_);
    if (!translation_.holds_length) norm_ = in_plane.norm();
  } else {
    direction_ = start_.t / norm_;
    tangent_ = TangentBasis(direction_);
  }
  min_log_ = std::log(range.min / norm_);
  max_log_ = std::log(range.max / norm_);
  return true;
}

bool MotionParameterization::SetDepths(const Eigen::Vector3d& normal) {
  Depths depths;
  if (!TriangulateDepths(start_, reference_, &depths)) return false;
  // From distances to the camera to the paper's depths from the feet: l = d + s.x.
  start_depths_.x() = depths.d1 + reference_.ray1.s.dot(reference_.ray1.x);
  start_depths_.y() = depths.d2 + reference_.ray2.s.dot(reference_.ray2.x);
  depth_basis_.setIdentity();
  if (translation_.planar) {
    // n.(m2 + l2 x2) - n'.(m1 + l1 x1) = 0 with n' = R'n: a line in (l1, l2). The point of it
    // nearest to the start, and the direction along it; nothing is divided by n.x2.
    const Eigen::Vector3d normal1 = alignment_.A1.row(1).transpose();
    const Eigen::Vector2d line(-normal1.dot(reference_.ray1.x), normal.dot(reference_.ray2.x));
    const double offset = normal.dot(reference_.ray2.Foot()) - normal1.dot(reference_.ray1.Foot());
    const double norm2 = line.squaredNorm();
    if (!(norm2 > 1e-18)) return false;  // the reference lies on the horizon
    start_depths_ -= line * ((line.dot(start_depths_) + offset) / norm2);
    depth_basis_.col(0) = Eigen::Vector2d(line.y(), -line.x()) / std::sqrt(norm2);
  }
  return !translation_.holds_length || SetHeldDepths();
}

bool MotionParameterization::SetHeldDepths() {
  if (!(norm_ > 0)) return false;
  const Eigen::Vector3d t =
      TranslationFromDepths(start_.R, reference_, start_depths_.x(), start_depths_.y());
  const Eigen::Vector2d gradient = DepthDirections(start_.R).transpose() * t;
  // Planar depths have one direction; both depths move along the level line of |t|.
  across_ = translation_.planar
                ? Eigen::Vector2d(depth_basis_.col(0) *
                                  (gradient.dot(depth_basis_.col(0)) < 0 ? -1.0 : 1.0))
                : Eigen::Vector2d(gradient / gradient.norm());
  if (!(across_.dot(gradient) > 1e-9 * norm_)) return false;
  depth_basis_.col(0) = Eigen::Vector2d(across_.y(), -across_.x());
  return true;
}

// d t / d(l1, l2) of the reference.
Matrix3x2d MotionParameterization::DepthDirections(const Eigen::Matrix3d& R) const {
  Matrix3x2d directions;
  directions << -(R * reference_.ray1.x), reference_.ray2.x;
  return directions;
}

void MotionParameterization::Evaluate(const double* parameters, Pose* pose,
                                      MotionBasis* basis) const {
  if (basis != nullptr) basis->setZero(6, size());
  if (rotation_ == RotationForm::kFree) {
    const Eigen::Vector3d omega(parameters[0], parameters[1], parameters[2]);
    pose->R = ExpSO3(omega) * start_.R;
    if (basis != nullptr) basis->block<3, 3>(0, 0) = LeftJacobianSO3(omega);
  } else {
    const double a = start_angle_ + parameters[0];
    pose->R = alignment_.Rotation(std::cos(a), std::sin(a));
    if (basis != nullptr) basis->block<3, 1>(0, 0) = alignment_.AxisInFrame2();
  }
  if (translation_.depths) {
    EvaluateDepths(parameters + rotation_size_, pose, basis);
  } else {
    EvaluateDirection(parameters + rotation_size_, pose, basis);
  }
}

void MotionParameterization::EvaluateDirection(const double* p, Pose* pose,
                                               MotionBasis* basis) const {
  const int dimensions = translation_.planar ? 1 : 2;
  // The exponential map of the sphere at the start's direction. In the plane the second angle is 0.
  const Eigen::Vector2d phi(p[0], translation_.planar ? 0.0 : p[1]);
  const double angle2 = phi.squaredNorm();
  const double angle = std::sqrt(angle2);
  const double c = std::cos(angle);
  const double sinc = angle > 1e-4 ? std::sin(angle) / angle : 1.0 - angle2 / 6.0;
  const double bend = angle > 1e-4 ? (c - sinc) / angle2 : -1.0 / 3.0 + angle2 / 30.0;
  const double log =
      translation_.holds_length ? 0.0 : std::clamp(p[dimensions], min_log_, max_log_);
  const double norm = norm_ * std::exp(log);
  const Eigen::Vector3d along = tangent_ * phi;
  pose->t = norm * (c * direction_ + sinc * along);
  if (basis == nullptr) return;
  const Matrix3x2d by_phi =
      norm * (sinc * tangent_ + (bend * along - sinc * direction_) * phi.transpose());
  basis->block(3, rotation_size_, 3, dimensions) = by_phi.leftCols(dimensions);
  if (!translation_.holds_length && log == p[dimensions]) {
    basis->block<3, 1>(3, rotation_size_ + dimensions) = pose->t;
  }
}

void MotionParameterization::EvaluateDepths(const double* p, Pose* pose, MotionBasis* basis) const {
  const Eigen::Matrix<double, 3, 2> by_depth = DepthDirections(pose->R);
  Eigen::Vector2d l = start_depths_;
  for (int k = 0; k < translation_.size(); ++k) l += depth_basis_.col(k) * p[k];
  pose->t = TranslationFromDepths(pose->R, reference_, l.x(), l.y());
  const Eigen::Vector3d v = by_depth * across_;
  if (translation_.holds_length) {
    // |t + q v| = norm: the solution on the side of the start, or the nearest |t| without one.
    const double b = pose->t.dot(v);
    const double excess = pose->t.squaredNorm() - norm_ * norm_;
    const double root = std::sqrt(std::max(0.0, b * b - v.squaredNorm() * excess));
    const double q = (root - b) / v.squaredNorm();
    l += q * across_;
    pose->t += q * v;
  }
  if (basis == nullptr) return;
  const Eigen::Vector3d arm = pose->R * (reference_.ray1.Foot() + l.x() * reference_.ray1.x);
  // t = ... - arm, and the arm rotates with R.
  const Eigen::Matrix3d turn = Skew(arm);
  basis->block(3, 0, 3, rotation_size_) = turn * basis->block(0, 0, 3, rotation_size_);
  for (int k = 0; k < translation_.size(); ++k) {
    basis->block<3, 1>(3, rotation_size_ + k) = by_depth * depth_basis_.col(k);
  }
  const double slope = pose->t.dot(v);
  if (!translation_.holds_length || !(slope > 0)) return;
  for (int k = 0; k < size(); ++k) {
    basis->block<3, 1>(3, k) -= v * (pose->t.dot(basis->block<3, 1>(3, k)) / slope);
  }
}

}  // namespace rigel
