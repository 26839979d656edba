#include "rigel/problems/experiments/experiment.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "rigel/core/parallel.h"
#include "rigel/minimal/catalogue.h"

namespace rigel {
namespace {

// Pixels: with less, images without noise would have hardly an inlier for a first-order solver.
constexpr double kThresholdFloorPx = 0.5;
// Sigmas of the image noise: nearly all inliers are within three.
constexpr double kThresholdSigmas = 3.0;

// These stand in for the loop of the paper: a common confidence, and hypotheses that bound its time
// (docs/experiments.md).
constexpr double kPaperConfidence = 0.99;
constexpr int kPaperMinIterations = 100;
constexpr int kPaperMaxIterations = 1000;

struct Run {
  std::string solver, loop;
  const ExperimentRow* known = nullptr;  // measured at another point already
};

const ExperimentRow* FindKnown(const ExperimentPlan& plan, const ExperimentPoint& point,
                               const Run& run, const std::vector<ExperimentRow>& earlier) {
  const bool of_the_prior = plan.spec->variable == ExperimentVariable::kPitch ||
                            plan.spec->variable == ExperimentVariable::kRoll;
  if (!of_the_prior || FindSolver(run.solver)->prior != PriorKind::kNone) return nullptr;
  for (const ExperimentRow& row : earlier) {
    if (row.point.motion == point.motion && row.summary.solver == run.solver &&
        row.loop == run.loop) {
      return &row;
    }
  }
  return nullptr;
}

}  // namespace

EstimateOptions ExperimentEstimate(const std::string& solver, const std::string& loop,
                                   double noise_px) {
  EstimateOptions options;
  options.solver = solver;
  options.ransac.threshold_px = std::max(kThresholdFloorPx, kThresholdSigmas * noise_px);
  if (loop == kPaperLoop) {
    options.ransac.score = ScoreKind::kInlierCount;
    options.ransac.confidence = kPaperConfidence;
    options.ransac.min_iterations = kPaperMinIterations;
    options.ransac.max_iterations = kPaperMaxIterations;
    options.ransac.local_optimization = false;
    options.ransac.num_finalists = 0;
    options.ransac.prosac = false;
  }
  return options;
}

bool RunExperimentPoint(const ExperimentPlan& plan, const ExperimentPoint& point,
                        const std::vector<ExperimentRow>& earlier,
                        const std::function<void()>& progress, std::vector<ExperimentRow>* rows,
                        std::string* error) {
  std::vector<Run> runs;
  for (const std::string& solver : plan.spec->solvers) {
    for (const char* loop : {kPaperLoop, kRigelLoop}) {
      Run run{solver, loop, nullptr};
      run.known = FindKnown(plan, point, run, earlier);
      runs.push_back(std::move(run));
    }
  }
  const int num_pairs = CountPairs(plan, point);
  std::vector<std::vector<PairResult>> results(runs.size(), std::vector<PairResult>(num_pairs));
  std::vector<std::string> errors(num_pairs);
  std::atomic<bool> failed{false};
  ParallelFor(num_pairs, plan.options.num_threads, [&](int k) {
    FramePair pair;
    if (failed) return;
    if (!MakeExperimentPair(plan, point, k, &pair, &errors[k])) {
      failed = true;
      return;
    }
    for (size_t r = 0; r < runs.size(); ++r) {
      if (runs[r].known != nullptr) continue;
      const EstimateOptions options =
          ExperimentEstimate(runs[r].solver, runs[r].loop, pair.noise_px.value_or(0.0));
      results[r][k] = ComparePair(pair, options);
    }
    if (progress) progress();
  });
  for (const std::string& message : errors) {
    if (message.empty()) continue;
    *error = std::string(plan.spec->name) + ": " + message;
    return false;
  }
  rows->clear();
  for (size_t r = 0; r < runs.size(); ++r) {
    const Run& run = runs[r];
    rows->push_back(
        {point, run.loop,
         run.known != nullptr ? run.known->summary : Summarize(run.solver, "all", results[r])});
    if (!point.sequence.empty()) rows->back().summary.sequence = point.sequence;
  }
  return true;
}

}  // namespace rigel
