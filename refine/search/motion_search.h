// RANSAC with one solver or with several that share a budget of iterations.
#ifndef RIGEL_REFINE_SEARCH_MOTION_SEARCH_H_
#define RIGEL_REFINE_SEARCH_MOTION_SEARCH_H_

#include <cstdint>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/prior.h"
#include "rigel/core/stop.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac/ransac.h"
#include "rigel/minimal/solvers/solutions.h"
#include "rigel/refine/search/doubt.h"

namespace rigel {

struct MotionSearch {
  RansacResult<Solution> best;         // iterations and hypotheses are those of `solver`
  const SolverInfo* solver = nullptr;  // the solver of `best`; null if no solver has a sample
  int iterations = 0;                  // of all solvers
  int64_t hypotheses = 0;
  std::vector<SolverTrial> trials;  // in the order of the solvers
};

// `solvers`: at least one, the most constrained first; `prior` must have what each needs. With
// several solvers the search has these steps:
// - The first constrained solver makes kFirstIterations.
// - If its motion is doubtful (doubt.h), those that need no prior make kProbeIterations each, then
//   the other constrained ones. Solvers after 5pt+1 are used only if most matches are of camera
//   pairs with fewer than five matches.
// - The first solver whose motion is not doubtful continues alone.
// - If there is none, the best constrained solver and those without a prior take turns. They stop
//   when the best one has drawn a sample of inliers with the confidence of the options, and no
//   doubt but few inliers is left.
// The motion of the best score is the result, with one exception. If it deviates from its solver's
// prior, and a solver without a prior has a score at most 2 percent worse, the result is the motion
// of that solver.
// All together make at most options.max_iterations and options.max_work_us. `stop` is asked before
// each iteration.
inline constexpr int kFirstIterations = 50;  // enough to see that a prior is right
inline constexpr int kProbeIterations = 100;
MotionSearch SearchMotion(const std::vector<const SolverInfo*>& solvers, const MotionPrior& prior,
                          const GroupedMatches& matches, const RansacOptions& options, Stop* stop);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_MOTION_SEARCH_H_
