// What programs that estimate motions say on stderr.
#ifndef RIGEL_TOOLS_ESTIMATION_MESSAGES_H_
#define RIGEL_TOOLS_ESTIMATION_MESSAGES_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/tools/progress.h"

namespace rigel {

// Shows how far a refinement is where it takes long. `progress` must outlive the function.
std::function<void(const RefineProgress&)> ShowRefinement(Progress* progress);

// A motion and why it is doubted; empty if it is not.
struct DoubtedMotion {
  std::string pair;
  std::string doubt;
};

// One line on stderr for the doubtful motions of a solver; none for auto, which says it elsewhere.
void ReportDoubts(const std::string& solver, const std::vector<DoubtedMotion>& motions);

// Says on stderr where --use_prior_in_refine has nothing to weigh.
void ReportUnweighedPriors(const ComparisonOptions& options,
                           const std::vector<std::string>& solvers,
                           const std::vector<FramePair>& pairs);

// Says on stderr, once, which axes of the body were taken from the cameras of the rigs. `forward`
// counts only where a solver or an error of the prior looks at it.
void ReportSuggestedAxes(const ComparisonOptions& options, const std::vector<std::string>& solvers,
                         const std::vector<AppliedAxes>& applied);

// Prints messages that begin with the names of files on stderr, equal ones once with a count.
void ReportGrouped(const std::vector<std::string>& messages, const std::vector<std::string>& files);

// What to tell of a pair that `solver` could not solve: its name, the solver, EstimateMotion's
// message and, where a prior is missing, where one could come from.
std::string FailureMessage(const FramePair& pair, const std::string& solver,
                           const std::string& message);

}  // namespace rigel

#endif  // RIGEL_TOOLS_ESTIMATION_MESSAGES_H_
