// The generalized epipolar constraint (GEC) in its forms, and the Sampson error in pixels.
//
// One match gives one equation for the motion (R, t), linear in t (paper eq. b2):
//   C = x_j . (b x R x_i),   b = R s_i + t - s_j            triple product
//     = x_j'R q_i + q_j'R x_i + x_j'[t]x R x_i              Pluecker form
//     = u_j' E u_i / (|u_i| |u_j|),  E = Q_j'[b]x R Q_i     essential matrix of the camera pair
#ifndef RIGEL_CORE_EPIPOLAR_H_
#define RIGEL_CORE_EPIPOLAR_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/match.h"
#include "rigel/core/pose.h"
#include "rigel/core/rays.h"
#include "rigel/core/rig.h"
#include "rigel/core/row_point.h"

namespace rigel {

// b = R s_i + t - s_j: from the centre of camera j at time 2 to that of camera i at time 1, in f2.
inline Eigen::Vector3d Baseline(const Pose& pose, const Eigen::Vector3d& s_i,
                                const Eigen::Vector3d& s_j) {
  return pose.R * s_i + pose.t - s_j;
}

// C as a triple product; metres (the rays' directions are unit vectors).
double GecTripleProduct(const Pose& pose, const RayPair& rays);

// C in Pluecker coordinates (paper eq. b2); metres.
double GecPluecker(const Pose& pose, const RayPair& rays);

// t of the depth parameterization (paper eqs. a2, a5): the reference's point is at m1 + l1 x1 in
// f1 and m2 + l2 x2 in f2; l1, l2 in metres from the feet of the perpendiculars.
Eigen::Vector3d TranslationFromDepths(const Eigen::Matrix3d& R, const RayPair& reference, double l1,
                                      double l2);

// The coefficients (of l1, of l2, constant) of the depth-parameterized GEC (paper eq. b4).
Eigen::Vector3d GecDepthCoefficients(const Eigen::Matrix3d& R, const RayPair& reference,
                                     const RayPair& rays);

// E = Q_j'[b]x R Q_i: u_j' E u_i = 0 for the normalized points of a match of camera i at time 1
// and camera j at time 2. Metres.
Eigen::Matrix3d EssentialMatrix(const Pose& pose, const RigCamera& camera_i,
                                const RigCamera& camera_j);

// The same from depths (paper eq. c4).
Eigen::Matrix3d EssentialMatrixFromDepths(const Eigen::Matrix3d& R, const RayPair& reference,
                                          double l1, double l2, const RigCamera& camera_i,
                                          const RigCamera& camera_j);

// Signed Sampson error in pixels, r = C / |dC/d(pixel_i, pixel_j)|, for pinholes: p is that of
// row_point.h, F = U_j' E U_i. With centred pixels the usual Sampson formula gives pixels for any
// mixture of focal lengths, fx != fy included.
// It is the distance of the match from the nearest exact match to first order, it does not
// change when F is scaled (so it cannot gain by shrinking the motion), and:
//   at the epipoles (the gradient is zero but F is not) it is 0, its limit;
//   at F = 0, where every match fits, it is infinite: a motion that gives a camera pair no
//   baseline must not count all matches of this pair as inliers.
double SampsonError(const Eigen::Matrix3d& F, const Eigen::Vector3d& p_i,
                    const Eigen::Vector3d& p_j);

// The same for any cameras: F = U_j' E U_i (row_point.h), r = C / |(J_i'F'p_j, J_j'F p_i)|.
double SampsonError(const Eigen::Matrix3d& F, const RowPoint& i, const RowPoint& j);

// Sampson error of one match under `pose`, pixels. The match's cameras must be in the rig. Infinite
// if a pixel has no ray.
double SampsonError(const Pose& pose, const Rig& rig, const Match& match);

}  // namespace rigel

#endif  // RIGEL_CORE_EPIPOLAR_H_
