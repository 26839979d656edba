#include "rigel/core/row_point.h"

#include "rigel/core/epipolar.h"

namespace rigel {

RowPoint RowPointOf(const RigCamera& camera, const Pixel& pixel) {
  RowPoint point;
  point.p = CentredPixel(camera.intrinsics, pixel);
  point.J.setIdentity();
  return point;
}

Eigen::Matrix3d Unprojection(const RigCamera& camera) {
  const PinholeCamera& c = camera.intrinsics;
  return Eigen::Vector3d(1.0 / c.fx, 1.0 / c.fy, 1.0).asDiagonal();
}

}  // namespace rigel
