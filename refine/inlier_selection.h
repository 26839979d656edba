// Which matches a refinement takes as inliers of a motion.
#ifndef RIGEL_REFINE_INLIER_SELECTION_H_
#define RIGEL_REFINE_INLIER_SELECTION_H_

#include <vector>

#include "rigel/core/pose.h"
#include "rigel/minimal/grouped_matches.h"

namespace rigel {

// 1 for the matches of a Sampson error below the gate that do not lie behind a camera and are no
// likelier outliers, else 0, in grouped order; returns their number. `squared_errors`, pixels^2,
// and `inliers` are resized. `pose` must be at a minimum of its inliers by the gate alone: where it
// is off, near points do not fit, and would be taken for outliers.
//
// Where an outlier fits by chance, its parallax is mostly far larger than that of the inliers, and
// it says more of the direction of t than a hundred of them. How many such there may be is known
// from the matches of about the same parallax that fit far worse: outliers fit a motion as often
// within the gate as within as much of the band from kBandBegin to kBandEnd gates. A match that by
// these counts is an outlier with too large a probability is left out: above
// kMaxOutlierProbability at the 90th percentile of the parallax, beyond it less in inverse
// proportion to its square, as an outlier's harm grows, down to kMinOutlierProbability.
int SelectPlausibleInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                           std::vector<double>* squared_errors, std::vector<char>* inliers);

inline constexpr double kBandBegin = 8.0;
inline constexpr double kBandEnd = 24.0;
inline constexpr double kMaxOutlierProbability = 0.5;
inline constexpr double kMinOutlierProbability = 0.05;

}  // namespace rigel

#endif  // RIGEL_REFINE_INLIER_SELECTION_H_
