// The motion of a rig from matches filled in by hand: two cameras, 16 matches.
#include <cstdio>

#include "rigel/refine/estimate_motion.h"

int main() {
  const auto pinhole = rigel::Camera::Pinhole(400, 400, 320, 240, 640, 480);  // fx fy cx cy, size
  const Eigen::Matrix3d Q = Eigen::Matrix3d::Identity();  // body_from_camera: both look along +z
  rigel::FramePair pair;
  pair.rig.cameras = {{pinhole, Q, {-0.5, 0, 0}}, {pinhole, Q, {0.5, 0, 0}}};  // positions, metres
  pair.matches = {
      {0, {71.3, 124.1}, 0, {48.8, 116.5}},  // camera and pixel at time 1, the same at time 2
      {1, {115.9, 343.1}, 1, {74.2, 360.6}},  {0, {462.7, 440.9}, 1, {428.6, 460.2}},
      {1, {555.0, 277.4}, 0, {592.4, 279.6}}, {0, {416.3, 430.0}, 0, {420.3, 452.6}},
      {1, {151.4, 385.1}, 1, {132.9, 394.8}}, {0, {547.1, 65.2}, 1, {529.8, 58.3}},
      {1, {195.0, 403.3}, 0, {216.2, 421.6}}, {0, {128.0, 348.8}, 0, {108.8, 355.2}},
      {1, {121.2, 443.9}, 1, {100.4, 458.7}}, {0, {136.1, 114.0}, 1, {99.3, 107.3}},
      {1, {346.8, 330.9}, 0, {424.4, 348.2}}, {0, {421.2, 249.8}, 0, {420.9, 251.0}},
      {1, {341.8, 360.6}, 1, {336.8, 370.4}}, {0, {253.3, 187.9}, 1, {225.2, 185.1}},
      {1, {76.1, 260.1}, 0, {73.6, 261.9}},
  };
  pair.prior.axis = Eigen::Vector3d::UnitY();  // optional: the vehicle turns about its vertical

  const rigel::MotionEstimate estimate = rigel::EstimateMotion(rigel::EstimateOptions(), pair);
  if (!estimate.HasMotion()) return std::puts(estimate.message.c_str()), 1;
  const Eigen::Vector3d t = estimate.pose.t;  // with R = estimate.pose.R: X_2 = R X_1 + t
  std::printf("t = (%.2f, %.2f, %.2f) m, rotation sd %.4f rad, |t| %s\n", t.x(), t.y(), t.z(),
              estimate.refine.rotation_sigma,
              estimate.refine.scale_observable ? "observable" : "not observable");
  return 0;
}
