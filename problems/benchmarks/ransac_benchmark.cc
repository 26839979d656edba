#include "rigel/problems/benchmarks/ransac_benchmark.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rigel/core/angles.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/benchmarks/opengv_peers.h"
#include "rigel/problems/evaluation/cramer_rao.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

// Runs of a pair, of which the fastest counts: what disturbs a machine only adds.
constexpr int kRepetitions = 3;
// Cramer-Rao bounds of the pair's own rotation, 1 sigma each: noise alone seldom takes an error
// beyond three.
constexpr double kSuccessBounds = 3.0;
// OpenGV takes seconds a pair.
constexpr int kOpenGvPairs = 5;

// A pair to estimate and, of a scene, its matches that follow the motion.
struct Problem {
  FramePair pair;
  std::optional<FramePair> clean;
};

// What one row measures.
struct Task {
  SceneOptions scene;
  EstimateOptions estimate;
  std::string variant;
  std::string opengv;  // estimates in place of Rigel if not empty
};

// An outlier, or a match of the car, is what another scene without them has elsewhere.
std::optional<Problem> MakeProblem(const SceneOptions& scene, int index) {
  Problem problem;
  std::string error;
  SceneOptions clean_scene = scene;
  clean_scene.outlier_share = 0.0;
  clean_scene.moving_share = 0.0;
  FramePair clean;
  if (!MakeScenePair(scene, index, &problem.pair, &error) ||
      !MakeScenePair(clean_scene, index, &clean, &error)) {
    return std::nullopt;
  }
  problem.clean = problem.pair;
  problem.clean->matches.clear();
  for (size_t k = 0; k < clean.matches.size(); ++k) {
    const Match& match = problem.pair.matches[k];
    if (match.pixel2 == clean.matches[k].pixel2) problem.clean->matches.push_back(match);
  }
  return problem;
}

std::vector<Problem> MakeProblems(const SceneOptions& scene, int pairs) {
  std::vector<Problem> problems;
  for (int k = 0; k < pairs; ++k) {
    if (auto problem = MakeProblem(scene, k)) problems.push_back(std::move(*problem));
  }
  return problems;
}

// The noise that the pair states is the refinement's.
MotionEstimate EstimateOnce(const Task& task, const FramePair& pair) {
  if (task.opengv.empty()) {
    EstimateOptions options = task.estimate;
    if (pair.noise_px.has_value()) options.refine.noise_px = pair.noise_px;
    return EstimateMotion(options, pair);
  }
  MotionEstimate estimate;
  OpenGvEstimate peer;
  if (!EstimateWithOpenGv(task.opengv, task.estimate.ransac, pair, &peer)) return estimate;
  estimate.status = EstimateStatus::kSuccess;
  estimate.pose = peer.pose;
  estimate.inlier_ratio = peer.num_inliers / static_cast<double>(pair.matches.size());
  estimate.iterations = peer.iterations;
  estimate.ransac_ms = peer.ransac_ms;
  estimate.refine_ms = peer.refine_ms;
  estimate.refine.translation_observable = true;
  return estimate;
}

double TotalMs(const MotionEstimate& estimate) { return estimate.ransac_ms + estimate.refine_ms; }

// The least of a few repetitions: what disturbs a machine only adds.
MotionEstimate EstimateTimed(const Task& task, const FramePair& pair) {
  MotionEstimate best = EstimateOnce(task, pair);
  for (int k = 1; k < kRepetitions && task.opengv.empty(); ++k) {
    MotionEstimate again = EstimateOnce(task, pair);
    if (TotalMs(again) < TotalMs(best)) best = std::move(again);
  }
  return best;
}

double RotationDeg(const Pose& truth, const Pose& pose) {
  return RadToDeg(RotationError(truth.R, pose.R));
}

std::optional<double> DirectionDeg(const Pose& truth, const MotionEstimate& estimate) {
  const double error = RadToDeg(TranslationDirectionError(truth.t, estimate.pose.t));
  if (!estimate.refine.translation_observable || !std::isfinite(error)) return std::nullopt;
  return error;
}

