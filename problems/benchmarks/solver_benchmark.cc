#include "rigel/problems/benchmarks/solver_benchmark.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <string_view>

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/metrics.h"
#include "rigel/core/random.h"
#include "rigel/core/statistics.h"
#include "rigel/minimal/ransac/sampler.h"
#include "rigel/problems/evaluation/paper_figures.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

using Clock = std::chrono::steady_clock;

// Microseconds of a batch at least: shorter intervals would measure the clock.
constexpr double kBatchMicroseconds = 50.0;
// Batches that the trial run lasts, so that its estimate of a call is good.
constexpr int kTrialBatches = 20;
// Batches are made longer than the least by this factor: the estimate of a call may be too large.
constexpr double kBatchMargin = 1.5;
// Pairs tried for each problem wanted: some motions leave nothing in view.
constexpr int kTriesPerProblem = 2;
// Samples' worth of matches of a pair from which a sampler draws one sample.
constexpr int kSamplesPerPair = 4;

struct Problem {
  FramePair pair;
  PreparedMatches matches;
  std::vector<int> sample;
};

double MicrosecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

// Times run(k) for k = 0..n-1 in batches, each once before to fill the caches; microseconds a call.
template <class Run>
std::vector<double> TimeBatches(int n, const Run& run) {
  // The size of a batch from a trial run.
  const auto trial_start = Clock::now();
  int calls = 0;
  while (MicrosecondsSince(trial_start) < kTrialBatches * kBatchMicroseconds) run(calls++ % n);
  const double estimate = MicrosecondsSince(trial_start) / calls;
  const int size =
      std::clamp(static_cast<int>(std::ceil(kBatchMargin * kBatchMicroseconds / estimate)), 1, n);
  const int repeats = std::max(
      1, static_cast<int>(std::ceil(kBatchMargin * kBatchMicroseconds / (estimate * size))));
  std::vector<double> times;
  for (int begin = 0; begin + size <= n; begin += size) {
    for (int k = begin; k < begin + size; ++k) run(k);
    const auto start = Clock::now();
    for (int r = 0; r < repeats; ++r) {
      for (int k = begin; k < begin + size; ++k) run(k);
    }
    times.push_back(MicrosecondsSince(start) / (size * repeats));
  }
  return times;
}

std::string ProcessorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown processor";
}

std::vector<Problem> MakeProblems(const SolverInfo& solver, const SolverBenchmarkOptions& options,
                                  bool inter) {
  SceneOptions scene;
  scene.num_cameras = options.num_cameras;
  // Matches alternate between cameras. A solver that needs a sample of one camera pair gets more
  // matches, and a sampler picks the sample.
  const bool any_sample = solver.sampling == SampleKind::kSpread;
  scene.num_matches = any_sample ? solver.sample_size : kSamplesPerPair * solver.sample_size;
  scene.noise_px = 0.0;
  scene.rotation_deg = options.rotation_deg;
  scene.motion = MotionPattern::kRandom;
  if (options.random_axis) scene.rotation_axis = RotationAxisPattern::kRandom;
  if (solver.prior == PriorKind::kPlanar) {
    scene.motion = MotionPattern::kPlanar;
    scene.rotation_axis = RotationAxisPattern::kY;
  }
  scene.inter_share = inter ? 1.0 : 0.0;
  scene.seed = options.seed;
  std::vector<Problem> problems;
  problems.reserve(options.trials);
  for (int k = 0;
       static_cast<int>(problems.size()) < options.trials && k < kTriesPerProblem * options.trials;
       ++k) {
    Problem problem;
    std::string error;
    Alignment alignment;
    // Fails for a rig whose cameras see nothing in common after a large motion.
    if (!MakeScenePair(scene, k, &problem.pair, &error)) continue;
    // Ackermann motion is on a circle, forwards: the chord is at half of the rotation angle.
    if (std::string_view(solver.name) == "2pt-ackermann") {
      Pose truth = *problem.pair.truth;
      truth.t = -(RotationY(DegToRad(0.5 * options.rotation_deg)) * Eigen::Vector3d::UnitZ());
      if (!MakeScenePair(scene, k, truth, &problem.pair, &error)) continue;
      problem.pair.prior.normal = Eigen::Vector3d::UnitY();
      problem.pair.prior.forward = Eigen::Vector3d::UnitZ();
    }
    if (!MakeAlignment(problem.pair.prior, solver.prior, &alignment, &error)) continue;
    problem.sample.resize(solver.sample_size);
    if (any_sample) {
      std::iota(problem.sample.begin(), problem.sample.end(), 0);
    } else {
      const GroupedMatches grouped(problem.pair.rig, problem.pair.matches);
      problem.pair.matches = grouped.matches();
      std::vector<size_t> rows;
      for (int m = 0; m < grouped.size(); ++m) rows.push_back(grouped.original(m));
      problem.pair.columns = problem.pair.columns.Subset(rows);
      Random random = Random::Stream(options.seed, static_cast<uint64_t>(k));
      const Sampler sampler(grouped.groups(), solver.sampling, solver.sample_size);
      if (!sampler.Draw(&random, problem.sample.data())) continue;
    }
    problem.matches.Set(problem.pair.rig, problem.pair.matches, alignment);
    problems.push_back(std::move(problem));
  }
  return problems;
}

