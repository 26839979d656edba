#include "rigel/core/cheirality.h"

namespace rigel {
namespace {

// Numerators of the depths and their common denominator sin^2(parallax), so that signs need no
// division.
void DepthNumerators(const Pose& pose, const RayPair& rays, double* n1, double* n2, double* sin2) {
  const Eigen::Vector3d g = pose.R * rays.ray1.x;
  const Eigen::Vector3d b = pose.R * rays.ray1.s + pose.t - rays.ray2.s;
  const Eigen::Vector3d& f = rays.ray2.x;
  // b + d1 g = d2 f, crossed with f and with g: d1 n = f x b and d2 n = g x b for n = g x f.
  const Eigen::Vector3d n = g.cross(f);
  *sin2 = n.squaredNorm();
  *n1 = f.cross(b).dot(n);
  *n2 = g.cross(b).dot(n);
}

}  // namespace

bool TriangulateDepths(const Pose& pose, const RayPair& rays, Depths* depths) {
  double n1 = 0, n2 = 0, sin2 = 0;
  DepthNumerators(pose, rays, &n1, &n2, &sin2);
  if (!(sin2 > 1e-18)) return false;
  depths->d1 = n1 / sin2;
  depths->d2 = n2 / sin2;
  return true;
}

Cheirality TestCheirality(const Pose& pose, const RayPair& rays, double min_sin_parallax) {
  double n1 = 0, n2 = 0, sin2 = 0;
  DepthNumerators(pose, rays, &n1, &n2, &sin2);
  if (!(sin2 > min_sin_parallax * min_sin_parallax)) return Cheirality::kUndecided;
  if (n1 > 0 && n2 > 0) return Cheirality::kInFront;
  if (n1 < 0 && n2 < 0) return Cheirality::kBehind;
  return Cheirality::kMixed;
}

}  // namespace rigel
