// The motions of the match files of a run.
#ifndef RIGEL_TOOLS_ESTIMATE_FILES_H_
#define RIGEL_TOOLS_ESTIMATE_FILES_H_

#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "rigel/problems/evaluation/batch.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/estimation_messages.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/tool.h"

namespace rigel {

// keep(pair, motion) of each file of the run, in their order. Files that cannot be read, or lack
// what the flags need, are told on stderr and left out. Shows the progress.
template <class Result>
std::vector<BatchItem<Result>> EstimateFiles(
    const ComparisonOptions& options, const InputFiles& input,
    const std::function<Result(const FramePair&, MotionEstimate)>& keep) {
  std::vector<BatchItem<Result>> items;
  {
    Progress progress(ProgramName(), static_cast<int>(input.paths.size()));
    const std::function<Result(const FramePair&)> work = [&](const FramePair& pair) {
      EstimateOptions estimate = options.estimate;
      estimate.refine.progress = ShowRefinement(&progress);
      return keep(pair, EstimateMotion(estimate, pair));
    };
    items = RunBatch(options, input.paths, input.first, work, [&] { progress.Step(); });
  }
  std::vector<BatchItem<Result>> estimated;
  std::vector<std::string> errors;
  for (BatchItem<Result>& item : items) {
    if (item.error.empty()) {
      estimated.push_back(std::move(item));
    } else if (item.pair.name.empty()) {
      std::cerr << PrintablePath(item.error) << "\n";
    } else {
      // It was read; many files may lack the same.
      errors.push_back(PrintablePath(item.error));
    }
  }
  ReportGrouped(errors, input.paths);
  return estimated;
}

}  // namespace rigel

#endif  // RIGEL_TOOLS_ESTIMATE_FILES_H_
