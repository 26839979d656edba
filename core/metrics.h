// Errors of a motion against the truth (paper eq. erro_metrics), exact near 0 and pi.
#ifndef RIGEL_CORE_METRICS_H_
#define RIGEL_CORE_METRICS_H_

#include "rigel/core/pose.h"

namespace rigel {

// Angle of R_gt R', radians, in [0, pi].
double RotationError(const Eigen::Matrix3d& R_gt, const Eigen::Matrix3d& R);

// Angle between t_gt and t, radians, in [0, pi]. NaN if either is zero: no direction.
double TranslationDirectionError(const Eigen::Vector3d& t_gt, const Eigen::Vector3d& t);

// | |t| / |t_gt| - 1 |, a fraction. NaN if t_gt is zero.
double ScaleError(const Eigen::Vector3d& t_gt, const Eigen::Vector3d& t);

// Angle between two directions of any length, radians, in [0, pi]; 0 if either is zero.
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace rigel

#endif  // RIGEL_CORE_METRICS_H_
