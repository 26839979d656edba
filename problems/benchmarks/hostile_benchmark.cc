#include "rigel/problems/benchmarks/hostile_benchmark.h"

#include <ctime>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "rigel/core/random.h"
#include "rigel/core/statistics.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/refine/solver_choice.h"

namespace rigel {
namespace {

// Matches of a pair: a usual number, a large one, and one that shows the time of a match.
constexpr int kSizes[] = {200, 2000, 200000};
// Matches, those of the last size: a pair takes long, and one is measured.
constexpr int kHuge = 200000;

std::vector<std::string> SolversOf(const HostileBenchmarkOptions& options) {
  if (!options.solvers.empty()) return options.solvers;
  std::vector<std::string> solvers;
  for (const SolverInfo& solver : SolverCatalogue()) solvers.emplace_back(solver.name);
  solvers.emplace_back(kAutoSolver);
  return solvers;
}

double ThreadMilliseconds() {
  std::timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

FramePair MakeHostilePair(int num_matches, uint64_t seed) {
  // Pixels. Any size would do, as the matches are at random places.
  constexpr int kWidth = 640, kHeight = 480;
  FramePair pair;
  pair.prior.gravity1 = pair.prior.gravity2 = Eigen::Vector3d::UnitY();
  pair.prior.axis = pair.prior.normal = Eigen::Vector3d::UnitY();
  for (const double side : {-0.5, 0.5}) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 400.0, 0.5 * kWidth, 0.5 * kHeight, kWidth, kHeight);
    camera.s = Eigen::Vector3d(side, 0.0, 0.0);
    pair.rig.cameras.push_back(camera);
  }
  Random random(seed);
  pair.matches.resize(num_matches);
  for (Match& match : pair.matches) {
    match.camera1 = random.Index(2);
    match.camera2 = random.Index(2);
    for (Pixel* pixel : {&match.pixel1, &match.pixel2}) {
      pixel->x() = random.Uniform(0.0, kWidth);
      pixel->y() = random.Uniform(0.0, kHeight);
    }
    match.score = random.Uniform(0.0, 1.0);
  }
  return pair;
}

int CountHostileRows(const HostileBenchmarkOptions& options) {
  return static_cast<int>(SolversOf(options).size() * std::size(kSizes));
}

std::vector<HostileBenchmarkRow> BenchmarkHostile(const HostileBenchmarkOptions& options,
                                                  const std::function<void()>& progress) {
  std::vector<HostileBenchmarkRow> rows;
  for (const int size : kSizes) {
    for (const std::string& solver : SolversOf(options)) {
      HostileBenchmarkRow row;
      row.solver = solver;
      row.num_matches = size;
      row.pairs = size == kHuge ? 1 : options.pairs;
      EstimateOptions estimate;
      estimate.solver = solver;
      estimate.ransac.seed = options.seed;
      std::vector<double> times;
      for (int k = 0; k < row.pairs; ++k) {
        const FramePair pair = MakeHostilePair(size, options.seed + static_cast<uint64_t>(k));
        const double start = ThreadMilliseconds();
        row.motions += EstimateMotion(estimate, pair).HasMotion() ? 1 : 0;
        times.push_back(ThreadMilliseconds() - start);
      }
      row.largest_ms = *std::max_element(times.begin(), times.end());
      row.median_ms = ComputeStatistics(times)->median;
      rows.push_back(row);
      if (progress) progress();
    }
  }
  return rows;
}

std::string HostileBenchmarkTable(const std::vector<HostileBenchmarkRow>& rows) {
  Table table(2);
  table.AddHeader({"", "", "", "CPU time", "[ms]", ""});
  table.AddHeader({"matches", "solver", "pairs", "median", "largest", "motions"});
  for (const HostileBenchmarkRow& row : rows) {
    table.AddRow({std::to_string(row.num_matches), row.solver, std::to_string(row.pairs),
                  FormatNumber(row.median_ms, 1), FormatNumber(row.largest_ms, 1),
                  std::to_string(row.motions)});
  }
  return table.Format();
}

std::string HostileBenchmarkJson(const std::vector<HostileBenchmarkRow>& rows,
                                 const HostileBenchmarkOptions& options) {
  nlohmann::ordered_json report = NewReport("rigel-ransac-benchmark 1");
  report["experiment"] = "hostile";
  report["options"] = {{"seed", options.seed}};
  report["results"] = nlohmann::ordered_json::array();
  for (const HostileBenchmarkRow& row : rows) {
    report["results"].push_back({{"solver", row.solver},
                                 {"matches", row.num_matches},
                                 {"pairs", row.pairs},
                                 {"motions", row.motions},
                                 {"cpu_ms", {{"median", row.median_ms}, {"max", row.largest_ms}}}});
  }
  return JsonText(report, 2) + "\n";
}

}  // namespace rigel
