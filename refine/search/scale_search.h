// Searches for |t| if the matches hardly determine it.
#ifndef RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_
#define RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// Intra-camera matches determine |t| only through the arms of the cameras, R s - s. The error then
// has local minima in |t|. From too long a start, least squares runs through infinity, where
// 1 / |t| changes its sign, and stops there. So the motion is optimized from several lengths:
// - from half the largest arm, or with inter-camera matches from a small part of the largest
//   baseline, up to where the matches determine |t| only to a factor of about two;
// - from a length at which the arms do not matter.
// The score that looks at depths decides. If two scores differ by less than one outlier, the longer
// t is taken: vehicles move farther than a turn moves a camera, and a short t adapts its direction
// to the noise.
// threshold_px and noise_px (1-sigma of the matches) are in pixels. True if `pose` changed.
bool SearchScale(const GroupedMatches& matches, double threshold_px, double noise_px, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_SCALE_SEARCH_H_
