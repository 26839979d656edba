// Which minimal solver suits a frame pair: the choice behind the solver "auto".
#ifndef RIGEL_REFINE_SOLVER_CHOICE_H_
#define RIGEL_REFINE_SOLVER_CHOICE_H_

#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/prior.h"
#include "rigel/minimal/catalogue.h"

namespace rigel {

inline constexpr char kAutoSolver[] = "auto";

// Whether it is that or a name of the catalogue, and what to expect, for messages.
bool IsSolverName(std::string_view name);
std::string SolverNamesWithAuto();

// The solvers that the priors allow, the most constrained first: 3pt (planar motion), 4pt (known
// vertical), 4pt-axis (known axis), then those that need none: 5pt+1, which wants five matches of
// one camera pair, 6pt-ventura, first order in the rotation, and 17pt-li. Exact ones where there
// is a choice: they cost little more and hold in turns (docs/solver_choice.md has the sweep).
std::vector<const SolverInfo*> SuggestSolvers(const MotionPrior& prior);

// The first of them.
const SolverInfo& SuggestSolver(const MotionPrior& prior);

}  // namespace rigel

#endif  // RIGEL_REFINE_SOLVER_CHOICE_H_
