// Many match files on several threads. Each file is a piece of work of its own: it is read, worked
// on and forgotten, so that no more frame pairs are in memory than there are threads.
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
// the place of the file among all of the input, whatever part of it this run reads: it fixes the
// pair's random numbers. False with a message if that fails. `applied` may be null.
bool LoadPair(const ComparisonOptions& options, const std::string& path, int position,
              FramePair* pair, std::string* error, AppliedAxes* applied = nullptr);

// What is left of one file.
template <class Result>
struct BatchItem {
  int position = 0;   // among all of the input
  std::string error;  // not empty: it could not be read or worked on, and there is nothing else
  FramePair pair;     // without rig and matches; has a name where it was read, whatever the error
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
    // One file that there is no memory for is no reason to lose the others.
    try {
      if (LoadPair(options, paths[k], item.position, &item.pair, &item.error, &item.axes)) {
        item.result = work(item.pair);
        item.pair.rig = Rig();
        item.pair.matches = std::vector<Match>();
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
  // Why the other files are not among them, in order: they could not be read or worked on; they
  // have no truth line, which is needed.
  std::vector<std::string> errors, without_truth;
};

// Runs options.solvers or, if these are empty, all whose prior every pair has and that
// options.estimate suits.
FileComparison CompareFiles(const ComparisonOptions& options, const std::vector<std::string>& paths,
                            int first, const std::function<void()>& progress);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_BATCH_H_
