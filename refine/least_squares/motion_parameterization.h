// The free parameters of a motion in a refinement: a chart of (R, t) around a start.
//
// Every form uses the exact rotation. The parameters are plain numbers and zero at the start, so a
// least-squares engine needs no manifolds. The derivatives are those of the library's perturbation
// R <- Exp(d) R, t <- t + e.
#ifndef RIGEL_REFINE_LEAST_SQUARES_MOTION_PARAMETERIZATION_H_
#define RIGEL_REFINE_LEAST_SQUARES_MOTION_PARAMETERIZATION_H_

#include <limits>

#include <Eigen/Core>

#include "rigel/core/alignment.h"
#include "rigel/core/eigen_types.h"
#include "rigel/core/pose.h"
#include "rigel/core/rays.h"

namespace rigel {

// d(d, e) / d(parameters): 6 rows (rotation in radians, then translation in metres), one column for
// each parameter.
using MotionBasis = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::DontAlign, 6, 6>;

enum class RotationForm {
  kFree,   // R = Exp(w) R0: 3 parameters
  kAngle,  // R = A2' R_y(a) A1: 1 parameter, the prior is exact
};

// What t may do. With no flag its direction moves on the sphere and its length by its logarithm: t
// = |t0| exp(l) d. Such a t can neither run through infinity nor through zero to -t.
struct TranslationForm {
  bool planar = false;  // t stays in the plane perpendicular to the prior's normal
  // t comes from the depths l1, l2 of the reference match, which is exact (paper eqs. a2, a5;
  // planar: h4).
  bool depths = false;
  // |t| as at the start. With depths: if for a rotation none give that |t|, the nearest |t|; this
  // happens only far from the start.
  bool holds_length = false;

  int size() const {
    const int free = depths ? (planar ? 1 : 2) : (planar ? 2 : 3);
    return free - (holds_length ? 1 : 0);
  }
};

// Limits of |t|, metres, for a t without depths whose length is free.
struct LengthRange {
  double min = 0.0;
  double max = std::numeric_limits<double>::infinity();
};

class MotionParameterization {
 public:
  // Projects `start` onto the form: the nearest angle, the plane, the depths of the point closest
  // to both rays of the reference. `alignment` is used by kAngle and the planar forms, `reference`
  // (rays in the body frames) by the depth forms. False if the form cannot represent the start: t =
  // 0 has no direction, the rays of the reference are parallel, or its depths do not change a |t|
  // that is to be held.
  bool Set(RotationForm rotation, TranslationForm translation, const Pose& start,
           const Alignment& alignment, const RayPair& reference, const LengthRange& range = {});

  int size() const { return rotation_size_ + translation_.size(); }

  // The motion at `parameters` (size() numbers); `basis` may be null.
  void Evaluate(const double* parameters, Pose* pose, MotionBasis* basis) const;

 private:
  bool SetDirection(const Eigen::Vector3d& normal, const LengthRange& range);
  bool SetDepths(const Eigen::Vector3d& normal);
  bool SetHeldDepths();
  void EvaluateDirection(const double* p, Pose* pose, MotionBasis* basis) const;
  void EvaluateDepths(const double* p, Pose* pose, MotionBasis* basis) const;
  Matrix3x2d DepthDirections(const Eigen::Matrix3d& R) const;

  RotationForm rotation_ = RotationForm::kFree;
  TranslationForm translation_;
  int rotation_size_ = 3;
  Pose start_;
  Alignment alignment_;
  double start_angle_ = 0.0;
  // Without depths: t = norm_ exp(l) (cos . direction_ + sin . tangent).
  double norm_ = 0.0;
  double min_log_ = 0.0;  // limits of l
  double max_log_ = 0.0;
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
  Matrix3x2d tangent_ = Matrix3x2d::Zero();
  // Depth forms: (l1, l2) = start_depths_ + depth_basis_ parameters. If |t| is held at norm_, plus
  // the multiple of across_ that gives this |t|.
  RayPair reference_;
  UnalignedMatrix<2> start_depths_ = UnalignedMatrix<2>::Zero();
  UnalignedMatrix<2, 2> depth_basis_ = UnalignedMatrix<2, 2>::Zero();
  UnalignedMatrix<2> across_ = UnalignedMatrix<2>::Zero();
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_MOTION_PARAMETERIZATION_H_
