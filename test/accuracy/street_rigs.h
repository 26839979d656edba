// Rigs that drive through the street: what a car carries, from one camera to six.
#ifndef RIGEL_TEST_ACCURACY_STREET_RIGS_H_
#define RIGEL_TEST_ACCURACY_STREET_RIGS_H_

#include <vector>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"
#include "rigel/problems/scenes/street.h"

namespace rigel {

// A camera at s (metres) of a body with x forward and z up, turned to the left by `yaw_deg`.
inline RigCamera CarCamera(const Eigen::Vector3d& s, double yaw_deg, double focal) {
  RigCamera camera;
  camera.intrinsics = Camera::Pinhole(focal, focal, 800.0, 450.0, 1600, 900);
  Eigen::Matrix3d ahead;  // the axes of the camera in the body
  ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  camera.Q = ExpSO3(DegToRad(yaw_deg) * Eigen::Vector3d::UnitZ()) * ahead;
  camera.s = s;
  return camera;
}

// Of a body at the rear axle, x forward and z up.
inline StreetOptions Car(const std::vector<RigCamera>& cameras) {
  StreetOptions street;
  street.axes.down = -Eigen::Vector3d::UnitZ();
  street.axes.forward = Eigen::Vector3d::UnitX();
  street.rig.cameras = cameras;
  return street;
}

inline StreetOptions FrontCamera() { return Car({CarCamera({1.7, 0.0, 1.2}, 0, 1200)}); }

inline StreetOptions FrontStereo() {
  return Car({CarCamera({1.7, 0.3, 1.2}, 0, 1200), CarCamera({1.7, -0.3, 1.2}, 0, 1200)});
}

inline StreetOptions FourCameras() {
  return Car({CarCamera({3.5, 0.0, 0.4}, 0, 700), CarCamera({1.9, 0.95, 0.8}, 90, 700),
              CarCamera({-0.9, 0.0, 0.7}, 180, 700), CarCamera({1.9, -0.95, 0.8}, -90, 700)});
}

inline StreetOptions SixCameras() {
  return Car({CarCamera({1.7, 0.0, 1.2}, 0, 1260), CarCamera({1.5, 0.5, 1.2}, 55, 1260),
              CarCamera({1.0, 0.5, 1.2}, 110, 1260), CarCamera({0.0, 0.0, 1.2}, 180, 800),
              CarCamera({1.0, -0.5, 1.2}, -110, 1260), CarCamera({1.5, -0.5, 1.2}, -55, 1260)});
}

// The body is the left camera: z forward and y down.
inline StreetOptions CameraFrameStereo() {
  StreetOptions street;
  street.ground_m = 1.65;
  for (const double x : {0.0, 0.54}) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(718.0, 718.0, 607.0, 185.0, 1241, 376);
    camera.s.x() = x;
    street.rig.cameras.push_back(camera);
  }
  return street;
}

}  // namespace rigel

#endif  // RIGEL_TEST_ACCURACY_STREET_RIGS_H_
