#include "rigel/problems/benchmarks/ransac_tasks.h"

#include <cmath>
#include <utility>

#include "rigel/minimal/catalogue.h"
#include "rigel/problems/benchmarks/opengv_peers.h"

namespace rigel {
namespace {

using Tasks = std::vector<RansacTask>;

// Matches of a pair, and the share of outliers: both of docs/ransac_tables.md.
constexpr int kMatches = 626;
constexpr double kOutlierShare = 0.3;

// One part of the estimator left out or added.
struct Variant {
  const char* name;
  void (*modify)(EstimateOptions* options);
};

const std::vector<Variant>& Variants() {
  static const std::vector<Variant> variants = {
      {"default", [](EstimateOptions*) {}},
      {"no LO, no finalists", [](EstimateOptions* o) { o->ransac.local_optimization = false; }},
      {"no finalists", [](EstimateOptions* o) { o->ransac.num_finalists = 0; }},
      {"2 finalists", [](EstimateOptions* o) { o->ransac.num_finalists = 2; }},
      {"8 finalists", [](EstimateOptions* o) { o->ransac.num_finalists = 8; }},
      {"min_iterations 1", [](EstimateOptions* o) { o->ransac.min_iterations = 1; }},
      {"min_iterations 400", [](EstimateOptions* o) { o->ransac.min_iterations = 400; }},
      {"max_scored 256", [](EstimateOptions* o) { o->ransac.max_scored = 256; }},
      {"no PROSAC", [](EstimateOptions* o) { o->ransac.prosac = false; }},
      {"no early termination", [](EstimateOptions* o) { o->ransac.early_termination = false; }},
      {"no bail-out test", [](EstimateOptions* o) { o->ransac.bail_out = false; }},
  };
  return variants;
}

std::vector<std::string> DefaultSolvers(RansacExperiment experiment) {
  switch (experiment) {
    case RansacExperiment::kOutliers:
    case RansacExperiment::kMoving:
      return {"4pt-approx", "4pt-axis", "4pt", "3pt", "5pt+1"};
    case RansacExperiment::kAblation:
      return {"4pt-approx"};
    default:
      return {"4pt-approx", "4pt-axis-approx", "3pt", "17pt-li", "6pt-ventura", "5pt+1"};
  }
}

// The task that all others are variations of.
RansacTask BaseTask(uint64_t seed) {
  RansacTask task;
  task.scene.num_matches = kMatches;
  task.scene.outlier_share = kOutlierShare;
  task.scene.match_scores = true;
  task.scene.seed = seed;
  task.estimate.ransac.seed = seed;
  return task;
}

RansacTask WithSolver(RansacTask task, const std::string& solver) {
  task.estimate.solver = solver;
  const bool planar = FindSolver(solver)->prior == PriorKind::kPlanar;
  task.scene.motion = planar ? MotionPattern::kPlanar : MotionPattern::kRandom;
  return task;
}

// Each solver with the refinement of the form full and, where it has a prior, of the form prior.
Tasks SpeedTasks(const RansacTask& base, const std::vector<std::string>& solvers) {
  Tasks tasks;
  for (const std::string& solver : solvers) {
    RansacTask task = WithSolver(base, solver);
    tasks.push_back(task);
    if (FindSolver(solver)->prior == PriorKind::kNone) continue;
    task.estimate.refine.form = RefineForm::kPrior;
    tasks.push_back(task);
  }
  return tasks;
}

Tasks OpenGvTasks(const RansacTask& base) {
  Tasks tasks;
  for (const SolverInfo& peer : OpenGvPeers()) {
    // The bound is that of the form full.
    tasks.push_back(WithSolver(base, "17pt-li"));
    tasks.back().opengv = peer.name;
  }
  return tasks;
}

Tasks OutlierTasks(const RansacTask& base, const std::vector<std::string>& solvers) {
  // The number of inliers is the same at every share, so that the rows differ only in the outliers.
  constexpr int kInliers = 300;
  Tasks tasks;
  for (int percent = 10; percent <= 80; percent += 10) {
    const int all = static_cast<int>(std::lround(kInliers * 100.0 / (100 - percent)));
    RansacTask task = base;
    task.scene.num_matches = all;
    task.scene.outlier_share = (all - kInliers) / static_cast<double>(all);
    for (const std::string& solver : solvers) tasks.push_back(WithSolver(task, solver));
  }
  return tasks;
}

Tasks AblationTasks(const RansacTask& base, const std::vector<std::string>& solvers) {
  // Of the matches: an easy case, and one where RANSAC needs thousands of samples.
  constexpr double kOutlierShares[] = {0.3, 0.7};
  Tasks tasks;
  for (const double share : kOutlierShares) {
    for (const std::string& solver : solvers) {
      for (const Variant& variant : Variants()) {
        RansacTask task = WithSolver(base, solver);
        task.scene.outlier_share = share;
        task.variant = variant.name;
        variant.modify(&task.estimate);
        tasks.push_back(task);
      }
    }
  }
  return tasks;
}

Tasks MovingTasks(const RansacTask& base, const std::vector<std::string>& solvers) {
  constexpr struct {
    double moving, outliers;
  } kShares[] = {{0.3, 0.0}, {0.3, 0.3}, {0.45, 0.0}};  // of the matches: on the car, outliers
  Tasks tasks;
  for (const auto& shares : kShares) {
    RansacTask task = base;
    task.scene.moving_share = shares.moving;
    task.scene.outlier_share = shares.outliers;
    for (const std::string& solver : solvers) tasks.push_back(WithSolver(task, solver));
  }
  return tasks;
}

}  // namespace

std::vector<RansacTask> MakeRansacTasks(const RansacBenchmarkOptions& options) {
  const RansacTask base = BaseTask(options.seed);
  const std::vector<std::string> solvers =
      options.solvers.empty() ? DefaultSolvers(options.experiment) : options.solvers;
  switch (options.experiment) {
    case RansacExperiment::kSpeed:
    case RansacExperiment::kFiles:
      break;
    case RansacExperiment::kOutliers:
      return OutlierTasks(base, solvers);
    case RansacExperiment::kAblation:
      return AblationTasks(base, solvers);
    case RansacExperiment::kMoving:
      return MovingTasks(base, solvers);
  }
  Tasks tasks = SpeedTasks(base, solvers);
  if (options.solvers.empty()) {
    for (RansacTask& task : OpenGvTasks(base)) tasks.push_back(std::move(task));
  }
  return tasks;
}

}  // namespace rigel