// How near the solutions of one problem come to the truth; infinite without a solution.
struct NearestSolution {
  double rotation = std::numeric_limits<double>::infinity();
  double direction =
      std::numeric_limits<double>::infinity();  // of the solution nearest in rotation
  bool is_truth = false;  // one solution has both the rotation and the direction
};

NearestSolution FindNearest(const Pose& truth, const Solutions& solutions) {
  NearestSolution nearest;
  for (const Solution& solution : solutions) {
    const double rotation = RotationError(truth.R, solution.R);
    const double direction = TranslationDirectionError(truth.t, solution.t);
    if (rotation < nearest.rotation) {
      nearest.rotation = rotation;
      nearest.direction = direction;
    }
    nearest.is_truth =
        nearest.is_truth || (rotation < kFoundRotation && direction < kFoundDirection);
  }
  return nearest;
}

// Fills in what the solver finds.
void MeasureSolutions(const SolverInfo& solver, const std::vector<Problem>& problems,
                      bool rotation_is_zero, SolverBenchmarkRow* row) {
  Solutions solutions;
  std::vector<double> rotations, directions;
  int found_truth = 0, found_direction = 0, failures = 0;
  double num_solutions = 0;
  for (const Problem& problem : problems) {
    solver.solve(problem.matches, problem.sample.data(), &solutions);
    num_solutions += solutions.size();
    failures += solutions.empty() ? 1 : 0;
    const NearestSolution nearest = FindNearest(*problem.pair.truth, solutions);
    found_truth += nearest.rotation < kFoundRotation ? 1 : 0;
    found_direction += nearest.is_truth ? 1 : 0;
    if (std::isfinite(nearest.rotation)) rotations.push_back(RadToDeg(nearest.rotation));
    if (std::isfinite(nearest.direction)) directions.push_back(RadToDeg(nearest.direction));
  }
  const auto n = static_cast<double>(problems.size());
  row->solutions = num_solutions / n;
  row->failures = failures / n;
  row->found_direction = found_direction / n;
  row->found_truth = rotation_is_zero ? row->found_direction : found_truth / n;
  if (const auto s = ComputeStatistics(rotations)) row->rotation_deg = s->median;
  if (const auto s = ComputeStatistics(directions)) row->translation_dir_deg = s->median;
}

// Fills in the times.
void MeasureTimes(const SolverInfo& solver, std::vector<Problem>* problems,
                  SolverBenchmarkRow* row) {
  const int n = static_cast<int>(problems->size());
  Solutions solutions;
  // The reference is timed right before and after, as the clock rate of a shared machine changes.
  const double reference_before = ReferenceKernelMicroseconds();
  // By value: the loop shall not read again where the problems are.
  const std::vector<double> times =
      TimeBatches(n, [first = problems->data(), solve = solver.solve, &solutions](int k) {
        solve(first[k].matches, first[k].sample.data(), &solutions);
      });
  if (const auto s = ComputeStatistics(times)) {
    row->mean_us = s->mean;
    row->median_us = s->median;
  }
  row->spread_us = QuartileDistance(times);
  const double reference = 0.5 * (reference_before + ReferenceKernelMicroseconds());
  if (reference > 0) row->ratio = row->median_us / reference;

  const std::vector<double> prepare = TimeBatches(n, [&](int k) {
    Problem& problem = (*problems)[k];
    problem.matches.Set(problem.pair.rig, problem.pair.matches, problem.matches.alignment());
  });
  if (const auto s = ComputeStatistics(prepare)) {
    row->prepare_us = s->median / static_cast<double>(problems->front().pair.matches.size());
  }
}

SolverBenchmarkRow BenchmarkRow(const SolverInfo& solver, const SolverBenchmarkOptions& options,
                                bool inter) {
  SolverBenchmarkRow row;
  row.solver = solver.name;
  row.matches = inter ? "inter" : "intra";
  std::vector<Problem> problems = MakeProblems(solver, options, inter);
  if (problems.empty()) return row;
  MeasureSolutions(solver, problems, options.rotation_deg == 0.0, &row);
  MeasureTimes(solver, &problems, &row);
  return row;
}

}  // namespace

