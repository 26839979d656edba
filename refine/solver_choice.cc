#include "rigel/refine/solver_choice.h"

#include <string>

#include "rigel/core/alignment.h"

namespace rigel {

bool IsSolverName(std::string_view name) {
  return name == kAutoSolver || FindSolver(name) != nullptr;
}

std::string SolverNamesWithAuto() { return std::string(kAutoSolver) + ", " + SolverNames(); }

std::vector<const SolverInfo*> SuggestSolvers(const MotionPrior& prior) {
  std::vector<const SolverInfo*> solvers;
  for (const char* name : {"3pt", "4pt", "4pt-axis", "5pt+1", "6pt-ventura", "17pt-li"}) {
    const SolverInfo* solver = FindSolver(name);
    Alignment alignment;
    std::string error;
    if (MakeAlignment(prior, solver->prior, &alignment, &error)) solvers.push_back(solver);
  }
  return solvers;
}

const SolverInfo& SuggestSolver(const MotionPrior& prior) { return *SuggestSolvers(prior).front(); }

}  // namespace rigel
