// Tests whether random matches could agree with a motion as often.
#ifndef RIGEL_REFINE_SEARCH_CHANCE_H_
#define RIGEL_REFINE_SEARCH_CHANCE_H_

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// True if `num_inliers` matches are more than chance explains: fewer than one search in a thousand
// among random matches would find so many. The probability is the Chernoff bound of a binomial
// tail (a contrario, Moisan and Stival, IJCV 2004).
//
// q is the probability that one random match lies within threshold_px (pixels) of its epipolar
// line: the share of the image that this band takes. Matches of another motion lie near the line
// more often. So q is at least what the matches between twice and five times the threshold suggest.
// Six matches are not counted, since any six can be fitted. `num_tries` is the number of motions
// that were tried. `num_inliers` and `num_matches` are those of different image points
// (shared_pixels.h).
bool ExceedsChance(const GroupedMatches& matches, const Pose& pose, int num_inliers,
                   int num_matches, double threshold_px, double num_tries);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_CHANCE_H_
