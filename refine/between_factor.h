// An estimated motion as what pose-graph back ends hold: the between factor of GTSAM and the edge
// of g2o, each with its own measurement, perturbation and order.
//
//            Rigel                      GTSAM                     g2o
//            (R, t), summary            BetweenFactor<Pose3>      EDGE_SE3:QUAT (EdgeSE3)
//   holds    T = f2_from_f1             M = T^-1 = f1_from_f2     M = T^-1 = f1_from_f2
//   perturb  R <- Exp(d) R, t <- t + e  M <- M Expmap(w, v)       M <- M (v, q = (sqrt(1 - h'h),
//   h)) order    d, e                       w, v                      v, h
//
// M is the pose of frame 2 in frame 1, x1^-1 x2 for poses world_from_body. To first order
//
//   w = -d,   v = -e - t x d,   h = w / 2
//
// for any rotation. g2o's error is (translation, vector part of the unit quaternion) of
// M^-1 x1^-1 x2 (internal::toVectorMQT of its types/slam3d): half the rotation vector, so that its
// information is four times that of the angle in the rotation block and twice in the mixed one.
//
// Information where not everything is determined: what Rigel's covariance leaves out or calls not
// observable has none, exactly zero, never a large number made up. In Rigel's convention:
//   - a length was held: none along b, the motion of the rig's centre (rig_centre.h; where |t| is
//     held, t), and that of the five free directions given |b|;
//   - the direction of b is not observable: none for the translation, and that of the rotation
//     whatever the translation is (its marginal);
//   - the rotation is not observable, or there is no covariance: none at all;
//   - an exact prior held a part of the rotation or of t: none there, either. What is known of it
//     is the prior's, not the matches': give it to the back end as a factor of its own.
#ifndef RIGEL_REFINE_BETWEEN_FACTOR_H_
#define RIGEL_REFINE_BETWEEN_FACTOR_H_

#include "rigel/core/eigen_types.h"
#include "rigel/core/pose.h"
#include "rigel/refine/refine.h"

namespace rigel {

struct BetweenFactor {
  Pose measurement;  // f1_from_f2
  // In the back end's perturbation and order. The covariance is of the rank of Rigel's (zero if
  // there is none). The information is its inverse where it has one, else positive semidefinite as
  // above; a change of convention moves the directions without information along.
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d information = Matrix6d::Zero();
};
static_assert(kSameLayoutEverywhere<BetweenFactor>, "no member of BetweenFactor may be aligned");

// d(w, v) / d(d, e) and d(v, h) / d(d, e) at the motion. Never singular.
Matrix6d GtsamJacobian(const Pose& f2_from_f1);
Matrix6d G2oJacobian(const Pose& f2_from_f1);

// The inverse of a covariance in Rigel's convention on the directions it covers, zero in those
// that it gives no variance: the pseudo-inverse, with radians and metres brought to one scale
// before the rank is judged. Zero if `covariance` is not finite.
Matrix6d PseudoInformation(const Matrix6d& covariance);

// Information of a refined motion in Rigel's convention, as described above. `f2_from_f1` is the
// motion that Refine() returned with the summary.
Matrix6d InformationMatrix(const RefineSummary& summary, const Pose& f2_from_f1);

// The factor of a motion with this covariance in Rigel's convention; its information is that of
// PseudoInformation().
BetweenFactor GtsamBetweenFactor(const Pose& f2_from_f1, const Matrix6d& covariance);
BetweenFactor G2oEdge(const Pose& f2_from_f1, const Matrix6d& covariance);

// The factor of a refined motion; its information is that of InformationMatrix().
BetweenFactor GtsamBetweenFactor(const Pose& f2_from_f1, const RefineSummary& summary);
BetweenFactor G2oEdge(const Pose& f2_from_f1, const RefineSummary& summary);

// Sets |t| = `length` > 0 where the matches do not determine it (what is found then may be
// anything, thousands of kilometres too) and takes the covariance of the summary along: R and the
// direction of b, and their covariance, stay (WithBodyLength()). A back end weighs the direction
// rightly if `length` is near the true one. Does nothing if b = 0.
void SetUndeterminedLength(double length, Pose* f2_from_f1, RefineSummary* summary);

// Upper triangular S with S'S = information, of a positive semidefinite matrix too, where a
// Cholesky decomposition fails. GTSAM: noiseModel::Gaussian::SqrtInformation(S, false), and not
// Information() or Covariance(), which need full rank.
Matrix6d SqrtInformation(const Matrix6d& information);

}  // namespace rigel

#endif  // RIGEL_REFINE_BETWEEN_FACTOR_H_
