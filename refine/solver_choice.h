// Which minimal solver suits a frame pair: the choice behind the solver "auto".
#ifndef RIGEL_REFINE_SOLVER_CHOICE_H_
#define RIGEL_REFINE_SOLVER_CHOICE_H_

#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/pose.h"
#include "rigel/core/prior.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/grouped_matches.h"

namespace rigel {

inline constexpr char kAutoSolver[] = "auto";

// Whether it is that or a name of the catalogue, and what to expect, for messages.
bool IsSolverName(std::string_view name);
std::string SolverNamesWithAuto();

// The solvers that the priors allow, the most constrained first: 3pt (planar motion), 4pt (known
// vertical), 4pt-axis (known axis), in the end 5pt+1, which needs none. Exact ones: they cost
// little more than the first-order ones and hold in turns (docs/solver_choice.md has the sweep).
std::vector<const SolverInfo*> SuggestSolvers(const MotionPrior& prior);

// The first of them.
const SolverInfo& SuggestSolver(const MotionPrior& prior);

// Whether a less constrained solver should join: few of the matches agree with `pose`, or it turned
// away from the solver's prior by more than kDoubtfulPriorDeg, or the threshold cuts through the
// residuals: at twice the threshold there are kDoubtfulGrowth times as many inliers. Those of the
// right motion are nearly all below it, and outliers lie far and wide.
inline constexpr double kDoubtfulInlierRatio = 0.5;
inline constexpr double kDoubtfulPriorDeg = 2.0;
inline constexpr double kDoubtfulGrowth = 1.1;
bool IsDoubtful(const MotionPrior& prior, const SolverInfo& solver, const Pose& pose,
                const GroupedMatches& matches, double threshold_px);

}  // namespace rigel

#endif  // RIGEL_REFINE_SOLVER_CHOICE_H_
