// The formula of a pinhole camera, for points anywhere: Project() refuses those behind it.
#ifndef RIGEL_TEST_CORE_PINHOLE_H_
#define RIGEL_TEST_CORE_PINHOLE_H_

#include <Eigen/Core>

#include "rigel/core/camera.h"

namespace rigel {

// X in the camera frame; X.z() must not be zero.
inline Pixel ProjectPinhole(const Camera& camera, const Eigen::Vector3d& X) {
  return {camera.fx() * X.x() / X.z() + camera.cx(), camera.fy() * X.y() / X.z() + camera.cy()};
}

}  // namespace rigel

#endif  // RIGEL_TEST_CORE_PINHOLE_H_