// The motion counts as the static scene's if it holds nine in ten of what the true motion does.
bool HoldsStaticMatches(const FramePair& clean, const Pose& pose, double threshold_px) {
  // Of those that the true motion holds: noise takes some of the matches beyond the threshold.
  constexpr double kShare = 0.9;
  const GroupedMatches matches(clean.rig, clean.matches);
  const auto count = [&](const Pose& motion) {
    std::vector<double> errors;
    matches.SquaredErrors(motion, &errors);
    return std::count_if(errors.begin(), errors.end(),
                         [&](double e) { return e < threshold_px * threshold_px; });
  };
  return static_cast<double>(count(pose)) >= kShare * static_cast<double>(count(*clean.truth));
}

RefineOptions RefinementOf(const Task& task, const FramePair& pair) {
  RefineOptions refine(task.estimate.refine);
  refine.prior_kind = FindSolver(task.estimate.solver)->prior;
  refine.threshold_px = task.estimate.ransac.threshold_px;
  refine.noise_px = pair.noise_px;
  return refine;
}

std::optional<double> Median(const std::vector<double>& values) {
  const auto statistics = ComputeStatistics(values);
  return statistics ? std::optional<double>(statistics->median) : std::nullopt;
}

// RMS error over RMS bound.
std::optional<double> Efficiency(const std::vector<double>& errors,
                                 const std::vector<double>& bounds) {
  const auto error = ComputeStatistics(errors);
  const auto bound = ComputeStatistics(bounds);
  if (!error || !bound || !(bound->rms > 0)) return std::nullopt;
  return error->rms / bound->rms;
}

// Collects the pairs of a row.
class Collector {
 public:
  Collector(const Task& task, RansacBenchmarkRow* row) : task_(task), row_(*row) {}

  void Add(const Problem& problem) {
    const MotionEstimate estimate = EstimateTimed(task_, problem.pair);
    ++row_.pairs;
    matches_ += static_cast<double>(problem.pair.matches.size());
    const bool found = estimate.HasMotion();
    std::optional<double> rotation;
    if (found) {
      times_.push_back(TotalMs(estimate));
      ransac_.push_back(estimate.ransac_ms);
      refine_.push_back(estimate.refine_ms);
      iterations_.push_back(estimate.iterations);
      inliers_.push_back(estimate.inlier_ratio);
    } else {
      ++row_.failures;
    }
    if (found && problem.pair.truth.has_value()) {
      rotation = RotationDeg(*problem.pair.truth, estimate.pose);
      rotation_.push_back(*rotation);
      const auto direction = DirectionDeg(*problem.pair.truth, estimate);
      if (direction) direction_.push_back(*direction);
    }
    AddSuccess(problem, estimate, rotation);
    if (problem.clean) AddClean(*problem.clean, estimate);
  }

  void Finish() {
    if (row_.pairs == 0) return;
    row_.num_matches = static_cast<int>(std::lround(matches_ / row_.pairs));
    row_.time_ms = ComputeStatistics(times_);
    row_.time_spread_ms = QuartileDistance(times_);
    row_.ransac_ms = Median(ransac_).value_or(0.0);
    row_.refine_ms = Median(refine_).value_or(0.0);
    row_.iterations = Median(iterations_).value_or(0.0);
    row_.inlier_ratio = Median(inliers_).value_or(0.0);
    row_.rotation_deg = Median(rotation_);
    row_.direction_deg = Median(direction_);
    row_.clean_rotation_deg = Median(clean_rotation_);
    row_.clean_direction_deg = Median(clean_direction_);
    row_.efficiency_rotation = Efficiency(good_rotation_, bound_rotation_);
    row_.efficiency_direction = Efficiency(good_direction_, bound_direction_);
    if (with_bound_ == row_.pairs) {
      row_.success = successes_ / static_cast<double>(row_.pairs);
      row_.missed = missed_;
    }
    if (with_clean_ == row_.pairs) {
      row_.static_wins = static_wins_ / static_cast<double>(row_.pairs);
    }
  }

