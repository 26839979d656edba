#include "rigel/problems/images/view_overlap.h"

#include <algorithm>

namespace rigel {
namespace {

// Metres from the camera: what is beside a car, across a street, and as good as infinitely far.
constexpr double kDistances[] = {3.0, 15.0, 10000.0};
constexpr int kColumns = 48, kRows = 32;  // of the pixels of an image that are tried
// Of the pixels of one camera. Less is a stripe at the border, where features are few.
constexpr double kLeastShare = 0.02;
// Cosine of an angle to the optical axis, 60 degrees: a lens that sees further is a fisheye, whose
// image is a circle.
constexpr double kFisheyeCosine = 0.5;

// Whether the camera sees the unit ray of its own frame at this pixel. The corners of a fisheye's
// image are black, though its model goes on there: the circle is as wide as the longer side.
bool Sees(const Camera& camera, const Pixel& pixel, const Eigen::Vector3d& ray) {
  if (!camera.InImage(pixel)) return false;
  const double radius = std::max(camera.width, camera.height) / 2.0;
  return ray.z() > kFisheyeCosine || (pixel - Pixel(camera.cx(), camera.cy())).norm() <= radius;
}

}  // namespace

double ViewShare(const Rig& rig, int i, int j) {
  const RigCamera& from = rig.cameras[i];
  const RigCamera& to = rig.cameras[j];
  std::vector<Eigen::Vector3d> rays;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Pixel pixel((column + 0.5) / kColumns * from.intrinsics.width,
                        (row + 0.5) / kRows * from.intrinsics.height);
      Eigen::Vector3d ray;
      if (Unproject(from.intrinsics, pixel, &ray) && Sees(from.intrinsics, pixel, ray)) {
        rays.emplace_back(from.Q * ray);
      }
    }
  }
  if (rays.empty()) return 0.0;
  double most = 0.0;
  for (const double distance : kDistances) {
    const auto is_seen = [&](const Eigen::Vector3d& ray) {
      Pixel pixel;
      const Eigen::Vector3d X = to.Q.transpose() * (from.s + distance * ray - to.s);
      return Project(to.intrinsics, X, &pixel) && Sees(to.intrinsics, pixel, X.normalized());
    };
    const auto seen = std::count_if(rays.begin(), rays.end(), is_seen);
    most = std::max(most, static_cast<double>(seen) / static_cast<double>(rays.size()));
  }
  return most;
}

std::vector<std::pair<int, int>> OverlappingCameras(const Rig& rig) {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < rig.size(); ++i) {
    for (int j = i + 1; j < rig.size(); ++j) {
      if (std::max(ViewShare(rig, i, j), ViewShare(rig, j, i)) >= kLeastShare) {
        pairs.emplace_back(i, j);
      }
    }
  }
  return pairs;
}

}  // namespace rigel
