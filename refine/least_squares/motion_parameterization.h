// The free parameters of a motion in a refinement: a chart of (R, t) around a start.
//
// Every form uses the exact rotation. The parameters are plain numbers and zero at the start, so a
// least-squares engine needs no manifolds. The derivatives are those of the library's perturbation
// R <- Exp(d) R, t <- t + e.
#ifndef RIGEL_REFINE_LEAST_SQUARES_MOTION_PARAMETERIZATION_H_
#define RIGEL_REFINE_LEAST_SQUARES_MOTION_PARAMETERIZATION_H_

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

enum class TranslationForm {
  kFree,          // t: 3
  kSphere,        // the direction of t, |t| as at the start: 2
  kInverseScale,  // the direction of t, 1/|t| (relative to the start): 3. E is linear in 1/|t|. It
                  // stays within [1/1000, 4] times the start, so t cannot run through infinity to
                  // -t, nor into the false minima of a tiny |t| (sign_and_scale.h)
  kPlane,         // t in the plane perpendicular to the prior's normal: 2
  kCircle,        // the direction of t in that plane: 1
  kDepths,        // l1, l2 of the reference match, which is exact (paper eqs. a2, a5): 2
  kDepth,         // l2 of the reference, l1 as at the start (it fixes the scale): 1
  kPlanarDepths,  // l1, l2 with t in the plane (paper eq. h4): 1
  kPlanarDepth,   // the same with the scale fixed: 0
  // As kDepths and kPlanarDepths with |t| as at the start: 1 and 0. If for a rotation no depths
  // give that |t|, the nearest |t|; this happens only far from the start.
  kDepthsOnSphere,
  kPlanarDepthsOnSphere,
};

class MotionParameterization {
 public:
  // Projects `start` onto the form: the nearest angle, the plane, the depths of the point closest
  // to both rays of the reference. `alignment` is used by kAngle and the planar forms, `reference`
  // (rays in the body frames) by the depth forms. False if the form cannot represent the start: |t|
  // = 0 is to be held or inverted, the rays of the reference are parallel, or its depths do not
  // change a |t| that is to be held.
  bool Set(RotationForm rotation, TranslationForm translation, const Pose& start,
           const Alignment& alignment, const RayPair& reference);

  int size() const { return rotation_size_ + translation_size_; }

  // The motion at `parameters` (size() numbers); `basis` may be null.
  void Evaluate(const double* parameters, Pose* pose, MotionBasis* basis) const;

 private:
  Matrix3x2d DepthDirections(const Eigen::Matrix3d& R) const;

  RotationForm rotation_ = RotationForm::kFree;
  TranslationForm translation_ = TranslationForm::kFree;
  int rotation_size_ = 3;
  int translation_size_ = 3;
  Pose start_;
  Alignment alignment_;
  double start_angle_ = 0.0;
  // Sphere, inverse scale and circle: t = norm_ (cos . direction_ + sin . tangent). Plane: t =
  // start + tangent.
  double norm_ = 0.0;
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
  Matrix3x2d tangent_ = Matrix3x2d::Zero();
  // Depth forms: (l1, l2) = start_depths_ + depth_basis_ parameters. If |t| is held at norm_, plus
  // the multiple of across_ that gives this |t|.
  RayPair reference_;
  UnalignedMatrix<2> start_depths_ = UnalignedMatrix<2>::Zero();
  UnalignedMatrix<2, 2> depth_basis_ = UnalignedMatrix<2, 2>::Zero();
  bool holds_norm_ = false;
  UnalignedMatrix<2> across_ = UnalignedMatrix<2>::Zero();
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_MOTION_PARAMETERIZATION_H_
