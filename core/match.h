// A matched image point.
#ifndef RIGEL_CORE_MATCH_H_
#define RIGEL_CORE_MATCH_H_

#include <Eigen/Core>

namespace rigel {

// One landmark seen by camera i = camera1 at time 1 and by camera j = camera2 at time 2.
// Pixels are undistorted. `score` is the matcher's confidence, lower is better (Lowe's ratio);
// 0 if unknown.
struct Match {
  int camera1 = 0;
  Eigen::Vector2d pixel1 = Eigen::Vector2d::Zero();
  int camera2 = 0;
  Eigen::Vector2d pixel2 = Eigen::Vector2d::Zero();
  double score = 0.0;

  bool IsIntra() const { return camera1 == camera2; }
};

}  // namespace rigel

#endif  // RIGEL_CORE_MATCH_H_
