#include "rigel/problems/rigs/field_of_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rigel {
namespace {

// From the optical axis to the ray of a pixel, to the right; nothing if the pixel has no ray.
std::optional<double> AngleAt(const Camera& camera, double u) {
  Eigen::Vector3d ray;
  if (!Unproject(camera, {u, camera.cy()}, &ray)) return std::nullopt;
  return std::atan2(ray.x(), ray.z());
}

// Of the last pixel with a ray on the way from `inside`, which has one, to `edge`.
double AngleTowards(const Camera& camera, double inside, double edge) {
  if (const std::optional<double> angle = AngleAt(camera, edge)) return *angle;
  double angle = AngleAt(camera, inside).value_or(0.0);
  constexpr int kHalvings = 40;  // of the image's width: far below a pixel
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (inside + edge);
    const std::optional<double> there = AngleAt(camera, middle);
    (there ? inside : edge) = middle;
    if (there) angle = *there;
  }
  return angle;
}

}  // namespace

double HorizontalFieldOfView(const Camera& camera) {
  if (camera.width < 1 || camera.height < 1) return 0.0;
  const double left = -0.5, right = camera.width - 0.5;
  const double inside = std::clamp(camera.cx(), left, right);
  return AngleTowards(camera, inside, right) - AngleTowards(camera, inside, left);
}

}  // namespace rigel
