#include "rigel/problems/benchmarks/refine_benchmark.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/core/random.h"
#include "rigel/core/statistics.h"
#include "rigel/problems/benchmarks/opengv_peers.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/least_squares/epipolar_residuals.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/small_engine.h"
#include "rigel/refine/refine.h"

namespace rigel {
namespace {

// Pixels, 1 sigma of a coordinate: that of docs/refinement_tables.md.
constexpr double kNoisePx = 0.5;
// Runs of a problem. The fastest counts, as disturbances only add time.
constexpr int kRepetitions = 5;
// Of the small engine: the scale of the loss in sigmas, the limit of iterations and the relative
// step that ends them; these are what Refine() takes.
constexpr double kLossScaleSigmas = 4.0;
constexpr int kMaxIterations = 20;
constexpr double kTolerance = 1e-12;
// Pixels. A start that is off by a degree is off by 7 pixels: none is gated.
constexpr double kThresholdPx = 30.0;

struct Problem {
  FramePair pair;
  GroupedMatches matches;
  Pose start;
};

std::vector<Problem> MakeProblems(const RefineBenchmarkOptions& options) {
  SceneOptions scene;
  scene.num_matches = options.num_matches;
  scene.noise_px = kNoisePx;
  scene.rotation_deg = options.rotation_deg;
  scene.motion = MotionPattern::kRandom;
  scene.inter_share = 0.5;
  scene.seed = options.seed;
  std::vector<Problem> problems;
  for (int k = 0; k < options.problems; ++k) {
    FramePair pair;
    std::string error;
    if (!MakeScenePair(scene, k, &pair, &error)) continue;
    Random random = Random::Stream(options.seed, static_cast<uint64_t>(k));
    const double angle = DegToRad(options.start_deg);
    Pose start = *pair.truth;
    start.R = ExpSO3(angle * random.UnitVector3()) * start.R;
    const Eigen::Vector2d across = Eigen::Vector2d{random.Normal(), random.Normal()}.normalized();
    start.t += std::tan(angle) * start.t.norm() * (TangentBasis(start.t.normalized()) * across);
    GroupedMatches matches(pair.rig, pair.matches);
    problems.push_back({std::move(pair), std::move(matches), start});
  }
  return problems;
}

// Refines the pose; false if there is no usable result.
using Engine = std::function<bool(const Problem&, Pose*, int* iterations)>;

RefineBenchmarkRow Run(const std::string& name, const std::string& loss,
                       const std::vector<Problem>& problems, const Engine& engine) {
  RefineBenchmarkRow row;
  row.engine = name;
  row.loss = loss;
  std::vector<double> times, rotations, directions;
  double iterations = 0.0;
  int failures = 0;
  for (const Problem& problem : problems) {
    double best = std::numeric_limits<double>::infinity();
    Pose pose;
    int count = -1;
    bool ok = false;
    for (int k = 0; k < kRepetitions; ++k) {
      pose = problem.start;
      const auto begin = std::chrono::steady_clock::now();
      ok = engine(problem, &pose, &count);
      const std::chrono::duration<double, std::micro> time =
          std::chrono::steady_clock::now() - begin;
      best = std::min(best, time.count());
    }
    times.push_back(best);
    iterations += count;
    failures += ok ? 0 : 1;
    if (!ok) continue;
    rotations.push_back(RadToDeg(RotationError(problem.pair.truth->R, pose.R)));
    directions.push_back(RadToDeg(TranslationDirectionError(problem.pair.truth->t, pose.t)));
  }
  row.failures = failures / static_cast<double>(problems.size());
  row.iterations = iterations / static_cast<double>(problems.size());
  if (const auto s = ComputeStatistics(times)) row.median_us = s->median;
  if (const auto s = ComputeStatistics(rotations)) row.rotation_deg = s->rms;
  if (const auto s = ComputeStatistics(directions)) row.translation_dir_deg = s->rms;
  row.spread_us = QuartileDistance(times);
  return row;
}

}  // namespace

std::vector<RefineBenchmarkRow> BenchmarkRefinement(const RefineBenchmarkOptions& options) {
  const std::vector<Problem> problems = MakeProblems(options);
  std::vector<RefineBenchmarkRow> rows;
  if (problems.empty()) return rows;
  for (const LossKind loss : {LossKind::kNone, LossKind::kCauchy}) {
    rows.push_back(Run("small engine", LossName(loss), problems,
                       [loss](const Problem& problem, Pose* pose, int* iterations) {
                         SmallEngine engine(problem.matches);
                         const std::vector<char> mask(problem.matches.size(), 1);
                         LeastSquaresOptions small;
                         small.loss = loss;
                         small.loss_scale = kLossScaleSigmas * kNoisePx;
                         small.max_num_iterations = kMaxIterations;
                         small.tolerance = kTolerance;
                         const bool ok = engine.Minimize(small, mask, PriorResiduals(), 1.0, pose);
                         *iterations = engine.num_iterations();
                         return ok;
                       }));
    struct Call {
      RefineForm form;
      RefineEngine engine;
      const char* name;
    };
    for (const Call& call :
         {Call{RefineForm::kFull, RefineEngine::kAuto, "Refine() full"},
          Call{RefineForm::kDepths, RefineEngine::kAuto, "Refine() depths"},
          Call{RefineForm::kFull, RefineEngine::kCeres, "Refine() full, ceres::Problem"},
          Call{RefineForm::kBundle, RefineEngine::kCeres, "Refine() bundle, ceres::Problem"}}) {
      rows.push_back(Run(call.name, LossName(loss), problems,
                         [loss, call](const Problem& problem, Pose* pose, int* iterations) {
                           RefineOptions refine;
                           refine.form = call.form;
                           refine.engine = call.engine;
                           refine.loss = loss;
                           refine.noise_px = kNoisePx;
                           refine.threshold_px = kThresholdPx;
                           const RefineSummary summary =
                               Refine(refine, problem.matches, problem.pair.prior, pose);
                           *iterations = summary.num_iterations;
                           return summary.IsSolutionUsable();
                         }));
    }
  }
  if (!OpenGvPeers().empty()) {
    rows.push_back(Run("opengv", "none", problems,
                       [](const Problem& problem, Pose* pose, int* /*iterations*/) {
                         return RefineWithOpenGv(problem.matches, pose);
                       }));
  }
  return rows;
}

std::string RefineBenchmarkTable(const std::vector<RefineBenchmarkRow>& rows) {
  Table table(2);
  table.AddHeader({"", "", "time [us]", "", "itera-", "RMS error", "[deg]", ""});
  table.AddHeader(
      {"refinement", "loss", "median", "spread", "tions", "rotation", "direction", "fail"});
  for (const RefineBenchmarkRow& row : rows) {
    table.AddRow({row.engine, row.loss, FormatNumber(row.median_us, 0),
                  FormatNumber(row.spread_us, 0),
                  row.iterations < 0 ? "-" : FormatNumber(row.iterations, 1),
                  FormatNumber(row.rotation_deg, 4), FormatNumber(row.translation_dir_deg, 3),
                  FormatNumber(row.failures, 3)});
  }
  return table.Format();
}

std::string RefineBenchmarkJson(const std::vector<RefineBenchmarkRow>& rows,
                                const RefineBenchmarkOptions& options) {
  nlohmann::ordered_json report = NewReport("rigel-refine-benchmark 1");
  report["options"] = {{"problems", options.problems},
                       {"num_matches", options.num_matches},
                       {"rotation_deg", options.rotation_deg},
                       {"start_deg", options.start_deg},
                       {"seed", options.seed}};
  report["results"] = nlohmann::ordered_json::array();
  for (const RefineBenchmarkRow& row : rows) {
    report["results"].push_back({{"refinement", row.engine},
                                 {"loss", row.loss},
                                 {"median_us", row.median_us},
                                 {"spread_us", row.spread_us},
                                 {"iterations", row.iterations},
                                 {"rotation_deg", row.rotation_deg},
                                 {"translation_dir_deg", row.translation_dir_deg},
                                 {"failures", row.failures}});
  }
  return JsonText(report, 2) + "\n";
}

}  // namespace rigel
