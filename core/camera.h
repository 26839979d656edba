// Undistorted pinhole camera: pixels <-> normalized image points.
#ifndef RIGEL_CORE_CAMERA_H_
#define RIGEL_CORE_CAMERA_H_

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"

namespace rigel {

// pixel = (fx x + cx, fy y + cy) for the normalized image point u = (x, y, 1); +z forward, +x
// right, +y down. Focal lengths and the principal point in pixels, the same origin as the
// pixels of the matches. Undistorted pixels may lie outside width and height. These two tell how
// often random matches would fit a motion (EstimateStatus::kNoConsensus). If they are 0, the size
// is guessed from the principal point and the focal length, and from the matches.
struct PinholeCamera {
  double fx = 1.0;
  double fy = 1.0;
  double cx = 0.0;
  double cy = 0.0;
  int width = 0;
  int height = 0;

  Eigen::Vector3d Normalize(const Pixel& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0};
  }

  // X in the camera frame; X.z() must not be zero.
  Pixel Project(const Eigen::Vector3d& X) const {
    return {fx * X.x() / X.z() + cx, fy * X.y() / X.z() + cy};
  }

  bool InImage(const Pixel& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width && pixel.y() < height;
  }
};

}  // namespace rigel

#endif  // RIGEL_CORE_CAMERA_H_
