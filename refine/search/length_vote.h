// The length |t| that the matches between different cameras vote for.
//
// With the rotation and the direction of t known, the constraint of such a match is linear in |t|:
// each match has one length that makes it exact. Samples of a few matches that are mostly of one
// camera never find the length of a surround rig, and a fit from a wrong one ends at a false
// minimum. All matches together tell it.
#ifndef RIGEL_REFINE_SEARCH_LENGTH_VOTE_H_
#define RIGEL_REFINE_SEARCH_LENGTH_VOTE_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// The lengths for which most matches near them vote, ascending, with the rotation and the direction
// of `pose`, whose t must not be zero. Outliers vote too, and not evenly: the score decides which
// of these lengths is right. `noise_px` is that of the pixels: a match has a vote if it knows its
// length to a fifth.
std::vector<double> VoteOnLength(const GroupedMatches& matches, const Pose& pose, double noise_px);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_LENGTH_VOTE_H_
