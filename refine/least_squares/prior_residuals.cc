#include "rigel/refine/least_squares/prior_residuals.h"

#include <algorithm>
#include <cmath>

namespace rigel {

PriorResiduals::PriorResiduals(const MotionPrior& prior, const PriorParts& parts, const Pose& start)
    : typical_length_(parts.typical_length), point_(parts.point.data()) {
  with_distance_ = parts.distance && prior.distance.has_value() && prior.distance_sigma > 0;
  if (with_distance_) {
    distance_ = *prior.distance;
    distance_weight_ = 1.0 / prior.distance_sigma;
  }
  SetDirection(prior, parts.direction, start);
  size_ = num_direction_ + (with_distance_ ? 1 : 0) + (typical_length_ > 0 ? 1 : 0);
}

void PriorResiduals::SetDirection(const MotionPrior& prior, PriorKind kind, const Pose& start) {
  if (!HasPrior(prior, kind)) return;
  const double angle = std::max(LogSO3(start.R).norm(), kMinAxisAngle);
  const double chord = 2.0 * std::sin(0.5 * std::min(angle, 3.0));
  switch (kind) {
    case PriorKind::kNone:
      return;
    case PriorKind::kVertical:
      if (!prior.gravity_sigma) return;
      from_ = prior.gravity1->normalized();
      to_ = prior.gravity2->normalized();
      weight_ = 1.0 / (std::sqrt(2.0) * *prior.gravity_sigma);
      break;
    case PriorKind::kAxis:
      if (!prior.axis_sigma) return;
      from_ = to_ = prior.axis->normalized();
      weight_ = 1.0 / (chord * *prior.axis_sigma);
      break;
    case PriorKind::kPlanar:
      if (!prior.normal_sigma) return;
      from_ = to_ = prior.normal->normalized();
      weight_ = 1.0 / (chord * *prior.normal_sigma);
      with_normal_ = start.t.norm() > 0;
      if (with_normal_) translation_weight_ = 1.0 / (start.t.norm() * *prior.normal_sigma);
      break;
  }
  across_ = TangentBasis(to_);
  num_direction_ = with_normal_ ? 3 : 2;
}

void PriorResiduals::Evaluate(const Pose& pose, Residuals* residuals, Jacobian* jacobian) const {
  residuals->resize(size_);
  if (jacobian != nullptr) jacobian->setZero(size_, 6);
  if (size_ == 0) return;
  int row = num_direction_;
  if (with_distance_) {
    const Eigen::Vector3d turned_point = pose.R * point_;
    const Eigen::Vector3d t = pose.t + point_ - turned_point;
    const double norm = t.norm();
    (*residuals)(row) = distance_weight_ * (norm - distance_);
    // At t = 0 the derivative of |t| does not exist. dt = e + [R c]x d.
    if (jacobian != nullptr && norm > 0) {
      const Eigen::Vector3d by_t = distance_weight_ / norm * t;
      jacobian->block<1, 3>(row, 0) = by_t.cross(turned_point).transpose();
      jacobian->block<1, 3>(row, 3) = by_t.transpose();
    }
    ++row;
  }
  if (typical_length_ > 0) {
    // A vanishing b has no logarithm; a length of this fraction stands for it.
    constexpr double kMinLength = 1e-12;
    const double norm = std::max(pose.t.norm(), kMinLength * typical_length_);
    (*residuals)(row) = std::log(norm / typical_length_) / kLengthSigma;
    if (jacobian != nullptr) {
      jacobian->block<1, 3>(row, 3) = pose.t.transpose() / (norm * norm * kLengthSigma);
    }
  }
  if (num_direction_ == 0) return;
  const Eigen::Vector3d turned = pose.R * from_;
  residuals->head<2>() = weight_ * across_.transpose() * (turned - to_);
  // d(Exp(d) R from) = -[R from]x d.
  if (jacobian != nullptr) {
    jacobian->block<2, 3>(0, 0) = -weight_ * across_.transpose() * Skew(turned);
  }
  if (with_normal_) {
    (*residuals)(2) = translation_weight_ * to_.dot(pose.t);
    if (jacobian != nullptr) jacobian->block<1, 3>(2, 3) = translation_weight_ * to_.transpose();
  }
}

}  // namespace rigel
