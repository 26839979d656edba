// The motion of a point of the body that is not its origin.
//
// The user chooses the body's origin: an axle, an IMU, the origin of a map. If it is far from the
// cameras, t comes mostly from the rotation about it. So the estimate is of the motion of the rig's
// centre c, which is f2_from_f1 with both origins moved to c:
//   b = R c + t - c,   t = b + c - R c
// The result is stated as the motion of the body. The directions of the axes do not change.
#ifndef RIGEL_CORE_RIG_CENTRE_H_
#define RIGEL_CORE_RIG_CENTRE_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/pose.h"
#include "rigel/core/rig.h"

namespace rigel {

// The mean of the camera positions, metres in the body frame; zero without cameras.
Eigen::Vector3d RigCentre(const Rig& rig);

// The rig in the body frame with its origin moved to `origin`.
Rig WithOrigin(const Rig& rig, const Eigen::Vector3d& origin);

// (R, b) of the point, and (R, t) of the body again.
Pose MotionOfPoint(const Pose& body, const Eigen::Vector3d& point);
Pose MotionOfBody(const Pose& of_point, const Eigen::Vector3d& point);

// d(d, e) of the body by that of the point, for R <- Exp(d) R, t <- t + e and the same of b:
// e = e_b + [R c]x d. That of -point is the inverse.
Matrix6d BodyFromPointJacobian(const Eigen::Matrix3d& R, const Eigen::Vector3d& point);

// The body's motion whose t has the given length > 0 with R and the direction of the point's motion
// as they are; of two such motions the longer. Where none has that length, |b| has it. Unchanged at
// b = 0.
Pose WithBodyLength(const Pose& body, const Eigen::Vector3d& point, double length);

}  // namespace rigel

#endif  // RIGEL_CORE_RIG_CENTRE_H_
