// The sign of t by cheirality, and a start for |t| where the matches hardly determine it.
//
// Epipolar errors do not see the sign of t where scale is not observable. Worse, intra-camera
// matches tell of |t| only through the arms R s - s of cameras off the body's origin, and a minimal
// sample's |t| is mostly noise. Where it is so small that the arms decide, there are false minima:
// the baseline R s - s + t of one camera points along its true one and that of another against it,
// which costs nothing in epipolar error (forward motion with yaw). Depths tell them apart.
#ifndef RIGEL_REFINE_SEARCH_SIGN_AND_SCALE_H_
#define RIGEL_REFINE_SEARCH_SIGN_AND_SCALE_H_

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// As many matches tell (EvenSubset): both functions look at all that they get.
inline constexpr size_t kSignSubset = 100;

// Flips t if the matches that fit lie behind their cameras. Counts those with a parallax that noise
// cannot make (twice the threshold). False
// if they contradict either sign, so that the motion is physically impossible; where nothing can be
// decided (no parallax) that is true, and t as it was.
bool ResolveSign(const GroupedMatches& matches, double threshold_px, Pose* pose);

// Chooses among t times +-4^k, k = 0..8, and the mean direction of the cameras' baselines, each
// with the sign that its own matches want, at the same lengths: the one of least truncated squared
// Sampson error in which a match behind a camera counts as an outlier. Too large a |t| does no
// harm where scale is not observable.
void ResolveSignAndScale(const GroupedMatches& matches, double threshold_px, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_SIGN_AND_SCALE_H_
