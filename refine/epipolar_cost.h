// The Sampson error of one match as a cost function for a ceres::Problem of your own.
//
//   factory                                     parameter blocks (sizes), in this order
//   MakeRelativeEpipolarCost                    q_21 (4), t_21 (3)
//   MakeAbsoluteEpipolarCost                    q_w1 (4), t_w1 (3), q_w2 (4), t_w2 (3)
//   MakeRelativeEpipolarCostWithExtrinsics      as above, then q_i (4), s_i (3), q_j (4), s_j (3);
//   MakeAbsoluteEpipolarCostWithExtrinsics      q_i (4), s_i (3) alone for an intra-camera match
//
// Poses, metres:
//   q_21, t_21   T_f2_f1: X_f2 = R(q_21) X_f1 + t_21, Rigel's motion (R, t)
//   q_wk, t_wk   T_w_bk, body to world: X_w = R(q_wk) X_fk + t_wk, the pose of a node of a pose
//                graph; f1 is the body that camera i = match.camera1 looked from, f2 the one of
//                camera j = match.camera2. The motion is T_f2_f1 = T_w_b2^-1 T_w_b1.
//   q_k, s_k     body_from_camera of camera k: X_body = R(q_k) X_cam + s_k
// Ceres takes no block twice in one residual block, so an intra-camera match (camera i = camera j)
// has the blocks of its camera once; Match::IsIntra() and ceres::CostFunction's
// parameter_block_sizes() say which of the two a cost is. For the same reason the two poses of
// MakeAbsoluteEpipolarCost must be different blocks.
//
// Residual: one, r = C / |dC/d(pixel_i, pixel_j)| / sigma_px, the signed Sampson error of
// core/epipolar.h in pixels over the standard deviation of an image coordinate, so that a robust
// loss counts in sigmas. Source: the generalized epipolar constraint of Li, Liu, Han, Lv (eq. b2);
// Sampson's first-order distance of each camera pair.
//
// A quaternion need not be of unit length: it is normalized inside and the Jacobian is that of the
// normalized one (it is orthogonal to q). Give the block ceres::QuaternionManifold (kCeres) or
// ceres::EigenQuaternionManifold (kEigen) all the same.
//
// Defined as zero with a zero Jacobian, as in Refine(), at an epipole (the gradient vanishes up to
// rounding). At E = 0 (the two cameras in one place up to rounding, for an intra-camera match the
// zero motion) there is no residual: it depends on the direction in which they part. Evaluate()
// returns false there, so that a problem that starts with two equal poses ends as a failure, and
// not as converged where it stands. Start from a motion in roughly the right direction and of
// roughly the right length, such as EstimateMotion()'s. Poses that are nearly equal are as bad: the
// derivative by t grows as 1 / |b|, steps are as small as |b|, and Ceres may call that converged.
// The error is the same for t
// and -t where scale is not observable; where it is, a start of the wrong sign mostly comes back,
// but may end in a false minimum near t = 0. Intra-camera matches alone hardly determine the length
// of t_21 (docs/conventions.md): hold it by other residuals or by a manifold.
// Refine() counts matches near an epipole less (EpipoleWeights() of
// refine/least_squares/uncertainty.h); here every match counts in full: give those a larger
// sigma_px, sigma / weight, for the same.
//
// Errors: a factory returns null if sigma_px is not within 1e-12 and 1e12, the rig is not valid
// (Rig::IsValid), the match names a camera that is not there, a pixel is not finite or `order` is
// not a value of its enum; ceres::Problem::AddResidualBlock aborts on null, so test for it.
// Evaluate() returns false if a parameter is not finite or a quaternion is zero (a squared norm
// that underflows or overflows counts as such), at E = 0, and for nothing else.
//
// Ownership is the caller's, who hands it to the ceres::Problem, as with all of Ceres' cost
// functions. Rig and match are copied: they need not outlive the cost. A cost is immutable: it may
// be evaluated by many threads at once and shared by residual blocks. Nothing is logged.
#ifndef RIGEL_REFINE_EPIPOLAR_COST_H_
#define RIGEL_REFINE_EPIPOLAR_COST_H_

#include <ceres/cost_function.h>

#include "rigel/core/match.h"
#include "rigel/core/rig.h"

namespace rigel {

// How a quaternion stands in its parameter block.
enum class QuaternionOrder {
  kCeres,  // w x y z: ceres::QuaternionManifold
  kEigen,  // x y z w, Eigen::Quaterniond::coeffs(): ceres::EigenQuaternionManifold
};

[[nodiscard]] ceres::CostFunction* MakeRelativeEpipolarCost(const Rig& rig, const Match& match,
                                                            double sigma_px, QuaternionOrder order);

[[nodiscard]] ceres::CostFunction* MakeAbsoluteEpipolarCost(const Rig& rig, const Match& match,
                                                            double sigma_px, QuaternionOrder order);

// For refining the calibration: of the rig only the intrinsics enter, its Q and s are the blocks'.
[[nodiscard]] ceres::CostFunction* MakeRelativeEpipolarCostWithExtrinsics(const Rig& rig,
                                                                          const Match& match,
                                                                          double sigma_px,
                                                                          QuaternionOrder order);

[[nodiscard]] ceres::CostFunction* MakeAbsoluteEpipolarCostWithExtrinsics(const Rig& rig,
                                                                          const Match& match,
                                                                          double sigma_px,
                                                                          QuaternionOrder order);

}  // namespace rigel

#endif  // RIGEL_REFINE_EPIPOLAR_COST_H_
