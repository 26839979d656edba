// Matches as pairs of rays in the body frame: unit directions, moments, feet.
#ifndef RIGEL_CORE_RAYS_H_
#define RIGEL_CORE_RAYS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/core/eigen_types.h"
#include "rigel/core/match.h"
#include "rigel/core/rig.h"

namespace rigel {

// A ray in a body frame: points s + d x, d > 0 in front of the camera.
struct Ray {
  Eigen::Vector3d x = Eigen::Vector3d::UnitZ();  // unit direction x = Q u / |Q u|
  Eigen::Vector3d s = Eigen::Vector3d::Zero();   // camera centre, metres

  // Moment q = s x x (paper section 3.1).
  Eigen::Vector3d Moment() const { return s.cross(x); }

  // Foot of the perpendicular from the body's origin, m = x x q (paper eq. a3): the point
  // at m + l x has the distance d = l - s.x from the camera.
  Eigen::Vector3d Foot() const { return x.cross(Moment()); }
};

// ray1 in f1 and ray2 in f2.
struct RayPair {
  Ray ray1;
  Ray ray2;
};
static_assert(kSameLayoutEverywhere<RayPair>, "no member of Ray may be aligned");

// x is NaN if no ray of the camera has this pixel.
Ray MakeRay(const RigCamera& camera, const Pixel& pixel);

// The match's cameras must be in the rig.
RayPair MakeRayPair(const Rig& rig, const Match& match);

}  // namespace rigel

#endif  // RIGEL_CORE_RAYS_H_
