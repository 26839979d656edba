// rigel_benchmark: time and reliability of the minimal solvers, the refinement and the whole
// estimate.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gflags/gflags.h>

#include "rigel/problems/benchmarks/hostile_benchmark.h"
#include "rigel/problems/benchmarks/opengv_peers.h"
#include "rigel/problems/benchmarks/ransac_benchmark.h"
#include "rigel/problems/benchmarks/refine_benchmark.h"
#include "rigel/problems/benchmarks/solver_benchmark.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/scenes/prior_source.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/tool.h"

DEFINE_string(solvers, "", "names of solvers, comma separated; all if empty");
DEFINE_int32(num_cameras, 2, "cameras of the rig, 1 to 4");
DEFINE_int32(trials, 10000, "random problems a solver and kind of sample");
DEFINE_double(rotation_deg, 1, "rotation angle of the problems; 0 is pure translation");
DEFINE_bool(random_axis, false,
            "turn about a random axis instead of the body's Y (not for planar motion)");
DEFINE_bool(refine, false,
            "time the refinement instead of the solvers: 600 inliers, from a hypothesis 1 deg off");
DEFINE_string(
    ransac, "",
    "measure RANSAC and refinement instead: speed, outliers, ablation, moving or hostile");
DEFINE_int32(pairs, 200, "frame pairs of each scene of --ransac");
DEFINE_string(matches, "",
              "match files and directories, comma separated, instead of the scene of "
              "--ransac=speed");
DEFINE_string(prior, "file", "prior of --matches: file, body or truth, as in rigel_compare");
DEFINE_uint64(seed, 1, "the same seed makes the same problems");
DEFINE_string(json, "", "write the results as JSON (docs/formats.md) to this file; - is stdout");

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
    "error of the solution nearest to the truth, which for a first-order solver is its bias.\n"
    "\n"
    "  rigel_benchmark --ransac=speed|outliers|ablation|moving|hostile\n"
    "\n"
    "RANSAC and refinement on one thread, in scenes of random motion (planar for planar solvers),\n"
    "1 degree, 0.5 px, exact priors. speed: 626 matches, 30 percent outliers. outliers: 300 "
    "inliers\n"
    "and 10 to 80 percent outliers. ablation: parts of the estimator left out or added. moving: a\n"
    "car that moves by itself. Times are the least of three runs of a pair; clean: to the error\n"
    "from the inliers alone; bound: RMS error of the pairs that succeed to the RMS Cramer-Rao "
    "bound\n"
    "of their inliers; success: rotation within three bounds; missed: failed pairs that succeed "
    "if\n"
    "refined from the truth; static: the motion holds nine in ten of the static matches that the\n"
    "true one does. hostile: no match follows any motion; how long a pair takes at most, in time "
    "of\n"
    "the processor.\n";

// The first of these flags that was given; empty if none was.
std::string FirstGiven(const std::vector<std::string>& flags) {
  const std::vector<std::string> given = GivenFlags();
  for (const std::string& flag : flags) {
    if (std::find(given.begin(), given.end(), flag) != given.end()) return flag;
  }
  return "";
}

// Reads all files of --matches with their prior. False if any could not be read.
bool ReadPairs(const PriorSourceOptions& prior, std::vector<FramePair>* pairs) {
  std::vector<std::string> errors, notes;
  const std::vector<std::string> paths = ListMatchFiles(FLAGS_matches, &errors, &notes);
  for (const std::string& note : notes) std::cerr << note << "\n";
  for (size_t k = 0; k < paths.size(); ++k) {
    FramePair pair;
    std::string error;
    if (ReadMatchFile(paths[k], &pair, &error) &&
        ApplyPriorSource(prior, static_cast<int>(k), &pair, &error)) {
      pairs->push_back(std::move(pair));
    } else {
      errors.push_back(error);
    }
  }
  for (const std::string& error : errors) std::cerr << error << "\n";
  if (paths.empty()) std::cerr << "nothing to read in " << PrintablePath(FLAGS_matches) << "\n";
  return errors.empty() && !pairs->empty();
}

bool SolversAreKnown(const std::vector<std::string>& names, bool with_auto, std::string* error) {
  if (!FLAGS_solvers.empty() && names.empty()) {
    *error = "--solvers=" + FLAGS_solvers + ": names no solver";
    return false;
  }
  for (const std::string& name : names) {
    if (FindSolver(name) != nullptr || (with_auto && name == kAutoSolver)) continue;
    *error = "--solvers: there is no solver '" + name + "'; expected some of " +
             (with_auto ? SolverNamesWithAuto() : SolverNames());
    return false;
  }
  return true;
}

