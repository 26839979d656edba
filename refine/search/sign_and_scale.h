// The sign of t by cheirality, and a start for |t| if the matches hardly determine it.
//
// If scale is not observable, epipolar errors do not depend on the sign of t. Intra-camera matches
// determine |t| only through the arms R s - s of cameras off the body's origin, so the |t| of a
// minimal sample is mostly noise. If |t| is so small that the arms dominate, there are false
// minima. The baseline R s - s + t of one camera then points along its true one, and that of
// another against it, without any epipolar error (for example in forward motion with yaw). Only the
// depths of the points tell such minima from the true one.
#ifndef RIGEL_REFINE_SEARCH_SIGN_AND_SCALE_H_
#define RIGEL_REFINE_SEARCH_SIGN_AND_SCALE_H_

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// Matches that are enough (EvenSubset). Both functions look at all matches that they are given.
inline constexpr size_t kSignSubset = 100;

// Flips t if most matches that fit lie behind their cameras. Only matches with a larger parallax
// than noise can make (twice the threshold) count. False if the matches contradict both signs: the
// motion is physically impossible. If nothing can be decided (no parallax), true and t unchanged.
bool ResolveSign(const GroupedMatches& matches, double threshold_px, Pose* pose);

// Chooses t among +-4^k t, k = 0..8, and the mean direction of the cameras' baselines at the same
// lengths. In the mean each baseline has the sign that its own matches support. The score is the
// truncated squared Sampson error, with matches behind a camera as outliers. Too large a |t| does
// no harm if scale is not observable.
void ResolveSignAndScale(const GroupedMatches& matches, double threshold_px, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_SIGN_AND_SCALE_H_
