// Whether so many matches could agree on a motion by chance.
#ifndef RIGEL_REFINE_CHANCE_H_
#define RIGEL_REFINE_CHANCE_H_

#include "rigel/minimal/grouped_matches.h"

namespace rigel {

// Random points fall into the band of the threshold around an epipolar line with the probability q
// of its share of the image, a fit takes six of them for free, and `num_tries` were tried: true if
// the Chernoff bound on the binomial tail of the others beats that number (a contrario, as Moisan
// and Stival, IJCV 2004).
bool ExceedsChance(const GroupedMatches& matches, int num_inliers, double threshold_px,
                   double num_tries);

}  // namespace rigel

#endif  // RIGEL_REFINE_CHANCE_H_
