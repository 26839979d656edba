#include "rigel/core/row_point.h"

#include <limits>

namespace rigel {

RowPoint RowPointOf(const RigCamera& camera, const Pixel& pixel) {
  const Camera& c = camera.intrinsics;
  RowPoint point;
  if (c.IsPinhole()) {
    point.p = {pixel.x() - c.cx(), pixel.y() - c.cy(), 1.0};
    point.J.setIdentity();
  } else if (!Unproject(c, pixel, &point.p, &point.J)) {
    point.p.setConstant(std::numeric_limits<double>::quiet_NaN());
    point.J.setZero();
  }
  return point;
}

RowPoint RayPointOf(const RigCamera& camera, const Pixel& pixel) {
  RowPoint point = RowPointOf(camera, pixel);
  const Camera& c = camera.intrinsics;
  if (c.IsPinhole()) {
    point.p = AlongRay(c, pixel);
    point.J(0, 0) = 1.0 / c.fx();
    point.J(1, 1) = 1.0 / c.fy();
  }
  return point;
}

Eigen::Matrix3d Unprojection(const RigCamera& camera) {
  const Camera& c = camera.intrinsics;
  if (!c.IsPinhole()) return Eigen::Matrix3d::Identity();
  return Eigen::Vector3d(1.0 / c.fx(), 1.0 / c.fy(), 1.0).asDiagonal();
}

}  // namespace rigel
