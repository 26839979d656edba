// Searches for |t| if the matches hardly determine it.
#ifndef RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_
#define RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/prior_residuals.h"

namespace rigel {

// Intra-camera matches determine |t| only through the arms of the cameras, R s - s. The error then
// has local minima in |t|. A stated distance of the body may also be that of two motions. So the
// motion is optimized from several lengths:
// - from half the largest arm, or with inter-camera matches from a small part of the largest
//   baseline, up to where the matches determine |t| only to a factor of about two;
// - from a length at which the arms do not matter, and from those of `lengths`.
// The score that looks at depths decides, together with `prior`. threshold_px and noise_px (1-sigma
// of the matches) are in pixels. True if `pose` changed.
bool SearchScale(const GroupedMatches& matches, double threshold_px, double noise_px,
                 const PriorResiduals& prior, const std::vector<double>& lengths, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_
