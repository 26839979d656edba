// The motion of a rig of your own: cameras, matches and what the IMU says, filled in by hand.
#include <cmath>
#include <cstdio>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/refine/estimate_motion.h"

namespace {

// A car: the body frame is at the rear axle, x forward, y left, z up. Two cameras behind the
// windscreen look ahead, 0.8 m apart.
rigel::Rig CarRig() {
  rigel::RigCamera camera;
  camera.intrinsics = rigel::Camera::Pinhole(800, 800, 640, 360, 1280, 720);  // fx fy cx cy, size
  // X_body = Q X_camera + s. The columns of Q are the camera's right, down and forward.
  camera.Q << 0, 0, 1,  //
      -1, 0, 0,         //
      0, -1, 0;
  rigel::Rig rig;
  for (const double left : {0.4, -0.4}) {
    camera.s = {1.8, left, 1.3};
    rig.cameras.push_back(camera);
  }
  return rig;
}

rigel::Pixel Project(const rigel::RigCamera& camera, const Eigen::Vector3d& X_body) {
  rigel::Pixel pixel;
  rigel::Project(camera.intrinsics, camera.Q.transpose() * (X_body - camera.s), &pixel);
  return pixel;
}

// Stands for your matcher: pixels of the same point at time 1 and at time 2.
std::vector<rigel::Match> Matches(const rigel::Rig& rig, const rigel::Pose& truth) {
  std::vector<rigel::Match> matches;
  for (int k = 0; k < 120; ++k) {
    const int column = k % 5, row = k / 5 % 5, layer = k / 25;
    const Eigen::Vector3d X1(12 + 5 * column, -6 + 3 * row, 4 - layer);
    rigel::Match match;
    match.camera1 = k % 2;
    match.pixel1 = Project(rig.cameras[match.camera1], X1);
    match.camera2 = k % 3 == 0 ? 1 - match.camera1 : match.camera1;  // a third between cameras
    match.pixel2 = Project(rig.cameras[match.camera2], truth * X1);
    match.pixel2.x() += 0.3 * std::sin(7.0 * k);                     // noise
    match.pixel2.y() += k % 10 == 9 ? 40 : 0.3 * std::cos(5.0 * k);  // a wrong match in ten
    matches.push_back(match);
  }
  return matches;
}

}  // namespace

int main() {
  // Ahead by 1.2 m, and 2 degrees to the left. X_2 = R X_1 + t: points come nearer.
  rigel::Pose truth;
  truth.R = rigel::ExpSO3(Eigen::Vector3d(0, 0, -0.035));
  truth.t = truth.R * Eigen::Vector3d(-1.2, 0, 0);

  rigel::FramePair pair;
  pair.rig = CarRig();
  pair.matches = Matches(pair.rig, truth);
  pair.prior.gravity1 = pair.prior.gravity2 = Eigen::Vector3d(0, 0, -1);  // down, from the IMU

  const rigel::MotionEstimate estimate = rigel::EstimateMotion(rigel::EstimateOptions(), pair);
  if (!estimate.HasMotion()) {
    std::printf("%s\n", estimate.message.c_str());
    return 1;
  }
  const Eigen::Vector3d turn = rigel::LogSO3(estimate.pose.R);
  const Eigen::Vector3d& t = estimate.pose.t;
  std::printf("solver %s, %d of %zu matches are inliers\n", estimate.solver.c_str(),
              estimate.num_inliers, pair.matches.size());
  std::printf("turn %.4f rad +- %.4f\n", turn.norm(), estimate.refine.rotation_sigma);
  std::printf("t (%.3f, %.3f, %.3f) m, |t| %s\n", t.x(), t.y(), t.z(),
              estimate.refine.scale_observable ? "observable" : "not observable");
  return (t - truth.t).norm() < 0.05 && (turn - rigel::LogSO3(truth.R)).norm() < 0.002 ? 0 : 1;
}
