// The score of a rig's calibration at a fit.
#ifndef RIGEL_REFINE_RIG_SCORE_OF_FIT_H_
#define RIGEL_REFINE_RIG_SCORE_OF_FIT_H_

#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/refine/fit_information.h"
#include "rigel/refine/rig_doubts.h"
#include "rigel/refine/search/noise_model.h"

namespace rigel {

// `fit` is at its minimum `pose`; `psi2_of` has the mean of psi^2 of each camera pair
// (FitInformation). Empty for one camera. Of the stated errors of focal lengths those of pinholes
// count.
RigScore RigScoreOfFit(const FittedInliers& fit, const GroupedMatches& matches,
                       const NoiseModel& noise, const std::vector<double>& psi2_of,
                       const Pose& pose);

// The mean of the ratios of variances; those of turns of which nothing is known are left out. 1 if
// there is none.
double MeanRatio(const Eigen::VectorXd& measured, const Eigen::VectorXd& model);

}  // namespace rigel

#endif  // RIGEL_REFINE_RIG_SCORE_OF_FIT_H_
