// Alignment of the two body frames to a motion prior: what is left of R is one angle about Y.
//
//   R = A2' R_y(a) A1                                            (paper eq. d0)
// Rays of view 1 are rotated by A1, rays of view 2 by A2, and the solved translation is A2 t.
#ifndef RIGEL_CORE_ALIGNMENT_H_
#define RIGEL_CORE_ALIGNMENT_H_

#include <string>

#include <Eigen/Core>

#include "rigel/core/prior.h"

namespace rigel {

struct Alignment {
  PriorKind kind = PriorKind::kNone;
  Eigen::Matrix3d A1 = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d A2 = Eigen::Matrix3d::Identity();

  // A1 = A2 to 1e-12: R = I belongs to the family, and with it the zero motion that satisfies
  // every intra-camera match.
  bool contains_identity = true;

  // The prior's forward direction, aligned: A1 f. Zero where it states none.
  Eigen::Vector3d forward = Eigen::Vector3d::Zero();

  // R = B0 + cos(a) Bc + sin(a) Bs.
  Eigen::Matrix3d B0, Bc, Bs;

  Eigen::Matrix3d Rotation(double cos_a, double sin_a) const {
    return B0 + cos_a * Bc + sin_a * Bs;
  }

  // A2' t: the translation t of the aligned frames in f2.
  Eigen::Vector3d ToFrame2(const Eigen::Vector3d& t) const {
    // By components: to read a vector right after its parts were written makes the processor wait.
    return t.x() * A2.row(0).transpose() + t.y() * A2.row(1).transpose() +
           t.z() * A2.row(2).transpose();
  }

  // The angle a of the member of the family nearest to R.
  double NearestAngle(const Eigen::Matrix3d& R) const;

  // The known direction in f2: the axis of the left perturbation that `a` makes, d R / d a =
  // [axis]x R.
  Eigen::Vector3d AxisInFrame2() const { return A2.row(1).transpose(); }
};

// kVertical: A1 takes gravity1 to Y and A2 = A1 M with M the smallest rotation that takes gravity2
// to gravity1, so that a = 0 is the smallest rotation which the prior allows. kAxis and kPlanar:
// A1 = A2 = A with A n = Y. kNone: identities. False with a message if `prior` lacks what `kind`
// needs, or a direction is not a finite unit vector (to 1e-3; it is normalized). Of the prior's
// forward direction only the planar solvers make use, it is never needed here.
bool MakeAlignment(const MotionPrior& prior, PriorKind kind, Alignment* alignment,
                   std::string* error);

}  // namespace rigel

#endif  // RIGEL_CORE_ALIGNMENT_H_
