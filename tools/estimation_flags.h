// The flags of rigel_estimate and rigel_compare: what is read, which prior, how it is estimated.
#ifndef RIGEL_TOOLS_ESTIMATION_FLAGS_H_
#define RIGEL_TOOLS_ESTIMATION_FLAGS_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/comparison.h"

namespace rigel {

// Fills `options` (but for the solvers) from the flags. False with a message if one is wrong.
bool OptionsFromFlags(ComparisonOptions* options, std::string* error);

// Whether --refine suits the solver: some forms hold its prior exact, and not every solver has one.
// False with a message if not.
bool CanRefine(const EstimateOptions& estimate, const std::string& solver, std::string* error);

// Reads --matches, keeps the matches that --use names and applies --prior. Every file that cannot
// be read is told on stderr and sets *all_read to false; the others are returned, and in
// *positions, if asked for, the places they have among all the files.
std::vector<FramePair> ReadPairs(const ComparisonOptions& options, bool* all_read,
                                 std::vector<int>* positions = nullptr);

// Says on stderr where --use_prior_in_refine has nothing to weigh.
void ReportUnweighedPriors(const ComparisonOptions& options,
                           const std::vector<std::string>& solvers,
                           const std::vector<FramePair>& pairs);

// What to tell of a pair that `solver` could not solve: its name, the solver, EstimateMotion's
// message and, where a prior is missing, where one could come from.
std::string FailureMessage(const FramePair& pair, const std::string& solver,
                           const std::string& message);

}  // namespace rigel

#endif  // RIGEL_TOOLS_ESTIMATION_FLAGS_H_
