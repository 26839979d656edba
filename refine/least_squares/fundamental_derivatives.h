// The matrix F of a camera pair and its derivatives: by the motion, and by errors of the
// calibration.
//
// F = A_2'[b]x R A_1 with A = Q U (row_point.h) and b = R s_1 + t - s_2. Matrices of derivatives
// have a row for each entry of F, row by row.
#ifndef RIGEL_REFINE_LEAST_SQUARES_FUNDAMENTAL_DERIVATIVES_H_
#define RIGEL_REFINE_LEAST_SQUARES_FUNDAMENTAL_DERIVATIVES_H_

#include <Eigen/Core>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using ByMotionMatrix = Eigen::Matrix<double, 9, 6>;

// A camera has seven errors. The first three are the turn d of Q <- Exp(d) Q, in radians about the
// axes of the body, the next three the shift e of s <- s + e, in metres. The last is the growth of
// the focal lengths by a fraction.
inline constexpr int kCameraErrors = 7;
using ByCalibrationMatrix = Eigen::Matrix<double, 9, 2 * kCameraErrors>;

// With `of_rays` U is left out: F is then the essential matrix of the camera pair.
RowMajor3d FundamentalOf(const GroupedMatches& matches, const MatchGroup& group, const Pose& pose,
                         bool of_rays);

// By the perturbation R <- Exp(d) R, t <- t + e: d (radians), then e (metres). With the places of
// cameras that fire at other times, which depend on the motion.
ByMotionMatrix FundamentalByMotion(const GroupedMatches& matches, const MatchGroup& group,
                                   const Pose& pose, bool of_rays);

// By the errors of camera1, then those of camera2. They add up if that is the same camera. The
// focal lengths are those of pinholes: of other lenses they do not act through F (FocalShift()).
ByCalibrationMatrix FundamentalByCalibration(const GroupedMatches& matches, const MatchGroup& group,
                                             const Pose& pose);

// How the point p of a row changes if the focal lengths of its camera, which is no pinhole, grow by
// a fraction: all pixels are nearer to the centre than they should be.
Eigen::Vector3d FocalShift(const RigCamera& camera, const Pixel& pixel);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_FUNDAMENTAL_DERIVATIVES_H_
