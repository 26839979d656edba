#include "rigel/refine/solver_choice.h"

#include <cmath>
#include <limits>
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
                const GroupedMatches& matches, double threshold_px) {
  constexpr double kNoBound = std::numeric_limits<double>::infinity();
  int inliers = 0, loose_inliers = 0;
  matches.Score(pose, threshold_px, kNoBound, &inliers);
  matches.Score(pose, 2.0 * threshold_px, kNoBound, &loose_inliers);
  if (inliers < kDoubtfulInlierRatio * matches.size()) return true;
  if (loose_inliers > kDoubtfulGrowth * inliers) return true;
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
