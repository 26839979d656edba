// The second motion of a plane.
//
// One camera sees points of a plane n'X = 1 move by the homography H = R + b n'. There is a second
// motion and plane with H = R_2 + b_2 n_2', and all matches of the plane fit both. See
// Longuet-Higgins, The reconstruction of a plane surface from two perspective projections, 1986.
// The decomposition is that of Ma, Soatto, Kosecka and Sastry, An Invitation to 3-D Vision, 5.3.
#ifndef RIGEL_REFINE_SEARCH_PLANE_TWIN_H_
#define RIGEL_REFINE_SEARCH_PLANE_TWIN_H_

#include <optional>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"

namespace rigel {

// The second motion if the points of the matches lie on a plane, as far as noise of `noise_px`
// lets their depths tell. For a rig of several cameras H is that of the body's origin, so that the
// second motion is a start for a fit. Nothing if the points lie on no plane, or if it has one
// motion: its normal is along b, or b is zero.
std::optional<Pose> PlaneTwin(const GroupedMatches& matches, const Pose& pose, double noise_px);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_PLANE_TWIN_H_
