#include "rigel/refine/solver_choice.h"

#include <cmath>
#include <string>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/minimal/alignment.h"

namespace rigel {

bool IsSolverName(std::string_view name) {
  return name == kAutoSolver || FindSolver(name) != nullptr;
}

std::string SolverNamesWithAuto() { return std::string(kAutoSolver) + ", " + SolverNames(); }

std::vector<const SolverInfo*> SuggestSolvers(const MotionPrior& prior) {
  std::vector<const SolverInfo*> solvers;
  for (const char* name : {"3pt", "4pt", "4pt-axis", "5pt+1"}) {
    const SolverInfo* solver = FindSolver(name);
    Alignment alignment;
    std::string error;
    if (MakeAlignment(prior, solver->prior, &alignment, &error)) solvers.push_back(solver);
  }
  return solvers;
}

const SolverInfo& SuggestSolver(const MotionPrior& prior) { return *SuggestSolvers(prior).front(); }

bool IsDoubtful(const MotionPrior& prior, const SolverInfo& solver, const Pose& pose,
                double inlier_ratio) {
  if (inlier_ratio < kDoubtfulInlierRatio) return true;
  Alignment alignment;
  std::string error;
  if (solver.prior == PriorKind::kNone || !MakeAlignment(prior, solver.prior, &alignment, &error)) {
    return false;
  }
  const double angle = alignment.NearestAngle(pose.R);
  const Eigen::Matrix3d nearest = alignment.Rotation(std::cos(angle), std::sin(angle));
  return RotationError(nearest, pose.R) > DegToRad(kDoubtfulPriorDeg);
}

}  // namespace rigel
