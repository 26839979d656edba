// A textured plane seen by a rig with distorted lenses: images whose matches have a known place.
#ifndef RIGEL_TEST_PROBLEMS_IMAGES_PLANE_SCENE_H_
#define RIGEL_TEST_PROBLEMS_IMAGES_PLANE_SCENE_H_

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "rigel/problems/images/image_sequence.h"

namespace rigel {

// The world is that of EuRoC, +z up. The plane is some 4 m before the cameras, which look along +x.
class PlaneScene {
 public:
  PlaneScene();

  // Two cameras of 376 x 240 pixels as they sit on EuRoC's IMU, with its lenses.
  const std::vector<ImageCamera>& cameras() const { return cameras_; }

  // Where frame k is: 5 cm and half a degree from one to the next.
  static Pose WorldFromBody(int frame);

  // What the camera sees, distorted if it is.
  cv::Mat Render(const ImageCamera& camera, const Pose& world_from_body) const;

  // The pixel in camera j at time 2 of what is at `pixel1` in camera i at time 1; NaN if there is
  // none.
  Eigen::Vector2d Transfer(const RigCamera& camera1, const Pose& world_from_body1,
                           const Eigen::Vector2d& pixel1, const RigCamera& camera2,
                           const Pose& world_from_body2) const;

 private:
  Eigen::Vector3d Intersect(const Eigen::Vector3d& center, const Eigen::Vector3d& ray) const;

  std::vector<ImageCamera> cameras_;
  cv::Mat texture_;
};

// Time stamp of frame k, nanoseconds.
int64_t PlaneSceneTime(int frame);

// sensor.yaml of EuRoC.
std::string SensorYaml(const ImageCamera& camera);

void WriteFile(const std::string& path, const std::string& text);
void WriteImage(const std::string& path, const cv::Mat& image);

// Writes directory/mav0 with frames 0..num_frames-1, ground truth included.
void WriteEurocScene(const PlaneScene& scene, int num_frames, const std::string& directory);

// Writes directory/sequences/NAME and directory/poses/NAME.txt, from the same poses of the left
// camera; without distortion.
void WriteKittiScene(const PlaneScene& scene, int num_frames, const std::string& name,
                     const std::string& directory);

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_IMAGES_PLANE_SCENE_H_
