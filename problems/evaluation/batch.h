// Many match files, processed on several threads. A thread reads a file, processes it and releases
// it before the next, so that memory holds one frame pair a thread.
#ifndef RIGEL_PROBLEMS_EVALUATION_BATCH_H_
#define RIGEL_PROBLEMS_EVALUATION_BATCH_H_

#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/parallel.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/io/exception_message.h"

namespace rigel {

// Reads a file, keeps the matches that options.use names and applies options.prior. `position` is
// the index of the file in the whole input, also where a run reads only a part of it. It selects
// the pair's random numbers. False with a message if that fails. `applied` may be null.
bool LoadPair(const ComparisonOptions& options, const std::string& path, int position,
              FramePair* pair, std::string* error, AppliedAxes* applied = nullptr);

// The result of one file.
template <class Result>
struct BatchItem {
  int position = 0;   // in the whole input
  std::string error;  // not empty: reading or work() failed, and there is no result
  FramePair pair;     // without rig and matches; has a name if the file was read
  AppliedAxes axes;
  Result result{};
};

// work(pair) for each file, on options.num_threads threads; `first` is the position of paths[0].
// Items in the order of `paths`, the same for any number of threads if work() depends on the pair
// alone. `progress` (may be empty) is called after each file, from any thread.
template <class Result>
std::vector<BatchItem<Result>> RunBatch(const ComparisonOptions& options,
                                        const std::vector<std::string>& paths, int first,
                                        const std::function<Result(const FramePair&)>& work,
                                        const std::function<void()>& progress) {
  std::vector<BatchItem<Result>> items(paths.size());
  ParallelFor(static_cast<int>(paths.size()), options.num_threads, [&](int k) {
    BatchItem<Result>& item = items[k];
    item.position = first + k;
    // If memory is not enough for one file, the others still get their results.
    try {
      if (LoadPair(options, paths[k], item.position, &item.pair, &item.error, &item.axes)) {
        item.result = work(item.pair);
        item.pair.rig = Rig();
        item.pair.matches = std::vector<Match>();
        item.pair.columns = MatchColumns();
      }
    } catch (const std::exception& exception) {
      item.pair = FramePair();
      item.error = paths[k] + ": " + ExceptionMessage(exception);
    }
    if (progress) progress();
  });
  return items;
}

// The accuracy of solvers over match files.
struct FileComparison {
  std::vector<FramePair> pairs;        // those compared, in order, without rig and matches
  std::vector<SolverResults> solvers;  // results for each of `pairs`
  std::vector<AppliedAxes> axes;       // of their priors
  // Messages for the other files, in order: those that failed, and those without a truth line.
  std::vector<std::string> errors, without_truth;
};

// Runs options.solvers or, if these are empty, all whose prior every pair has and that
// options.estimate suits.
FileComparison CompareFiles(const ComparisonOptions& options, const std::vector<std::string>& paths,
                            int first, const std::function<void()>& progress);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_BATCH_H_
