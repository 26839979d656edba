// Selects the inliers of a motion for the refinement.
//
// An outlier that fits by chance does no harm if many inliers contradict it. It does harm if its
// leverage is far larger than theirs: the motion then follows the outlier, by many standard
// deviations. So a match of large leverage must be more likely an inlier than an outlier.
#ifndef RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_
#define RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/search/noise_model.h"

namespace rigel {

// The fit from which leverages are computed. Vectors are in grouped order.
struct InlierFit {
  Matrix6d covariance = Matrix6d::Zero();  // of the motion, from the members
  std::vector<double> weights;             // of the residuals of all matches, 1 / pixels
  std::vector<char> members;               // 1 for the matches that were fitted
};

// Sets `inliers` (grouped order) to 1 for each match in front whose error is below the gate of its
// camera pair, else to 0. Returns their number.
int SelectWithinGate(const GroupedMatches& matches, const MatchErrors& errors,
                     const NoiseModel& noise, std::vector<char>* inliers);

// Clears `inliers` for matches that are outliers with a probability above kMaxOutlierProbability.
// Returns the number that is left. `pose` must be the least-squares fit of the members: elsewhere
// near points do not fit and would be taken for outliers.
//
// The leverage h is the share of its error that a match takes out of its residual r. So 1 / (1 - h)
// times as many outliers of leverage h are within the gate. Inliers of large leverage are rare, and
// r / (sigma sqrt(1 - h)) is normal for them. Matches of at least twice the mean leverage are
// judged, among matches of about their leverage.
int ExcludeImplausible(const GroupedMatches& matches, const Pose& pose, const MatchErrors& errors,
                       const NoiseModel& noise, const InlierFit& fit, std::vector<char>* inliers);

inline constexpr double kMaxOutlierProbability = 0.2;

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_
