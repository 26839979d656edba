// Converts an estimated motion to the factors of pose-graph back ends: the between factor of GTSAM
// and the edge of g2o. Each has its own measurement, perturbation and order.
//
//            Rigel                      GTSAM                  g2o
//            (R, t), summary            BetweenFactor<Pose3>   EDGE_SE3:QUAT (EdgeSE3)
//   holds    T = f2_from_f1             M = T^-1 = f1_from_f2  M = T^-1 = f1_from_f2
//   perturb  R <- Exp(d) R, t <- t + e  M <- M Expmap(w, v)    M <- M (v, q(h))
//   order    d, e                       w, v                   v, h
//
// M is the pose of frame 2 in frame 1, x1^-1 x2 for poses world_from_body. q(h) is the unit
// quaternion with vector part h. To first order
//
//   w = -d,   v = -e - t x d,   h = w / 2
//
// for any rotation. g2o's error is (translation, vector part of the unit quaternion) of
// M^-1 x1^-1 x2 (internal::toVectorMQT of its types/slam3d). The vector part is half the rotation
// vector. So g2o's information is four times that of the angle in the rotation block, and twice in
// the mixed blocks.
//
// If the motion is not fully determined, the information of the missing part is exactly zero. In
// Rigel's convention:
//   - If |t| was held, there is no information along t. If neither the matches nor a distance say
//   the
//     length of b, the motion of the rig's centre (rig_centre.h), there is none along b. The other
//     five directions have their marginal information.
//   - If the direction of b is not observable, the translation has none, and the rotation has its
//     marginal information.
//   - If the rotation is not observable, or there is no covariance, the information is zero.
//   - If an exact prior held a part of the rotation or of t, this part has none. Add the prior to
//     the back end as a factor of its own.
#ifndef RIGEL_REFINE_BETWEEN_FACTOR_H_
#define RIGEL_REFINE_BETWEEN_FACTOR_H_

#include "rigel/core/eigen_types.h"
#include "rigel/core/pose.h"
#include "rigel/refine/refine.h"

namespace rigel {

// The length of b is not known if its relative standard deviation exceeds this.
inline constexpr double kMaxLengthSigma = 0.5;

struct BetweenFactor {
  Pose measurement;  // f1_from_f2
  // In the back end's perturbation and order. The covariance has the rank of Rigel's (zero if there
  // is none). The information is its inverse if there is one, else positive semidefinite as
  // described above.
  Matrix6d covariance = Matrix6d::Zero();
  Matrix6d information = Matrix6d::Zero();
};
static_assert(kSameLayoutEverywhere<BetweenFactor>, "no member of BetweenFactor may be aligned");

// d(w, v) / d(d, e) and d(v, h) / d(d, e) at the motion. Never singular.
Matrix6d GtsamJacobian(const Pose& f2_from_f1);
Matrix6d G2oJacobian(const Pose& f2_from_f1);

// Pseudo-inverse of a covariance in Rigel's convention: the inverse in the directions with
// variance, zero in the others. Radians and metres are scaled alike before the rank is decided.
// Zero if `covariance` is not finite.
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

// Sets |t| = `length` (metres, > 0) of a motion of which the matches do not determine |t|. The |t|
// that was found may then be anything, even thousands of kilometres. R, the direction of b and
// their covariance stay (WithBodyLength()); the covariance of the summary is adapted. A back end
// weights the direction correctly if `length` is near the true one. Does nothing if b = 0.
void SetUndeterminedLength(double length, Pose* f2_from_f1, RefineSummary* summary);

// Upper triangular S with S'S = information. Unlike a Cholesky decomposition it also works for a
// semidefinite matrix. For GTSAM use noiseModel::Gaussian::SqrtInformation(S, false); its
// Information() and Covariance() need full rank.
Matrix6d SqrtInformation(const Matrix6d& information);

}  // namespace rigel

#endif  // RIGEL_REFINE_BETWEEN_FACTOR_H_
