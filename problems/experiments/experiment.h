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

// The threshold is three sigma of the image noise, at least 0.5 px: where it is far above the
// noise, many hypotheses have all matches as inliers and their count says little.
EstimateOptions ExperimentEstimate(const std::string& solver, const std::string& loop,
                                   double noise_px);

// What is said of one solver in one loop at one point.
struct ExperimentRow {
  ExperimentPoint point;
  std::string loop;
  SolverSummary summary;
};

// All solvers in both loops at a point; the same for any number of threads, but for the times.
// A solver without a prior does not see the error of one: where `earlier` (may be empty) has its
// rows of the same motion at another value of kPitch or kRoll, they are taken over. False with a
// message if a pair cannot be made. `progress` (may be empty) is called after each pair, from any
// thread.
bool RunExperimentPoint(const ExperimentPlan& plan, const ExperimentPoint& point,
                        const std::vector<ExperimentRow>& earlier,
                        const std::function<void()>& progress, std::vector<ExperimentRow>* rows,
                        std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_H_
