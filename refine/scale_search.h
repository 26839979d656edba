// A start for |t| where the matches hardly determine it.
#ifndef RIGEL_REFINE_SCALE_SEARCH_H_
#define RIGEL_REFINE_SCALE_SEARCH_H_

#include "rigel/core/pose.h"
#include "rigel/minimal/grouped_matches.h"

namespace rigel {

// Intra-camera matches tell of |t| only through the arms R s - s of the cameras off the body's
// origin, and a minimal sample's |t| is mostly noise: far too small, it lets those arms bend the
// epipolar lines; too large does no harm. Multiplies t by the factor 4^k, k = 0..6, of the least
// truncated Sampson score.
void ChooseTranslationScale(const GroupedMatches& matches, double threshold_px, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_REFINE_SCALE_SEARCH_H_
