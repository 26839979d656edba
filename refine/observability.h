// What a fit says about the motion and how well: the covariance and the flags of a summary.
#ifndef RIGEL_REFINE_OBSERVABILITY_H_
#define RIGEL_REFINE_OBSERVABILITY_H_

#include <Eigen/Core>

#include "rigel/core/grouped_matches.h"
#include "rigel/refine/fit.h"
#include "rigel/refine/refine.h"
#include "rigel/refine/standing.h"

namespace rigel {

// Sets how far points move and how far noise alone may move them.
void SetParallax(const RefineOptions& options, const GroupedMatches& matches, const Fit& fit,
                 RefineSummary* summary);

// True if the inliers of each camera pair lie on a line of the image or in one place, as far as the
// noise tells. They determine no motion: the linear theory knows only one of those that fit.
bool OnALine(const GroupedMatches& matches, const Fit& fit);

// Fills the uncertainty and the flags of `summary` for a fit at its minimum: its covariance, the
// standard deviations, and what is observable (limits in uncertainty.h). `point` of the body is the
// origin of the matches' frame. summary->exceeds_chance and the parallax must be set.
void DescribeObservability(const RefineOptions& options, const GroupedMatches& matches,
                           const Eigen::Vector3d& point, const Fitter& fitter, const Fit& fit,
                           RefineSummary* summary);

// The same for a rig that stands.
void DescribeStanding(const GroupedMatches& matches, const Eigen::Vector3d& point,
                      const StandingMotion& motion, RefineSummary* summary);

}  // namespace rigel

#endif  // RIGEL_REFINE_OBSERVABILITY_H_