 private:
  void AddSuccess(const Problem& problem, const MotionEstimate& estimate,
                  std::optional<double> rotation) {
    const FramePair& pair = problem.clean ? *problem.clean : problem.pair;
    const RefineOptions refine = RefinementOf(task_, pair);
    const auto bound = ComputeCramerRaoBound(refine, pair);
    if (!bound) return;
    ++with_bound_;
    const double limit = kSuccessBounds * RadToDeg(bound->rotation);
    if (rotation && *rotation <= limit) {
      ++successes_;
      good_rotation_.push_back(*rotation);
      bound_rotation_.push_back(RadToDeg(bound->rotation));
      const auto direction = DirectionDeg(*pair.truth, estimate);
      if (direction && std::isfinite(bound->direction)) {
        good_direction_.push_back(*direction);
        bound_direction_.push_back(RadToDeg(bound->direction));
      }
      return;
    }
    // Would the same refinement have found it from the best start there is?
    Pose pose = *pair.truth;
    const RefineSummary summary =
        Refine(refine, problem.pair.rig, problem.pair.matches, problem.pair.prior, &pose);
    if (summary.IsSolutionUsable() && RotationDeg(*pair.truth, pose) <= limit) ++missed_;
  }

  void AddClean(const FramePair& clean, const MotionEstimate& estimate) {
    ++with_clean_;
    if (estimate.HasMotion() &&
        HoldsStaticMatches(clean, estimate.pose,
                           ThresholdPx(task_.estimate.ransac.threshold_px, clean.rig))) {
      ++static_wins_;
    }
    const MotionEstimate undisturbed = EstimateOnce(task_, clean);
    if (!undisturbed.HasMotion()) return;
    clean_rotation_.push_back(RotationDeg(*clean.truth, undisturbed.pose));
    const auto direction = DirectionDeg(*clean.truth, undisturbed);
    if (direction) clean_direction_.push_back(*direction);
  }

  const Task& task_;
  RansacBenchmarkRow& row_;
  double matches_ = 0.0;
  int with_bound_ = 0, with_clean_ = 0, successes_ = 0, missed_ = 0, static_wins_ = 0;
  std::vector<double> times_, ransac_, refine_, iterations_, inliers_;
  std::vector<double> rotation_, direction_, clean_rotation_, clean_direction_;
  std::vector<double> good_rotation_, bound_rotation_, good_direction_, bound_direction_;
};

RansacBenchmarkRow RunTask(const Task& task, const std::vector<Problem>& problems) {
  RansacBenchmarkRow row;
  row.solver = task.opengv.empty() ? task.estimate.solver : task.opengv;
  row.form = task.opengv.empty() ? RefineFormName(task.estimate.refine.form) : "own";
  row.variant = task.variant;
  row.outlier_share = task.scene.outlier_share;
  row.moving_share = task.scene.moving_share;
  Collector collector(task, &row);
  for (const Problem& problem : problems) collector.Add(problem);
  collector.Finish();
  return row;
}

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
      {"min_iterations 1", [](EstimateOptions* o) { o->ransac.min_iterations = 1; }},
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

