// Depths of a match under a motion, and the sign of t.
//
// Epipolar errors do not see t -> -t where scale is not observable; positive depths decide it.
#ifndef RIGEL_CORE_CHEIRALITY_H_
#define RIGEL_CORE_CHEIRALITY_H_

#include "rigel/core/pose.h"
#include "rigel/core/rays.h"

namespace rigel {

// Distances from the cameras along the two rays.
struct Depths {
  double d1 = 0.0;  // metres, along ray1 in f1
  double d2 = 0.0;  // metres, along ray2 in f2
  bool BothPositive() const { return d1 > 0 && d2 > 0; }
};

// The points of closest approach of the two rays under `pose`: least squares of
// R (s_i + d1 x_i) + t = s_j + d2 x_j. False, and depths left alone, where the rays are parallel
// (sine of the parallax below 1e-9): such a match has no finite depth.
bool TriangulateDepths(const Pose& pose, const RayPair& rays, Depths* depths);

// +1 if the match lies in front of both cameras under `pose`, -1 if behind both (as it does
// under the wrong sign of t), 0 if neither or if the parallax is zero.
int CheiralityVote(const Pose& pose, const RayPair& rays);

}  // namespace rigel

#endif  // RIGEL_CORE_CHEIRALITY_H_
