// The solvers of an experiment, run at its points.
//
// At each point all solvers run on the same frame pairs, in two loops:
//   paper   as the paper describes it: the hypothesis with the most inliers wins, no local
//           optimization; confidence 0.99, at least 100 and at most 1000 iterations
//   rigel   the defaults of EstimateMotion()
// both followed by the refinement. `raw` is the winning minimal hypothesis.
#ifndef RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_
#define RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/experiments/experiment_plan.h"

namespace rigel {

inline constexpr const char* kPaperLoop = "paper";
inline constexpr const char* kRigelLoop = "rigel";

// The threshold is three sigma of the image noise, at least 0.5 px. If it were far above the noise,
// many hypotheses would have all matches as inliers, and their number would not tell them apart.
EstimateOptions ExperimentEstimate(const std::string& solver, const std::string& loop,
                                   double noise_px);

// The results of one solver in one loop at one point.
struct ExperimentRow {
  ExperimentPoint point;
  std::string loop;
  SolverSummary summary;
};

// Runs all solvers in both loops at a point. Apart from the times, results do not depend on the
// number of threads. An error of the prior (kPitch, kRoll) does not affect a solver without a
// prior: its rows are copied from `earlier` (may be empty) if that has them for the same motion.
// False with a message if a pair cannot be made. `progress` (may be empty) is called after each
// pair, from any thread.
bool RunExperimentPoint(const ExperimentPlan& plan, const ExperimentPoint& point,
                        const std::vector<ExperimentRow>& earlier,
                        const std::function<void()>& progress, std::vector<ExperimentRow>* rows,
                        std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_