std::vector<Task> MakeTasks(const RansacBenchmarkOptions& options) {
  Task base;
  base.scene.num_matches = 626;
  base.scene.outlier_share = 0.3;
  base.scene.match_scores = true;
  base.scene.seed = options.seed;
  base.estimate.ransac.seed = options.seed;
  const std::vector<std::string> solvers =
      options.solvers.empty() ? DefaultSolvers(options.experiment) : options.solvers;
  const auto with_solver = [](Task task, const std::string& solver) {
    task.estimate.solver = solver;
    const bool planar = FindSolver(solver)->prior == PriorKind::kPlanar;
    task.scene.motion = planar ? MotionPattern::kPlanar : MotionPattern::kRandom;
    return task;
  };

  std::vector<Task> tasks;
  switch (options.experiment) {
    case RansacExperiment::kSpeed:
    case RansacExperiment::kFiles:
      for (const std::string& solver : solvers) {
        Task task = with_solver(base, solver);
        tasks.push_back(task);
        if (FindSolver(solver)->prior == PriorKind::kNone) continue;
        task.estimate.refine.form = RefineForm::kPrior;
        tasks.push_back(task);
      }
      if (!options.solvers.empty()) break;
      for (const SolverInfo& peer : OpenGvPeers()) {
        // Its bound is that of the form full.
        Task task = with_solver(base, "17pt-li");
        task.opengv = peer.name;
        tasks.push_back(task);
      }
      break;
    case RansacExperiment::kOutliers:
      for (int percent = 10; percent <= 80; percent += 10) {
        // Matches at every share, so that the rows differ in the outliers alone.
        constexpr int kInliers = 300;
        const int all = static_cast<int>(std::lround(kInliers * 100.0 / (100 - percent)));
        Task task = base;
        task.scene.num_matches = all;
        task.scene.outlier_share = (all - kInliers) / static_cast<double>(all);
        for (const std::string& solver : solvers) tasks.push_back(with_solver(task, solver));
      }
      break;
    case RansacExperiment::kAblation:
      for (const double share : {0.3, 0.7}) {
        for (const std::string& solver : solvers) {
          for (const Variant& variant : Variants()) {
            Task task = with_solver(base, solver);
            task.scene.outlier_share = share;
            task.variant = variant.name;
            variant.modify(&task.estimate);
            tasks.push_back(task);
          }
        }
      }
      break;
    case RansacExperiment::kMoving:
      for (const auto& [moving, outliers] :
           std::vector<std::pair<double, double>>{{0.3, 0.0}, {0.3, 0.3}, {0.45, 0.0}}) {
        Task task = base;
        task.scene.moving_share = moving;
        task.scene.outlier_share = outliers;
        for (const std::string& solver : solvers) tasks.push_back(with_solver(task, solver));
      }
      break;
  }
  return tasks;
}

constexpr std::pair<RansacExperiment, const char*> kNames[] = {
    {RansacExperiment::kSpeed, "speed"},
    {RansacExperiment::kOutliers, "outliers"},
    {RansacExperiment::kAblation, "ablation"},
    {RansacExperiment::kMoving, "moving"},
    {RansacExperiment::kFiles, "files"}};

}  // namespace

bool ParseRansacExperiment(std::string_view name, RansacExperiment* experiment) {
  for (const auto& [value, text] : kNames) {
    if (name != text || value == RansacExperiment::kFiles) continue;
    *experiment = value;
    return true;
  }
  return false;
}

const char* RansacExperimentName(RansacExperiment experiment) {
  for (const auto& [value, text] : kNames) {
    if (value == experiment) return text;
  }
  return "unknown";
}

int CountRansacRows(const RansacBenchmarkOptions& options) {
  return static_cast<int>(MakeTasks(options).size());
}

std::vector<RansacBenchmarkRow> BenchmarkRansac(const RansacBenchmarkOptions& options,
                                                const std::function<void()>& progress) {
  std::vector<RansacBenchmarkRow> rows;
  for (const Task& task : MakeTasks(options)) {
    const int pairs = task.opengv.empty() ? options.pairs : std::min(options.pairs, kOpenGvPairs);
    rows.push_back(RunTask(task, MakeProblems(task.scene, pairs)));
    if (progress) progress();
  }
  return rows;
}

std::vector<RansacBenchmarkRow> BenchmarkRansacOnFiles(const RansacBenchmarkOptions& options,
                                                       const std::vector<FramePair>& pairs) {
  std::vector<Problem> problems;
  for (const FramePair& pair : pairs) problems.push_back({pair, std::nullopt});
  std::vector<RansacBenchmarkRow> rows;
  for (Task& task : MakeTasks(options)) {
    // No prior of a file is exact.
    if (!task.opengv.empty() || task.estimate.refine.form != RefineForm::kFull) continue;
    const PriorKind kind = FindSolver(task.estimate.solver)->prior;
    const bool usable = std::all_of(pairs.begin(), pairs.end(), [kind](const FramePair& pair) {
      return HasPrior(pair.prior, kind);
    });
    if (!usable && options.solvers.empty()) continue;
    task.scene.outlier_share = 0.0;
    rows.push_back(RunTask(task, problems));
  }
  return rows;
}

}  // namespace rigel
