// Which matches a refinement takes as inliers of a motion.
#ifndef RIGEL_REFINE_INLIER_SELECTION_H_
#define RIGEL_REFINE_INLIER_SELECTION_H_

#include <vector>

#include "rigel/core/pose.h"
#include "rigel/minimal/grouped_matches.h"

namespace rigel {

// 1 for the matches of a Sampson error below the gate that do not lie behind a camera and are no
// likelier outliers, else 0, in grouped order; returns their number. `squared_errors`, pixels^2,
// and `inliers` are resized.
//
// Where an outlier fits by chance, its parallax is mostly far larger than that of the inliers, and
// it says more of the direction of t than a hundred of them. How many such there may be is known
// from the matches that fit somewhat worse than the gate: outliers fit a motion as often a little
// beyond the gate as within it. Where these, at about the same parallax, say that a match within is
// an outlier with a probability above kMaxOutlierProbability, it is left out. Without outliers none
// is.
int SelectInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                  std::vector<double>* squared_errors, std::vector<char>* inliers);

inline constexpr double kMaxOutlierProbability = 0.05;

}  // namespace rigel

#endif  // RIGEL_REFINE_INLIER_SELECTION_H_
