#include "rigel/core/cheirality.h"

#include "rigel/core/depth_terms.h"
#include "rigel/core/epipolar.h"

namespace rigel {
namespace {

DepthTerms TermsOfMatch(const Pose& pose, const RayPair& rays) {
  const Eigen::Vector3d g = pose.R * rays.ray1.x;
  const Eigen::Vector3d& f = rays.ray2.x;
  const Eigen::Vector3d b = Baseline(pose, rays.ray1.s, rays.ray2.s);
  return DepthTermsOf(g[0], g[1], g[2], f[0], f[1], f[2], b[0], b[1], b[2]);
}

}  // namespace

bool TriangulateDepths(const Pose& pose, const RayPair& rays, Depths* depths) {
  const DepthTerms terms = TermsOfMatch(pose, rays);
  if (!(terms.sin2 > kNoParallax * kNoParallax)) return false;
  depths->d1 = terms.n1 / terms.sin2;
  depths->d2 = terms.n2 / terms.sin2;
  return true;
}

Cheirality TestCheirality(const Pose& pose, const RayPair& rays, double min_sin_parallax) {
  const DepthTerms terms = TermsOfMatch(pose, rays);
  if (!(terms.sin2 > min_sin_parallax * min_sin_parallax)) return Cheirality::kUndecided;
  if (terms.n1 > 0 && terms.n2 > 0) return Cheirality::kInFront;
  if (terms.n1 < 0 && terms.n2 < 0) return Cheirality::kBehind;
  return Cheirality::kMixed;
}

int CheiralityVote(const Pose& pose, const RayPair& rays) {
  const Cheirality c = TestCheirality(pose, rays);
  return (c == Cheirality::kInFront) - (c == Cheirality::kBehind);
}

}  // namespace rigel
