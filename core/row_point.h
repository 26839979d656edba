// One side of a match as the epipolar constraint needs it, for any camera.
#ifndef RIGEL_CORE_ROW_POINT_H_
#define RIGEL_CORE_ROW_POINT_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/rig.h"

namespace rigel {

// Camera k has a matrix U (Unprojection()): U p is along the ray of the pixel in the camera frame.
//   pinhole: p = (u - cx, v - cy, 1), U = diag(1 / fx, 1 / fy, 1), J = the first two columns of I
//   others: p is the unit ray, U = I, J = d ray / d pixel
struct RowPoint {
  Eigen::Vector3d p;
  UnalignedMatrix<3, 2> J;  // dp/d(pixel)
};

// p is NaN if no ray of the camera has this pixel.
RowPoint RowPointOf(const RigCamera& camera, const Pixel& pixel);

// The same with U multiplied in: p = AlongRay() of the pixel.
RowPoint RayPointOf(const RigCamera& camera, const Pixel& pixel);

Eigen::Matrix3d Unprojection(const RigCamera& camera);

}  // namespace rigel

#endif  // RIGEL_CORE_ROW_POINT_H_
