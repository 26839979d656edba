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

// Sine of the parallax below which rays count as parallel: rounding decides what is left of it.
inline constexpr double kNoParallax = 1e-9;

// The points of closest approach of the two rays under `pose`: least squares of
// R (s_i + d1 x_i) + t = s_j + d2 x_j. False, and depths left alone, where the rays are parallel
// (sine of the parallax below kNoParallax): such a match has no finite depth.
bool TriangulateDepths(const Pose& pose, const RayPair& rays, Depths* depths);

// Where a match lies under a motion.
enum class Cheirality {
  kUndecided,  // the sine of its parallax is too small: image noise decides the depths
  kInFront,    // of both cameras
  kBehind,     // both, as under the wrong sign of t
  kMixed,      // in front of one, behind the other
};

Cheirality TestCheirality(const Pose& pose, const RayPair& rays,
                          double min_sin_parallax = kNoParallax);

// The vote of a match for a pose against its -t: 1 for kInFront, -1 for kBehind, else 0.
int CheiralityVote(const Pose& pose, const RayPair& rays);

}  // namespace rigel

#endif  // RIGEL_CORE_CHEIRALITY_H_
