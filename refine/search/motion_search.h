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
  const SolverInfo* solver = nullptr;  // whose hypotheses led to it; null if none has a sample
  int iterations = 0;                  // of all solvers
  int64_t hypotheses = 0;
  std::vector<SolverTrial> trials;  // in the order of the solvers
};

// `solvers`: at least one, the most constrained first; `prior` must have what each needs. The best
// score wins. Of several the first constrained one makes kFirstIterations. If its motion gives
// cause for doubt, those that need no prior make kProbeIterations, and after them the other
// constrained ones, until there is a motion that gives none; its solver then goes on alone. Else
// the best constrained one and those without a prior go on in turns, until the one that leads has
// drawn a sample of inliers with the confidence asked for and nothing but many outliers speaks
// against its motion. Those after 5pt+1 are for rigs most of whose matches are of camera pairs that
// have no five. All together make options.max_iterations and options.max_work_us at most. `stop` is
// asked before each iteration.
inline constexpr int kFirstIterations = 50;  // enough to see that a prior is right
inline constexpr int kProbeIterations = 100;
MotionSearch SearchMotion(const std::vector<const SolverInfo*>& solvers, const MotionPrior& prior,
                          const GroupedMatches& matches, const RansacOptions& options, Stop* stop);

}  // namespace rigel

#endif  // RIGEL_REFINE_SEARCH_MOTION_SEARCH_H_
