// Selects the inliers of a motion for the refinement.
//
// An outlier that fits by chance does no harm if many inliers contradict it. It does harm if its
// parallax or leverage is far larger than theirs: the motion then follows the outlier, by many
// standard deviations. So the number of outliers to expect within the gate is estimated. Outliers
// are uniform in the error, so they are counted in a band of larger errors, from kBandBegin to
// kBandEnd times the gate, among matches of about the same parallax or leverage.
#ifndef RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_
#define RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_

#include <functional>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {

// The fit from which leverages are computed. Vectors are in grouped order.
struct InlierFit {
  double noise_px = 1.0;
  Matrix6d covariance = Matrix6d::Zero();  // of the motion, from the members
  std::vector<double> weights;             // of the residuals of all matches, members or not
  std::vector<char> members;               // 1 for the matches that were fitted
  bool is_minimum = true;  // the motion is the least-squares fit of the members, not the truth
};
// Fills the fit at the motion that is judged; false if there is none.
using InlierFitFunction = std::function<bool(InlierFit*)>;

// Sets `inliers` (grouped order) to 1 for each match whose Sampson error is below the gate, that
// does not lie behind a camera, and that is not more likely an outlier; else to 0. Returns the
// number of inliers. `squared_errors` (pixels^2) and `inliers` are resized. `pose` must be at a
// minimum over the inliers of the gate alone. Elsewhere near points do not fit and would be taken
// for outliers.
//
// By parallax: a match is left out if the counts of matches of about its parallax give too large a
// probability that it is an outlier. The limit is kMaxOutlierProbability up to the 90th percentile
// of the parallax. Beyond, it falls with the square of the parallax, as the harm of an outlier
// grows, down to kMinOutlierProbability.
//
// By leverage, if there are outliers and `fit` gives a fit (null: not at all). The leverage h is
// the share of its error that a match takes out of its residual r. 1 / (1 - h) times as many
// outliers of leverage h are within the gate. Inliers of large leverage are rare, and r / (sigma
// sqrt(1 - h)) is normal for them. A match is left out if these counts and densities make it more
// likely an outlier.
int SelectPlausibleInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                           const InlierFitFunction& fit, std::vector<double>* squared_errors,
                           std::vector<char>* inliers);

// The band in which outliers are counted, in gates, and the limits of the rule by parallax.
inline constexpr double kBandBegin = 8.0;
inline constexpr double kBandEnd = 24.0;
inline constexpr double kMaxOutlierProbability = 0.5;
inline constexpr double kMinOutlierProbability = 0.05;

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_
