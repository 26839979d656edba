// Another |t| for matches that hardly determine it.
#ifndef RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_
#define RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// What the arms of the cameras (R s - s) say of |t| has local minima: a start with too long a t
// runs on through infinity, where 1/|t| changes its sign, and stops there. So the motion is
// optimized again from several lengths: from half the largest arm (with inter-camera matches from
// a small part of their baselines) up to where the matches could not tell |t| to a factor of about
// two, and from one at which the arms do not matter. noise_px is the 1-sigma noise of the matches.
// The best is taken by the score that looks at depths; of two that differ by less than an outlier
// the longer t, since vehicles move by more than their turning moves a camera and a short t bends
// its direction to fit the noise. True if `pose` changed.
bool SearchScale(const GroupedMatches& matches, double threshold_px, double noise_px, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_