int RunHostile() {
  HostileBenchmarkOptions options;
  options.solvers = SplitCommas(FLAGS_solvers);
  options.pairs = FLAGS_pairs;
  options.seed = FLAGS_seed;
  const std::string flag = FirstGiven({"matches", "prior"});
  if (!flag.empty()) return UsageError("--" + flag + ": --ransac=hostile makes pairs of its own");
  if (FLAGS_pairs < 1) return UsageError("--pairs: expected at least 1");
  std::string error;
  if (!SolversAreKnown(options.solvers, /*with_auto=*/true, &error)) return UsageError(error);
  std::vector<HostileBenchmarkRow> rows;
  {
    Progress progress("rigel_benchmark", CountHostileRows(options));
    rows = BenchmarkHostile(options, [&] { progress.Step(); });
  }
  bool ok = true;
  if (FLAGS_json != "-") {
    std::cout << HostileBenchmarkTable(rows);
    ok = FlushStdout();
  }
  ok = WriteOutput(FLAGS_json, HostileBenchmarkJson(rows, options)) && ok;
  return ok ? kExitDone : kExitFailed;
}

int RunRansac() {
  if (FLAGS_ransac == "hostile") return RunHostile();
  RansacBenchmarkOptions options;
  options.pairs = FLAGS_pairs;
  options.seed = FLAGS_seed;
  if (!ParseRansacExperiment(FLAGS_ransac, &options.experiment)) {
    return UsageError("--ransac=" + FLAGS_ransac +
                      ": expected speed, outliers, ablation, moving or hostile");
  }
  const bool files = !FirstGiven({"matches"}).empty();
  if (files && options.experiment != RansacExperiment::kSpeed) {
    return UsageError("--matches: --ransac=" + FLAGS_ransac + " makes scenes of its own");
  }
  if (files && !FirstGiven({"pairs"}).empty()) {
    return UsageError("--pairs: the pairs are those of --matches");
  }
  if (!files && !FirstGiven({"prior"}).empty()) {
    return UsageError("--prior: it is of --matches; the scenes have an exact one");
  }
  PriorSourceOptions prior;
  if (!ParsePriorSource(FLAGS_prior, &prior.source)) {
    return UsageError("--prior=" + FLAGS_prior + ": expected file, body or truth");
  }
  if (FLAGS_pairs < 1) return UsageError("--pairs: expected at least 1");
  options.solvers = SplitCommas(FLAGS_solvers);
  std::string error;
  if (!SolversAreKnown(options.solvers, /*with_auto=*/false, &error)) return UsageError(error);
  bool ok = true;
  std::vector<RansacBenchmarkRow> rows;
  if (files) {
    options.experiment = RansacExperiment::kFiles;
    std::vector<FramePair> pairs;
    std::vector<std::string> ignored;  // told when they are read
    if (!OutputsAreNoInputs({{"json", FLAGS_json}}, ListMatchFiles(FLAGS_matches, &ignored),
                            &error)) {
      return UsageError(error);
    }
    ok = ReadPairs(prior, &pairs);
    if (pairs.empty()) return kExitFailed;
    rows = BenchmarkRansacOnFiles(options, pairs);
  } else {
    Progress progress("rigel_benchmark", CountRansacRows(options));
    rows = BenchmarkRansac(options, [&] { progress.Step(); });
  }
  if (!IsStdout(FLAGS_json)) {
    std::cout << RansacBenchmarkTable(rows, options.experiment);
    ok = FlushStdout() && ok;
  }
  ok = WriteOutput(FLAGS_json, RansacBenchmarkJson(rows, options)) && ok;
  return ok ? kExitDone : kExitFailed;
}

int RunRefinement() {
  RefineBenchmarkOptions options;
  options.problems = std::min(FLAGS_trials, 200);
  options.rotation_deg = FLAGS_rotation_deg;
  options.seed = FLAGS_seed;
  const std::vector<RefineBenchmarkRow> rows = BenchmarkRefinement(options);
  if (rows.empty()) {
    std::cerr << "with --rotation_deg=" << FLAGS_rotation_deg
              << " hardly any point stays in view\n";
    return kExitFailed;
  }
  bool ok = true;
  if (!IsStdout(FLAGS_json)) {
    std::cout << RefineBenchmarkTable(rows)
              << "\nmedian over the problems of the least of five repetitions; "
              << options.num_matches << " matches, 0.5 px, start 1 deg off\n";
    ok = FlushStdout();
  }
  ok = WriteOutput(FLAGS_json, RefineBenchmarkJson(rows, options)) && ok;
  return ok ? kExitDone : kExitFailed;
}

int Run() {
  std::string error;
  if (!OutputsDiffer({{"json", FLAGS_json}}, &error)) return UsageError(error);
  if (!FirstGiven({"ransac"}).empty()) {
    const std::string flag =
        FirstGiven({"num_cameras", "random_axis", "refine", "rotation_deg", "trials"});
    if (!flag.empty()) return UsageError("--" + flag + ": has no effect with --ransac");
    return RunRansac();
  }
  const std::string flag = FirstGiven({"matches", "pairs", "prior"});
  if (!flag.empty()) return UsageError("--" + flag + ": has no effect without --ransac");
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
  if (!IsStdout(FLAGS_json)) {
    std::cout << SolverBenchmarkTable(rows)
              << "\nreference kernel (4x4 LU solve by Eigen): " << FormatNumber(reference, 4)
              << " us, for each ratio anew;\npreparing a match: "
              << FormatNumber(rows[0].prepare_us, 3) << " us\n";
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
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
