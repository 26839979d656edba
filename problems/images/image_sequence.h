// Images of a calibrated rig with what is known about each frame: what rigel_match makes match
// files of.
#ifndef RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_
#define RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/pose.h"
#include "rigel/core/rig.h"

namespace rigel {

// Lens distortion of normalized image points, r2 = x^2 + y^2:
//   x' = x (1 + k1 r2 + k2 r2^2) + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y (1 + k1 r2 + k2 r2^2) + 2 p2 x y + p1 (r2 + 2 y^2)
struct RadialTangential {
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0;

  Eigen::Vector2d Distort(const Eigen::Vector2d& undistorted) const {
    const double x = undistorted.x(), y = undistorted.y();
    const double r2 = x * x + y * y;
    const double radial = 1.0 + (k1 + k2 * r2) * r2;
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)};
  }
};

struct ImageCamera {
  // intrinsics.width and height are 0 where only the images tell them.
  RigCamera camera;
  std::optional<RadialTangential> distortion;  // none: the images are undistorted
};

struct ImageFrame {
  std::vector<std::string> images;  // paths, one a camera; whether they are there is not checked
  std::optional<double> time;       // seconds
  std::optional<Pose> world_from_body;  // ground truth
};

struct ImageSequence {
  std::string name;
  std::vector<ImageCamera> cameras;
  std::vector<ImageFrame> frames;
  Eigen::Vector3d world_down = Eigen::Vector3d::UnitY();  // unit; the world of world_from_body
  // What a user should know and is no error: frames left out, frames without ground truth.
  std::vector<std::string> notes;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_
