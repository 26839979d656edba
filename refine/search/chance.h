// Whether so many matches could agree on a motion by chance.
#ifndef RIGEL_REFINE_SEARCH_CHANCE_H_
#define RIGEL_REFINE_SEARCH_CHANCE_H_

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// Random points fall into the band of the threshold around an epipolar line with the probability q
// of its share of the image. Matches of another motion fall near it more often, and evenly so: what
// lies between twice and five times the threshold says how often. A fit takes six matches for free,
// and `num_tries` were tried: true if fewer than one in a thousand such searches among matches that
// agree on nothing would find so many, by the Chernoff bound on the binomial tail of the others (a
// contrario, as Moisan and Stival, IJCV 2004).
bool ExceedsChance(const GroupedMatches& matches, const Pose& pose, int num_inliers,
                   double threshold_px, double num_tries);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_CHANCE_H_
