#include "rigel/refine/least_squares/motion_parameterization.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"

namespace rigel {
namespace {

constexpr double kMinInverseScale = 1e-3;
constexpr double kMaxInverseScale = 4.0;

}  // namespace

bool MotionParameterization::Set(RotationForm rotation, TranslationForm translation,
                                 const Pose& start, const Alignment& alignment,
                                 const RayPair& reference) {
  rotation_ = rotation;
  translation_ = translation;
  start_ = start;
  alignment_ = alignment;
  reference_ = reference;
  holds_norm_ = false;
  rotation_size_ = rotation == RotationForm::kFree ? 3 : 1;
  if (rotation == RotationForm::kAngle) {
    start_angle_ = alignment.NearestAngle(start.R);
    start_.R = alignment.Rotation(std::cos(start_angle_), std::sin(start_angle_));
  }
  const Eigen::Vector3d normal = alignment.AxisInFrame2();
  switch (translation) {
    case TranslationForm::kFree:
      translation_size_ = 3;
      break;
    case TranslationForm::kSphere:
    case TranslationForm::kInverseScale:
      translation_size_ = translation == TranslationForm::kSphere ? 2 : 3;
      norm_ = start.t.norm();
      if (!(norm_ > 0)) return false;
      direction_ = start.t / norm_;
      tangent_ = TangentBasis(direction_);
      break;
    case TranslationForm::kPlane:
      translation_size_ = 2;
      start_.t -= normal * normal.dot(start_.t);
      tangent_ = TangentBasis(normal);
      break;
    case TranslationForm::kCircle: {
      translation_size_ = 1;
      const Eigen::Vector3d in_plane = start.t - normal * normal.dot(start.t);
      norm_ = start.t.norm();
      // A t along the normal has only rounding in the plane.
      if (!(in_plane.norm() > 1e-9 * norm_)) return false;
      direction_ = in_plane.normalized();
      tangent_.col(0) = normal.cross(direction_);
      break;
    }
    case TranslationForm::kDepths:
    case TranslationForm::kDepth:
    case TranslationForm::kPlanarDepths:
    case TranslationForm::kPlanarDepth:
    case TranslationForm::kDepthsOnSphere:
    case TranslationForm::kPlanarDepthsOnSphere: {
      Depths depths;
      if (!TriangulateDepths(start_, reference, &depths)) return false;
      // From distances to the camera to the paper's depths from the feet: l = d + s.x.
      start_depths_.x() = depths.d1 + reference.ray1.s.dot(reference.ray1.x);
      start_depths_.y() = depths.d2 + reference.ray2.s.dot(reference.ray2.x);
      depth_basis_.setIdentity();
      translation_size_ = 2;
      holds_norm_ = translation == TranslationForm::kDepthsOnSphere ||
                    translation == TranslationForm::kPlanarDepthsOnSphere;
      const bool planar = translation == TranslationForm::kPlanarDepths ||
                          translation == TranslationForm::kPlanarDepth ||
                          translation == TranslationForm::kPlanarDepthsOnSphere;
      if (planar) {
        // n.(m2 + l2 x2) - n'.(m1 + l1 x1) = 0 with n' = R'n: a line in (l1, l2). The point of it
        // nearest to the start, and the direction along it; nothing is divided by n.x2.
        const Eigen::Vector3d normal1 = alignment.A1.row(1).transpose();
        const Eigen::Vector2d line(-normal1.dot(reference.ray1.x), normal.dot(reference.ray2.x));
        const double offset =
            normal.dot(reference.ray2.Foot()) - normal1.dot(reference.ray1.Foot());
        const double norm2 = line.squaredNorm();
        if (!(norm2 > 1e-18)) return false;  // the reference lies on the horizon
        start_depths_ -= line * ((line.dot(start_depths_) + offset) / norm2);
        translation_size_ = translation == TranslationForm::kPlanarDepth ? 0 : 1;
        depth_basis_.col(0) = Eigen::Vector2d(line.y(), -line.x()) / std::sqrt(norm2);
      } else if (translation == TranslationForm::kDepth) {
        translation_size_ = 1;
        depth_basis_.col(0) = Eigen::Vector2d::UnitY();
      }
      if (holds_norm_) {
        norm_ = start.t.norm();
        if (!(norm_ > 0)) return false;
        const Eigen::Vector3d t =
            TranslationFromDepths(start_.R, reference, start_depths_.x(), start_depths_.y());
        const Eigen::Vector2d gradient = DepthDirections(start_.R).transpose() * t;
        // Planar depths have one direction; both depths move along the level line of |t|.
        across_ = planar ? Eigen::Vector2d(depth_basis_.col(0) *
                                           (gradient.dot(depth_basis_.col(0)) < 0 ? -1.0 : 1.0))
                         : Eigen::Vector2d(gradient / gradient.norm());
        if (!(across_.dot(gradient) > 1e-9 * norm_)) return false;
        depth_basis_.col(0) = Eigen::Vector2d(across_.y(), -across_.x());
        --translation_size_;
      }
      break;
    }
  }
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

  const double* p = parameters + rotation_size_;
  const int column = rotation_size_;
  switch (translation_) {
    case TranslationForm::kFree:
      pose->t = start_.t + Eigen::Vector3d(p[0], p[1], p[2]);
      if (basis != nullptr) basis->block<3, 3>(3, column).setIdentity();
      break;
    case TranslationForm::kSphere:
    case TranslationForm::kInverseScale: {
      // The exponential map of the sphere at the start's direction.
      const Eigen::Vector2d phi(p[0], p[1]);
      const double angle2 = phi.squaredNorm();
      const double angle = std::sqrt(angle2);
      const double c = std::cos(angle);
      const double sinc = angle > 1e-4 ? std::sin(angle) / angle : 1.0 - angle2 / 6.0;
      const double bend = angle > 1e-4 ? (c - sinc) / angle2 : -1.0 / 3.0 + angle2 / 30.0;
      const Eigen::Vector3d along = tangent_ * phi;
      const bool with_scale = translation_ == TranslationForm::kInverseScale;
      const double inverse =
          with_scale ? std::clamp(1.0 + p[2], kMinInverseScale, kMaxInverseScale) : 1.0;
      const double norm = norm_ / inverse;
      pose->t = norm * (c * direction_ + sinc * along);
      if (basis != nullptr) {
        basis->block<3, 2>(3, column) =
            norm * (sinc * tangent_ + (bend * along - sinc * direction_) * phi.transpose());
        if (with_scale && inverse > kMinInverseScale && inverse < kMaxInverseScale) {
          basis->block<3, 1>(3, column + 2) = -pose->t / inverse;
        }
      }
      break;
    }
    case TranslationForm::kCircle: {
      const double c = std::cos(p[0]);
      const double s = std::sin(p[0]);
      pose->t = norm_ * (c * direction_ + s * tangent_.col(0));
      if (basis != nullptr) {
        basis->block<3, 1>(3, column) = norm_ * (c * tangent_.col(0) - s * direction_);
      }
      break;
    }
    case TranslationForm::kPlane:
      pose->t = start_.t + tangent_ * Eigen::Vector2d(p[0], p[1]);
      if (basis != nullptr) basis->block<3, 2>(3, column) = tangent_;
      break;
    case TranslationForm::kDepths:
    case TranslationForm::kDepth:
    case TranslationForm::kPlanarDepths:
    case TranslationForm::kPlanarDepth:
    case TranslationForm::kDepthsOnSphere:
    case TranslationForm::kPlanarDepthsOnSphere: {
      const Eigen::Matrix<double, 3, 2> by_depth = DepthDirections(pose->R);
      Eigen::Vector2d l = start_depths_;
      for (int k = 0; k < translation_size_; ++k) l += depth_basis_.col(k) * p[k];
      pose->t = TranslationFromDepths(pose->R, reference_, l.x(), l.y());
      const Eigen::Vector3d v = by_depth * across_;
      if (holds_norm_) {
        // |t + q v| = norm: the solution on the side of the start, or the nearest |t| without one.
        const double b = pose->t.dot(v);
        const double excess = pose->t.squaredNorm() - norm_ * norm_;
        const double root = std::sqrt(std::max(0.0, b * b - v.squaredNorm() * excess));
        const double q = (root - b) / v.squaredNorm();
        l += q * across_;
        pose->t += q * v;
      }
      if (basis != nullptr) {
        const Eigen::Vector3d arm = pose->R * (reference_.ray1.Foot() + l.x() * reference_.ray1.x);
        // t = ... - arm, and the arm rotates with R.
        const Eigen::Matrix3d turn = Skew(arm);
        basis->block(3, 0, 3, rotation_size_) = turn * basis->block(0, 0, 3, rotation_size_);
        for (int k = 0; k < translation_size_; ++k) {
          basis->block<3, 1>(3, column + k) = by_depth * depth_basis_.col(k);
        }
        const double slope = pose->t.dot(v);
        if (holds_norm_ && slope > 0) {
          for (int k = 0; k < size(); ++k) {
            basis->block<3, 1>(3, k) -= v * (pose->t.dot(basis->block<3, 1>(3, k)) / slope);
          }
        }
      }
      break;
    }
  }
}

}  // namespace rigel