double ReferenceKernelMicroseconds() {
  constexpr int kProblems = 20000;  // some 25 batches, for their median
  std::vector<Eigen::Matrix4d> matrices;
  Random random(7);
  for (int k = 0; k < kProblems; ++k) {
    Eigen::Matrix4d m;
    for (int i = 0; i < 16; ++i) m(i) = random.Normal();
    matrices.push_back(m);
  }
  const Eigen::Vector4d right(1, 2, 3, 4);
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  const std::vector<double> times =
      TimeBatches(kProblems, [&](int k) { sum += matrices[k].partialPivLu().solve(right); });
  const auto statistics = ComputeStatistics(times);
  // The sum is used, so that the compiler does not remove the work.
  return statistics && std::isfinite(sum.sum()) ? statistics->median : 0.0;
}

std::vector<SolverBenchmarkRow> BenchmarkSolver(const SolverInfo& solver,
                                                const SolverBenchmarkOptions& options) {
  std::vector<SolverBenchmarkRow> rows;
  for (const bool inter : {false, true}) {
    if (inter && (solver.sampling == SampleKind::kOneCamera || options.num_cameras < 2)) continue;
    rows.push_back(BenchmarkRow(solver, options, inter));
  }
  return rows;
}

std::string PaperTable1(const std::vector<SolverBenchmarkRow>& rows) {
  Table table;
  table.AddHeader({"Table 1 of the paper, us", "paper", "", "here", "", "times"});
  table.AddHeader({"mean and median", "mean", "median", "mean", "median", "faster"});
  bool any = false;
  for (const std::string_view solver : PaperSolvers()) {
    const double mean_us = *PaperFigure(PaperTable::kCallMeanUs, solver, "all");
    const double median_us = *PaperFigure(PaperTable::kCallMedianUs, solver, "all");
    for (const SolverBenchmarkRow& row : rows) {
      if (row.solver != solver || row.matches != "intra" || !(row.median_us > 0)) continue;
      any = true;
      table.AddRow({row.solver, FormatNumber(mean_us, 2), FormatNumber(median_us, 0),
                    FormatFitted(row.mean_us, 3, 5), FormatFitted(row.median_us, 3, 5),
                    FormatNumber(median_us / row.median_us, 0)});
    }
  }
  if (!any) return "";
  return table.Format() + "paper: AMD R9-7945HX 2.50 GHz; here: " + ProcessorName() + "\n";
}

std::string SolverBenchmarkTable(const std::vector<SolverBenchmarkRow>& rows) {
  Table table(1);
  table.AddHeader(
      {"", "", " time", "[us]", "", "", " solu-", "no", "found", " best root", "[deg]"});
  table.AddHeader({"solver", "sample", " mean", "median", "spread", "ratio", " tions", "sol.",
                   "truth", " rotation", "direction"});
  for (const SolverBenchmarkRow& row : rows) {
    // The widths given keep it to 100 columns with the longest solver name.
    table.AddRow({row.solver, row.matches, " " + FormatFitted(row.mean_us, 3, 5),
                  FormatFitted(row.median_us, 3, 5), FormatFitted(row.spread_us, 3, 5),
                  FormatFitted(row.ratio, 2, 5), " " + FormatNumber(row.solutions, 2),
                  FormatNumber(row.failures, 3), FormatNumber(row.found_truth, 4),
                  " " + FormatNumber(row.rotation_deg, 5),
                  FormatNumber(row.translation_dir_deg, 4)});
  }
  return table.Format();
}

std::string SolverBenchmarkJson(const std::vector<SolverBenchmarkRow>& rows,
                                const SolverBenchmarkOptions& options, double reference_us) {
  nlohmann::ordered_json report = NewReport("rigel-benchmark 1");
  report["options"] = {{"num_cameras", options.num_cameras},
                       {"trials", options.trials},
                       {"rotation_deg", options.rotation_deg},
                       {"random_axis", options.random_axis},
                       {"seed", options.seed}};
  report["reference_us"] = reference_us;
  report["solvers"] = nlohmann::ordered_json::array();
  for (const SolverBenchmarkRow& row : rows) {
    report["solvers"].push_back({{"solver", row.solver},
                                 {"matches", row.matches},
                                 {"mean_us", row.mean_us},
                                 {"median_us", row.median_us},
                                 {"spread_us", row.spread_us},
                                 {"ratio", row.ratio},
                                 {"solutions", row.solutions},
                                 {"failures", row.failures},
                                 {"found_truth", row.found_truth},
                                 {"found_direction", row.found_direction},
                                 {"rotation_deg", row.rotation_deg},
                                 {"translation_dir_deg", row.translation_dir_deg},
                                 {"prepare_us", row.prepare_us}});
  }
  return JsonText(report, 2) + "\n";
}

}  // namespace rigel
