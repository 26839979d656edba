// Which matches a refinement takes as inliers of a motion.
//
// An outlier that fits by chance does no harm among many inliers that contradict it. One of far
// larger parallax or leverage than the others does: the motion follows it, by many standard
// deviations, until it fits. How many outliers of about its parallax or leverage are to be expected
// within the gate is counted where they fit far worse, from kBandBegin to kBandEnd gates: there are
// as many of them to a pixel there.
#ifndef RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_
#define RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_

#include <functional>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/least_squares/uncertainty.h"

namespace rigel {

// A fit that leverage is judged by; vectors in grouped order.
struct InlierFit {
  double noise_px = 1.0;
  Matrix6d covariance = Matrix6d::Zero();  // of the motion as its members determine it
  std::vector<double> weights;             // of each match's residual, also if it is no member
  std::vector<char> members;               // 1 for the matches that were fitted
  bool is_minimum = true;  // the motion is that of least squares over the members, not the truth
};
// Fills a fit at the motion that is judged; false if there is none.
using InlierFitFunction = std::function<bool(InlierFit*)>;

// 1 for the matches of a Sampson error below the gate that do not lie behind a camera and are no
// likelier outliers, else 0, in grouped order; returns their number. `squared_errors`, pixels^2,
// and `inliers` are resized. `pose` must be at a minimum of its inliers by the gate alone: where it
// is off, near points do not fit, and would be taken for outliers.
//
// By parallax: a match is left out that is an outlier with too large a probability by the counts of
// those of about its parallax: above kMaxOutlierProbability at the 90th percentile of the parallax,
// beyond it less in inverse proportion to its square, as an outlier's harm grows, down to
// kMinOutlierProbability.
//
// By leverage, where there are outliers and `fit` gives a fit (null: not at all): h, what share of
// its own error a match takes out of its residual r. Of outliers of leverage h 1 / (1 - h) times as
// many end within the gate; inliers are rarer, the larger it is, and r / (sigma sqrt(1 - h)) is
// normal. What is likelier an outlier by the counts of those of about its leverage is left out.
int SelectPlausibleInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                           const InlierFitFunction& fit, std::vector<double>* squared_errors,
                           std::vector<char>* inliers);

inline constexpr double kBandBegin = 8.0;
inline constexpr double kBandEnd = 24.0;
inline constexpr double kMaxOutlierProbability = 0.5;
inline constexpr double kMinOutlierProbability = 0.05;

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_INLIER_SELECTION_H_
