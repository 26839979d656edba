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

struct ImageCamera {
  // What match files say. intrinsics.width and height are 0 where only the images tell them.
  RigCamera camera;
  // The lens that took the images, where pixels are moved to those of `camera`, a pinhole. None:
  // the pixels of `camera` are those of the images.
  std::optional<Camera> lens;
};

struct ImageFrame {
  // Paths, one a camera; whether they are there is not checked. Empty: the camera has no image, and
  // the frame consists of those of the others.
  std::vector<std::string> images;
  std::optional<double> time;           // seconds
  std::optional<Pose> world_from_body;  // ground truth
  std::vector<std::string> masks = {};  // paths, one a camera, empty where it has none; or no entry
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
  // Pairs i < j of cameras whose images are matched with each other. Each camera is always matched
  // with itself at another time.
  std::vector<std::pair<int, int>> camera_pairs;
  std::optional<Eigen::Vector3d> forward;  // of the body frame, unit, if it is known
  ImageFrames frames;
  // Where a camera's image of a frame that is not there would be; empty if all are there.
  std::function<std::string(int frame, int camera)> image_path;
  Eigen::Vector3d world_down = Eigen::Vector3d::UnitY();  // unit; the world of world_from_body
  // What determines which images are a frame, and so the numbers of the frames: a name and a value
  // each. Runs that fill one directory must agree in it.
  std::vector<std::string> settings;
  // Notes for the user that are no errors: frames left out, frames without ground truth, cameras
  // that are not used, differences of the cameras' time stamps.
  std::vector<std::string> notes;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_IMAGE_SEQUENCE_H_
