// Projects 1000 seeded points through each camera of camera_cases.h; test/camera_models.py reads
// it.
//
// For each camera a line "camera NAME MODEL WIDTH HEIGHT PARAMETERS", then lines "X Y Z U V".
#include <cstdio>

#include "rigel/test/core/camera_cases.h"

int main() {
  constexpr int kNumPoints = 1000;
  for (const rigel::CameraCase& camera_case : rigel::CameraCases()) {
    const rigel::Camera& camera = camera_case.camera;
    std::printf("camera %s %s %d %d", camera_case.name, rigel::CameraModelName(camera.model),
                camera.width, camera.height);
    for (int k = 0; k < rigel::NumCameraParameters(camera.model); ++k) {
      std::printf(" %.17g", camera.parameters[k]);
    }
    std::printf("\n");
    rigel::Random random(8);
    for (int k = 0; k < kNumPoints; ++k) {
      const Eigen::Vector3d X = rigel::RandomRay(camera_case, &random);
      rigel::Pixel pixel;
      if (!rigel::Project(camera, X, &pixel, nullptr)) return 1;
      std::printf("%.17g %.17g %.17g %.17g %.17g\n", X.x(), X.y(), X.z(), pixel.x(), pixel.y());
    }
  }
  return 0;
}
