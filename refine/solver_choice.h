// Chooses the minimal solvers for a frame pair: the choice behind the solver "auto".
#ifndef RIGEL_REFINE_SOLVER_CHOICE_H_
#define RIGEL_REFINE_SOLVER_CHOICE_H_

#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/prior.h"
#include "rigel/minimal/catalogue.h"

namespace rigel {

inline constexpr char kAutoSolver[] = "auto";

// True for "auto" and the names of the catalogue.
bool IsSolverName(std::string_view name);
// These names, separated by commas, for messages.
std::string SolverNamesWithAuto();

// The solvers that the prior allows, the most constrained first: 3pt (planar motion), 4pt (known
// vertical), 4pt-axis (known axis). Then those that need no prior: 5pt+1, which needs five matches
// of one camera pair, 6pt-ventura, which is of first order in the rotation, and 17pt-li. The exact
// solvers are taken, not the first-order ones: they take little more time and are as good in turns
// (measured: docs/solver_choice.md).
std::vector<const SolverInfo*> SuggestSolvers(const MotionPrior& prior);

// The first of them.
const SolverInfo& SuggestSolver(const MotionPrior& prior);

}  // namespace rigel

#endif  // RIGEL_REFINE_SOLVER_CHOICE_H_
