// What a fit says about the motion and how well: the covariance and the flags of a summary.
#ifndef RIGEL_REFINE_OBSERVABILITY_H_
#define RIGEL_REFINE_OBSERVABILITY_H_

#include <Eigen/Core>

#include "rigel/core/grouped_matches.h"
#include "rigel/refine/fit.h"
#include "rigel/refine/refine.h"

namespace rigel {

// Fills the uncertainty and the flags of `summary` for a fit at its minimum: its covariance, the
// standard deviations, and what is observable (limits in uncertainty.h). `point` of the body is the
// origin of the matches' frame. summary->exceeds_chance must be set.
void DescribeObservability(const RefineOptions& options, const GroupedMatches& matches,
                           const Eigen::Vector3d& point, const Fitter& fitter, const Fit& fit,
                           RefineSummary* summary);

}  // namespace rigel

#endif  // RIGEL_REFINE_OBSERVABILITY_H_
