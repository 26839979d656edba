// The flags of the programs that estimate motions: what is read, which prior, how it is estimated.
#ifndef RIGEL_TOOLS_ESTIMATION_FLAGS_H_
#define RIGEL_TOOLS_ESTIMATION_FLAGS_H_

#include <optional>
#include <string>
#include <vector>

#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/evaluation/shard.h"
#include "rigel/tools/outputs.h"

namespace rigel {

// Fills `options` (but for the solvers) from the flags. False with a message if one is wrong.
bool OptionsFromFlags(ComparisonOptions* options, std::string* error);

// The value of --solver. False with a message if there is no such solver, or --refine does not suit
// it.
bool SolverFromFlag(const std::string& solver, EstimateOptions* estimate, std::string* error);

// Whether --refine suits the solver: some forms hold its prior exact, and not every solver has one.
// False with a message if not.
bool CanRefine(const EstimateOptions& estimate, const std::string& solver, std::string* error);

// The files of --matches that are this run's, by --shard.
struct InputFiles {
  std::vector<std::string> paths;
  std::vector<std::string> all;  // those of all shards
  int first = 0;                 // position of paths[0] in `all`
  bool all_there = true;         // false if a path of --matches was not found; stderr says which
  std::optional<Shard> shard;
};

// Whether stdin, "-", is among --matches.
bool ReadsStdin();

// Lists the files of --matches. Returns an exit code. If there is no file at all, or an output
// would overwrite an input, it is not kExitDone, and stderr has a message.
int ListInput(const std::vector<OutputFlag>& outputs, InputFiles* input);

// The flags that do not change results: they say what is written where, and how many threads run.
std::vector<std::string> OutputFlags();

// Whether times are part of the results: not with --no_times.
bool TimesAreGiven();

}  // namespace rigel

#endif  // RIGEL_TOOLS_ESTIMATION_FLAGS_H_
