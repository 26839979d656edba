#include "rigel/refine/search/chance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace rigel {

bool ExceedsChance(const GroupedMatches& matches, const Pose& pose, int num_inliers,
                   int num_matches, double threshold_px, double num_tries) {
  constexpr int kFree = 6;
  constexpr double kFalseAlarms = 1e-3;
  const int n = num_matches - kFree;
  const int k = num_inliers - kFree;
  if (n <= 0 || k <= 0) return false;
  // An epipolar plane is no line in the image of a fisheye: an equidistant one of 180 degrees shows
  // half of a great circle, of up to pi / 2 of the diameter. Its image circle has pi / 4 of the
  // square about it. So the band is up to twice as large a share of the image.
  constexpr double kBend = 2.0;
  double q = 0.0;
  for (const MatchGroup& group : matches.groups()) {
    const Camera& c = matches.rig().cameras[group.camera2].intrinsics;
    // If matches lie beyond the stated image size, the size is taken from them.
    double width = c.width > 0 ? c.width : std::max(2.0 * std::abs(c.cx()), c.fx());
    double height = c.height > 0 ? c.height : std::max(2.0 * std::abs(c.cy()), c.fy());
    Eigen::AlignedBox2d extent;
    for (int m = group.begin; m < group.begin + group.size; ++m) {
      extent.extend(matches.matches()[m].pixel2);
    }
    width = std::max(width, extent.sizes().x());
    height = std::max(height, extent.sizes().y());
    const double band = 2.0 * threshold_px * std::hypot(width, height);
    const double bend = c.IsPinhole() ? 1.0 : kBend;
    q += std::min(1.0, bend * band / (width * height)) * group.size / matches.size();
  }
  constexpr double kNoBound = std::numeric_limits<double>::infinity();
  constexpr double kNear = 2.0, kFar = 5.0;  // thresholds
  int near = 0, far = 0;
  matches.Score(pose, kNear * threshold_px, kNoBound, &near);
  matches.Score(pose, kFar * threshold_px, kNoBound, &far);
  q = std::max(q, (far - near) / ((kFar - kNear) * matches.size()));
  // Random matches are denser at the best motion than in the band beside it, by up to 1.2 times
  // [rigel_benchmark --ransac=hostile]. More matches do not reduce this factor.
  constexpr double kDenser = 1.5;
  q *= kDenser;
  const double share = k / static_cast<double>(n);
  if (share <= q) return false;
  const double divergence =
      share * std::log(share / q) +
      (share < 1.0 ? (1.0 - share) * std::log((1.0 - share) / (1.0 - q)) : 0.0);
  return n * divergence > std::log(num_tries / kFalseAlarms);
}

}  // namespace rigel
