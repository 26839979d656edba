// Images of a calibrated rig, with the time and the true pose of each frame: the input of
// rigel_match.
#ifndef RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_
#define RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
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

// Frames by their numbers, 0 to size() - 1. Numbers that a data set leaves out have no frame and
// take no memory.
class ImageFrames {
 public:
  // One more than the last number.
  size_t size() const { return numbers_.empty() ? 0 : static_cast<size_t>(numbers_.back()) + 1; }

  // The numbers that have a frame, ascending.
  const std::vector<int>& numbers() const { return numbers_; }

  // The number is above all others.
  void Add(int number, ImageFrame frame) {
    numbers_.push_back(number);
    frames_.push_back(std::move(frame));
  }
  void push_back(ImageFrame frame) { Add(static_cast<int>(size()), std::move(frame)); }

  // Null where there is none.
  const ImageFrame* Find(int number) const {
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), number);
    return found == numbers_.end() || *found != number ? nullptr
                                                       : &frames_[found - numbers_.begin()];
  }

  // There must be one.
  const ImageFrame& operator[](size_t number) const { return *Find(static_cast<int>(number)); }
  ImageFrame& operator[](size_t number) {
    return const_cast<ImageFrame&>(std::as_const(*this)[number]);
  }

  // Over the frames that are there.
  std::vector<ImageFrame>::const_iterator begin() const { return frames_.begin(); }
  std::vector<ImageFrame>::const_iterator end() const { return frames_.end(); }

 private:
  std::vector<int> numbers_;
  std::vector<ImageFrame> frames_;
};

struct ImageSequence {
  std::string name;
  std::vector<ImageCamera> cameras;
  ImageFrames frames;
  // Where a camera's image of a frame that is not there would be; empty if all are there.
  std::function<std::string(int frame, int camera)> image_path;
  Eigen::Vector3d world_down = Eigen::Vector3d::UnitY();  // unit; the world of world_from_body
  // The tolerance if images of one frame differ in time: "default", or milliseconds. It determines
  // which images are a frame, and so the numbers of the frames.
  std::string sync_tolerance;
  // Notes for the user that are no errors: frames left out, frames without ground truth, cameras
  // that are not used, differences of the cameras' time stamps.
  std::vector<std::string> notes;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_
