// Cameras of each model, as real calibrations have them, and rays over their fields of view.
#ifndef RIGEL_TEST_CORE_CAMERA_CASES_H_
#define RIGEL_TEST_CORE_CAMERA_CASES_H_

#include <cmath>
#include <ostream>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/camera.h"
#include "rigel/core/random.h"

namespace rigel {

inline constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;

struct CameraCase {
  const char* name;
  double half_view_deg;  // rays up to this angle are in the domain
  Camera camera;
};

inline void PrintTo(const CameraCase& camera_case, std::ostream* out) { *out << camera_case.name; }

inline std::vector<CameraCase> CameraCases() {
  using M = CameraModel;
  return {
      {"nuscenes", 42, {M::kPinhole, {1266.4, 1265.1, 816.3, 491.5}, 1600, 900}},
      {"phone", 35, {M::kSimplePinhole, {3100.0, 2015.5, 1510.2}, 4032, 3024}},
      {"dashcam", 50, {M::kSimpleRadial, {720.0, 640.0, 360.0, -0.12}, 1280, 720}},
      {"pincushion", 45, {M::kSimpleRadial, {720.0, 640.0, 360.0, 0.08}, 1280, 720}},
      {"gopro", 43, {M::kRadial, {880.0, 955.0, 542.0, -0.26, 0.06}, 1920, 1080}},
      {"gopro_wide", 65, {M::kRadial, {480.0, 955.0, 542.0, -0.11, 0.0061}, 1920, 1080}},
      {"kitti_raw_k2",
       42,
       {M::kOpencv,
        {984.2439, 980.8141, 690.0, 233.1966, -0.3728755, 0.2037299, 2.219027e-3, 1.383707e-3},
        1392,
        512}},
      {"euroc",
       42,
       {M::kOpencv,
        {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 1.9359e-4, 1.762e-5},
        752,
        480}},
      {"decentred",
       40,
       {M::kOpencv, {500.0, 480.0, 331.0, 245.0, -0.15, 0.03, 0.012, -0.015}, 640, 480}},
      {"kitti_raw",
       42,
       {M::kFullOpencv,
        {984.2439, 980.8141, 690.0, 233.1966, -0.3728755, 0.2037299, 2.219027e-3, 1.383707e-3,
         -0.07233722},
        1392,
        512}},
      {"kinect",
       52,
       {M::kFullOpencv,
        {916.4, 915.9, 958.6, 547.2, 0.5107, -2.6695, 4.6e-4, -1.3e-4, 1.5548, 0.3904, -2.4925,
         1.4802},
        1920,
        1080}},
      {"tumvi",
       97,
       {M::kOpencvFisheye,
        {190.978477, 190.973307, 254.931706, 256.897443, 3.482389e-3, 7.150348e-4, -2.053236e-3,
         2.029367e-4},
        512,
        512}},
      {"surround",
       95,
       {M::kOpencvFisheye,
        {329.6, 329.2, 640.4, 481.7, -0.0271, -0.0073, 0.0021, -3.1e-4},
        1280,
        966}},
      {"barrel_fisheye", 100, {M::kSimpleRadialFisheye, {340.0, 640.0, 483.0, -0.05}, 1280, 966}},
      {"security", 92, {M::kRadialFisheye, {560.0, 960.0, 960.0, -0.035, 0.0031}, 1920, 1920}},
      {"eth3d",
       70,
       {M::kThinPrismFisheye,
        {541.7, 541.6, 553.8, 393.4, 0.21047, 0.21102, -5.36e-6, 1.042e-3, -0.158023, 0.22185,
         -5.4e-4, -1.11e-4},
        1109,
        780}},
      {"thin_prism",
       95,
       {M::kThinPrismFisheye,
        {290.0, 288.0, 479.0, 302.0, -0.045, 0.012, 4e-4, -3e-4, -0.006, 6e-4, 8e-4, -5e-4},
        960,
        604}},
      {"tum_mono", 60, {M::kFov, {342.9, 428.6, 314.9, 246.1, 0.897966}, 640, 480}},
      {"tumvi_fov", 100, {M::kFov, {157.2, 157.3, 254.5, 257.3, 0.9204}, 512, 512}},
      {"small_omega", 55, {M::kFov, {400.0, 401.0, 322.0, 241.0, 1e-3}, 640, 480}},
      {"mei",
       97,
       {M::kOmni, {0.82, 340.0, 341.0, 318.0, 242.0, -0.02, 0.004, 3e-4, -2e-4}, 640, 480}},
      {"mirror",
       105,
       {M::kOmni, {1.37, 660.0, 655.0, 1012.0, 508.0, -0.13, 0.05, 1e-3, 2e-3}, 2040, 1086}},
      {"tumvi_ds",
       100,
       {M::kDoubleSphere,
        {-0.172131, 0.593118, 158.286, 158.2743, 254.961166, 256.889439},
        512,
        512}},
      {"ds_below_half",
       100,
       {M::kDoubleSphere, {0.31, 0.42, 210.0, 212.0, 320.0, 240.0}, 640, 480}},
      {"tumvi_eucm",
       100,
       {M::kEucm, {0.629106, 1.041807, 191.147998, 191.131509, 254.958577, 256.881547}, 512, 512}},
      {"eucm_below_half", 90, {M::kEucm, {0.47, 0.8, 210.0, 212.0, 320.0, 240.0}, 640, 480}},
  };
}

// Of random length, uniform over the angle to the axis.
inline Eigen::Vector3d RandomRay(const CameraCase& camera_case, Random* random) {
  const double angle = random->Uniform(0, camera_case.half_view_deg * kRadiansPerDegree);
  const double about = random->Uniform(0, 360.0 * kRadiansPerDegree);
  const double length = random->Uniform(0.3, 40.0);
  return length * Eigen::Vector3d(std::sin(angle) * std::cos(about),
                                  std::sin(angle) * std::sin(about), std::cos(angle));
}

}  // namespace rigel

#endif  // RIGEL_TEST_CORE_CAMERA_CASES_H_
