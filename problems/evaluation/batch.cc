#include "rigel/problems/evaluation/batch.h"

#include <atomic>
#include <utility>

#include "rigel/minimal/catalogue.h"
#include "rigel/problems/io/match_file.h"

namespace rigel {
namespace {

// Results of one pair, one a candidate.
using Results = std::vector<PairResult>;

// options.estimate with each of options.solvers or, if these are empty, with each solver of the
// catalogue that it suits.
std::vector<EstimateOptions> Candidates(const ComparisonOptions& options) {
  std::vector<EstimateOptions> candidates;
  const auto add = [&](const std::string& name) {
    candidates.push_back(options.estimate);
    candidates.back().solver = name;
  };
  for (const std::string& name : options.solvers) add(name);
  if (!options.solvers.empty()) return candidates;
  for (const SolverInfo& solver : SolverCatalogue()) {
    add(solver.name);
    std::string why_not;
    if (!candidates.back().IsValid(&why_not)) candidates.pop_back();
  }
  return candidates;
}

// Moves the item's results of the candidates `kept` into the comparison.
void AddItem(const std::vector<size_t>& kept, BatchItem<Results>* item,
             FileComparison* comparison) {
  if (!item->error.empty()) {
    (item->pair.name.empty() ? comparison->errors : comparison->without_truth)
        .push_back(item->error);
    return;
  }
  if (!item->pair.truth.has_value()) {
    comparison->without_truth.push_back(item->pair.name +
                                        ": has no truth line, nothing to compare with");
    return;
  }
  for (size_t s = 0; s < kept.size(); ++s) {
    comparison->solvers[s].pairs.push_back(std::move(item->result[kept[s]]));
  }
  comparison->pairs.push_back(std::move(item->pair));
  comparison->axes.push_back(item->axes);
}

}  // namespace

bool LoadPair(const ComparisonOptions& options, const std::string& path, int position,
              FramePair* pair, std::string* error, AppliedAxes* applied) {
  if (!ReadMatchFile(path, pair, error) ||
      !ApplyPriorSource(options.prior, position, pair, error, applied)) {
    return false;
  }
  SelectMatches(options.use, pair);
  if (options.calibration_rotation_sigma > 0 || options.calibration_position_sigma > 0) {
    for (RigCamera& camera : pair->rig.cameras) {
      camera.rotation_sigma = options.calibration_rotation_sigma;
      camera.position_sigma = options.calibration_position_sigma;
    }
  }
  return true;
}

FileComparison CompareFiles(const ComparisonOptions& options, const std::vector<std::string>& paths,
                            int first, const std::function<void()>& progress) {
  const bool choose = options.solvers.empty();
  const std::vector<EstimateOptions> candidates = Candidates(options);
  // A solver whose prior one pair lacks is out: no later pair is spent on it.
  std::vector<std::atomic<bool>> out(candidates.size());
  const std::function<Results(const FramePair&)> work = [&](const FramePair& pair) {
    Results results(candidates.size());
    if (!pair.truth.has_value()) return results;
    for (size_t s = 0; s < candidates.size(); ++s) {
      if (choose && !HasPrior(pair.prior, FindSolver(candidates[s].solver)->prior)) out[s] = true;
      if (out[s]) continue;
      results[s] = ComparePair(pair, candidates[s]);
    }
    return results;
  };
  std::vector<BatchItem<Results>> items = RunBatch(options, paths, first, work, progress);

  FileComparison comparison;
  std::vector<size_t> kept;
  for (size_t s = 0; s < candidates.size(); ++s) {
    if (out[s]) continue;
    kept.push_back(s);
    comparison.solvers.push_back({candidates[s].solver, {}});
  }
  for (BatchItem<Results>& item : items) {
    AddItem(kept, &item, &comparison);
    item = BatchItem<Results>();
  }
  return comparison;
}

}  // namespace rigel
