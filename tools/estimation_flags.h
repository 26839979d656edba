// The flags of rigel_estimate and rigel_compare: what is read, which prior, how it is estimated.
#ifndef RIGEL_TOOLS_ESTIMATION_FLAGS_H_
#define RIGEL_TOOLS_ESTIMATION_FLAGS_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/evaluation/shard.h"
#include "rigel/tools/tool.h"

namespace rigel {

// Fills `options` (but for the solvers) from the flags. False with a message if one is wrong.
bool OptionsFromFlags(ComparisonOptions* options, std::string* error);

// Whether --refine suits the solver: some forms hold its prior exact, and not every solver has one.
// False with a message if not.
bool CanRefine(const EstimateOptions& estimate, const std::string& solver, std::string* error);

// The files of --matches that are this run's, by --shard.
struct InputFiles {
  std::vector<std::string> paths;
  std::vector<std::string> all;  // those of all shards
  int first = 0;                 // position of paths[0] among the files of all shards
  int total = 0;                 // files of all shards
  bool all_there = true;         // false: something was not, which was told on stderr
  std::optional<Shard> shard;
};

// Whether stdin, "-", is among --matches.
bool ReadsStdin();

// Lists --matches. Says on stderr if there is no file at all.
InputFiles ListInput();

// The flags that say what is written where, or by how many threads: no options of a result.
std::vector<std::string> OutputFlags();

// Shows how far a refinement is where it takes long. `progress` must outlive the function.
std::function<void(const RefineProgress&)> ShowRefinement(Progress* progress);

// Whether times are part of the results: not with --no_times.
bool TimesAreGiven();

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

#endif  // RIGEL_TOOLS_ESTIMATION_FLAGS_H_
