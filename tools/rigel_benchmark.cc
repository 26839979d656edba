// rigel_benchmark: time and reliability of the minimal solvers.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gflags/gflags.h>

#include "rigel/problems/opengv_peers.h"
#include "rigel/problems/refine_benchmark.h"
#include "rigel/problems/solver_benchmark.h"
#include "rigel/problems/table.h"
#include "rigel/tools/tool.h"

DEFINE_string(solvers, "", "names of solvers, comma separated; all if empty");
DEFINE_int32(num_cameras, 2, "cameras of the rig, 1 to 4");
DEFINE_int32(trials, 10000, "random problems a solver and kind of sample");
DEFINE_double(rotation_deg, 1, "rotation angle of the problems; 0 is pure translation");
DEFINE_bool(random_axis, false,
            "turn about a random axis instead of the body's Y (not for planar motion)");
DEFINE_bool(refine, false,
            "time the refinement instead of the solvers: 600 inliers, from a hypothesis 1 deg off");
DEFINE_uint64(seed, 1, "the same seed makes the same problems");
DEFINE_string(json, "", "write the results (format rigel-benchmark 1) to this file; - is stdout");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_benchmark: how fast the minimal solvers are and how often they find the truth.\n"
    "\n"
    "  rigel_benchmark --solvers=4pt,4pt-approx --trials=10000\n"
    "\n"
    "Noise-free random problems of the scene (see rigel_simulate), one row for samples within the\n"
    "cameras (intra) and one between them (inter). Timed is one call, from prepared matches to the "
    "list\n"
    "of (R, t), in batches of at least 50 us. The ratio is to a 4x4 LU solve by Eigen in the same "
    "run.\n"
    "found truth: share of problems with a solution whose rotation is within 1e-6 rad of it; with\n"
    "--rotation_deg=0 its translation direction must be within 1e-4 rad, too. best root: the "
    "median\n"
    "error of the solution nearest to the truth, which for a first-order solver is its bias.\n";

int RunRefinement() {
  RefineBenchmarkOptions options;
  options.problems = std::min(FLAGS_trials, 200);
  options.rotation_deg = FLAGS_rotation_deg;
  options.seed = FLAGS_seed;
  const std::vector<RefineBenchmarkRow> rows = BenchmarkRefinement(options);
  bool ok = true;
  if (FLAGS_json != "-") {
    std::cout << RefineBenchmarkTable(rows)
              << "\nmedian over the problems of the least of five repetitions; "
              << options.num_matches << " matches, 0.5 px, start 1 deg off\n";
    ok = FlushStdout();
  }
  ok = WriteOutput(FLAGS_json, RefineBenchmarkJson(rows, options)) && ok;
  return ok ? kExitDone : kExitFailed;
}

int Run() {
  SolverBenchmarkOptions options;
  options.num_cameras = FLAGS_num_cameras;
  options.trials = FLAGS_trials;
  options.rotation_deg = FLAGS_rotation_deg;
  options.random_axis = FLAGS_random_axis;
  options.seed = FLAGS_seed;
  if (FLAGS_num_cameras < 1 || FLAGS_num_cameras > 4)
    return UsageError("--num_cameras: expected 1 to 4");
  if (FLAGS_trials < 1) return UsageError("--trials: expected at least 1");
  if (!std::isfinite(FLAGS_rotation_deg)) return UsageError("--rotation_deg: expected a number");
  if (FLAGS_refine && !FLAGS_solvers.empty()) {
    return UsageError("--solvers: --refine times no solver");
  }
  if (FLAGS_refine) return RunRefinement();
  std::vector<const SolverInfo*> solvers;
  const std::vector<std::string> names = SplitCommas(FLAGS_solvers);
  if (!FLAGS_solvers.empty() && names.empty()) {
    return UsageError("--solvers=" + FLAGS_solvers + ": names no solver");
  }
  for (const std::string& name : names) {
    const SolverInfo* found = FindSolver(name);
    for (const SolverInfo& peer : OpenGvPeers()) {
      if (name == peer.name) found = &peer;
    }
    solvers.push_back(found);
    if (found == nullptr) {
      return UsageError("--solvers: there is no solver '" + name + "'; expected some of " +
                        SolverNames());
    }
  }
  if (solvers.empty()) {
    for (const SolverInfo& solver : SolverCatalogue()) solvers.push_back(&solver);
    for (const SolverInfo& solver : OpenGvPeers()) solvers.push_back(&solver);
  }

  bool ok = true;
  std::vector<SolverBenchmarkRow> rows;
  {
    Progress progress("rigel_benchmark", static_cast<int>(solvers.size()));
    for (const SolverInfo* solver : solvers) {
      for (const SolverBenchmarkRow& row : BenchmarkSolver(*solver, options)) {
        if (row.mean_us > 0) {
          rows.push_back(row);
        } else {
          // There was no problem to solve.
          ok = false;
          std::cerr << row.solver << ", " << row.matches
                    << ": with --rotation_deg=" << FLAGS_rotation_deg
                    << " hardly any point stays in view\n";
        }
      }
      progress.Step();
    }
  }
  if (rows.empty()) return kExitFailed;
  const double reference = ReferenceKernelMicroseconds();
  if (FLAGS_json != "-") {
    std::cout << SolverBenchmarkTable(rows)
              << "\nreference kernel (4x4 LU solve by Eigen): " << FormatNumber(reference, 4)
              << " us; preparing a match: " << FormatNumber(rows[0].prepare_us, 3) << " us\n";
    const std::string paper = PaperTable1(rows);
    if (!paper.empty()) std::cout << "\n" << paper;
    ok = FlushStdout() && ok;
  }
  ok = WriteOutput(FLAGS_json, SolverBenchmarkJson(rows, options, reference)) && ok;
  return ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  rigel::ParseFlags(rigel::kUsage, &argc, &argv);
  return rigel::Run();
}
