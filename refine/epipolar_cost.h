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
// Ceres takes no block twice in one residual block. So an intra-camera match (camera i = camera j)
// has the blocks of its camera once; Match::IsIntra() and parameter_block_sizes() of the cost tell
// the two cases apart. For the same reason the two poses of MakeAbsoluteEpipolarCost must be
// different blocks.
//
// Residual: one number, r = C / |dC/d(pixel_i, pixel_j)| / sigma_px. It is the signed Sampson error
// of core/epipolar.h in pixels, over the standard deviation of an image coordinate. So the scale of
// a robust loss is in sigmas. C is the generalized epipolar constraint (paper eq. b2: Li, Liu, Han,
// Lv). Its first-order (Sampson) distance is taken for each camera pair.
//
// A quaternion need not have unit length: it is normalized inside, and the Jacobian is that of the
// normalized one (orthogonal to q). Still set the manifold of the block: ceres::QuaternionManifold
// (kCeres) or ceres::EigenQuaternionManifold (kEigen).
//
// Special cases:
// - At an epipole (the gradient vanishes up to rounding) the residual and its Jacobian are zero, as
//   in Refine().
// - At E = 0 Evaluate() returns false. There the two cameras are at the same place up to rounding;
//   for an intra-camera match that is zero motion. The residual would depend on the direction in
//   which they separate. So a problem that starts with two equal poses fails and does not converge
//   at its start.
// - Poses that are nearly equal are a bad start too. The derivative by t grows as 1 / |b|, so steps
//   are as small as |b|, and Ceres may take that for convergence. Start with a motion of about the
//   right direction and length, such as that of EstimateMotion().
// - If scale is not observable, the error is the same for t and -t. If it is, a start with the
//   wrong sign mostly converges to the right one, but may end in a false minimum near t = 0.
// - Intra-camera matches alone hardly determine the length of t_21 (docs/conventions.md). Hold it
//   by other residuals or by a manifold.
// - Refine() gives matches near an epipole a smaller weight (EpipoleWeights() of
//   refine/least_squares/uncertainty.h, which is not installed): one half at a distance of 14 sigma
//   from both epipoles. For the same effect pass sigma_px / weight as sigma_px.
//
// Errors: a factory returns null if sigma_px is not within 1e-12 and 1e12, or the rig is not valid
// (Rig::IsValid). So it does if the match names a camera that is not there, a pixel is not finite
// or has no ray (core/camera.h), or `order` is not a value of its enum. Test for null:
// ceres::Problem::AddResidualBlock aborts on it. Evaluate() returns false if a parameter is not
// finite or a quaternion is zero (a squared norm that underflows or overflows counts as such), at E
// = 0, and for nothing else.
//
// Ownership: the caller owns the cost and usually passes it to a ceres::Problem, as any cost
// function. Rig and match are copied: they need not outlive the cost. A cost is immutable: many
// threads may evaluate it at once, and residual blocks may share it. Nothing is logged.
#ifndef RIGEL_REFINE_EPIPOLAR_COST_H_
#define RIGEL_REFINE_EPIPOLAR_COST_H_

#include <ceres/cost_function.h>

#include "rigel/core/match.h"
#include "rigel/core/rig.h"

namespace rigel {

// The order of a quaternion's numbers in its parameter block.
enum class QuaternionOrder {
  kCeres,  // w x y z: ceres::QuaternionManifold
  kEigen,  // x y z w, Eigen::Quaterniond::coeffs(): ceres::EigenQuaternionManifold
};

[[nodiscard]] ceres::CostFunction* MakeRelativeEpipolarCost(const Rig& rig, const Match& match,
                                                            double sigma_px, QuaternionOrder order);

[[nodiscard]] ceres::CostFunction* MakeAbsoluteEpipolarCost(const Rig& rig, const Match& match,
                                                            double sigma_px, QuaternionOrder order);

// To refine the calibration. Only the intrinsics of the rig are used; Q and s are parameter blocks.
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
