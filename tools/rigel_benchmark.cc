// rigel_benchmark: time and reliability of the minimal solvers, the refinement and the whole
// estimate.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

#include <gflags/gflags.h>

#include "rigel/problems/benchmarks/hostile_benchmark.h"
#include "rigel/problems/benchmarks/opengv_peers.h"
#include "rigel/problems/benchmarks/ransac_benchmark.h"
#include "rigel/problems/benchmarks/refine_benchmark.h"
#include "rigel/problems/benchmarks/solver_benchmark.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/scenes/prior_source.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/solver_names.h"
#include "rigel/tools/tool.h"

DEFINE_string(solvers, "", "minimal solvers, comma separated; all if empty");
DEFINE_int32(num_cameras, 2, "number of cameras of the rig, 1 to 4");
DEFINE_int32(trials, 10000, "number of random problems per solver and kind of sample");
DEFINE_double(rotation_deg, 1, "rotation angle of the problems, degrees; 0 is pure translation");
DEFINE_bool(random_axis, false,
            "rotate about a random axis instead of the body's Y axis (except for planar motion)");
DEFINE_bool(
    refine, false,
    "measure the refinement instead of the solvers: 600 inliers, start 1 degree from the truth, "
    "at most 200 problems");
DEFINE_string(
    ransac, "",
    "measure RANSAC and refinement instead of the solvers: speed, outliers, ablation, moving or "
    "hostile (see above)");
DEFINE_int32(pairs, 200, "number of frame pairs per scene of --ransac");
DEFINE_string(
    matches, "",
    "match files and directories, comma separated: measure --ransac=speed on these instead of a "
    "synthetic scene");
DEFINE_string(prior, "file",
              "source of the motion prior for --matches: file, body or truth, as in rigel_compare");
DEFINE_uint64(seed, 1, "seed of the random numbers. The same seed gives the same problems");
DEFINE_string(json, "", "write the results as JSON (docs/formats.md) to this file; - is stdout");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_benchmark: speed and reliability of minimal solvers, RANSAC and refinement.\n"
    "\n"
    "  rigel_benchmark --solvers=4pt,4pt-approx --trials=10000\n"
    "\n"
    "Solves random problems without noise, in the scene of rigel_simulate. A row is one solver\n"
    "with samples within each camera (intra) or between cameras (inter). Times are of one call,\n"
    "from prepared matches to the list of (R, t), measured in batches of at least 50 us; the\n"
    "ratio is to a 4x4 LU solve by Eigen in the same run.\n"
    "  found truth  share of problems with a solution whose rotation is within 1e-6 rad of the\n"
    "               truth; with --rotation_deg=0 also its direction of translation, to 1e-4 rad\n"
    "  best root    median error of the solution nearest to the truth: for a first-order solver,\n"
    "               its bias\n"
    "\n"
    "  rigel_benchmark --ransac=speed\n"
    "\n"
    "Measures RANSAC and refinement on one thread, in scenes of random motion (planar for planar\n"
    "solvers) with 1 degree of rotation, 0.5 px of noise and exact priors:\n"
    "  speed        626 matches, 30 percent outliers\n"
    "  outliers     300 inliers and 10 to 80 percent outliers\n"
    "  ablation     parts of the estimator left out or added\n"
    "  moving       some matches are on a car that moves by itself\n"
    "  hostile      no match follows any motion: the maximum processor time of a pair\n"
    "Times are the minimum of three runs of a pair. Columns:\n"
    "  clean        error relative to that of an estimate from the inliers alone\n"
    "  bound        RMS error of the successful pairs relative to the RMS Cramer-Rao bound\n"
    "  success      share of pairs with a rotation within three bounds of the truth\n"
    "  missed       failed pairs that succeed if the refinement starts at the truth\n"
    "  static       share of pairs whose motion has at least 90 percent of the static inliers\n"
    "               of the true motion\n";

std::vector<OutputFlag> Outputs() { return {{"json", FLAGS_json}}; }

// The table, and the report of --json. False with a message on stderr if one cannot be written.
bool Write(const std::string& table, const std::string& json) {
  const bool ok = PrintTable(table, Outputs());
  return WriteOutput(FLAGS_json, json) && ok;
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

int RunHostile() {
  HostileBenchmarkOptions options;
  options.pairs = FLAGS_pairs;
  options.seed = FLAGS_seed;
  const std::string flag = FirstGiven({"matches", "prior"});
  if (!flag.empty()) return UsageError("--" + flag + ": --ransac=hostile makes pairs of its own");
  if (FLAGS_pairs < 1) return UsageError("--pairs: expected at least 1");
  std::string error;
  if (!ParseSolvers(FLAGS_solvers, IsSolverName, SolverNamesWithAuto(), &options.solvers, &error)) {
    return UsageError(error);
  }

  std::vector<HostileBenchmarkRow> rows;
  {
    Progress progress(ProgramName(), CountHostileRows(options));
    rows = BenchmarkHostile(options, [&] { progress.Step(); });
  }
  return ExitCode(Write(HostileBenchmarkTable(rows), HostileBenchmarkJson(rows, options)));
}

bool RansacOptionsFromFlags(RansacBenchmarkOptions* options, PriorSourceOptions* prior,
                            std::string* error) {
  options->pairs = FLAGS_pairs;
  options->seed = FLAGS_seed;
  if (!ParseRansacExperiment(FLAGS_ransac, &options->experiment)) {
    return WrongValue("ransac", FLAGS_ransac, "speed, outliers, ablation, moving or hostile",
                      error);
  }
  const bool files = IsGiven("matches");
  if (files && options->experiment != RansacExperiment::kSpeed) {
    return Refuse("--matches: --ransac=" + FLAGS_ransac + " makes scenes of its own", error);
  }
  if (files && IsGiven("pairs")) return Refuse("--pairs: the pairs are those of --matches", error);
  if (!files && IsGiven("prior")) {
    return Refuse("--prior: it is of --matches; the scenes have an exact one", error);
  }
  if (!ParsePriorSource(FLAGS_prior, &prior->source)) {
    return WrongValue("prior", FLAGS_prior, "file, body or truth", error);
  }
  if (FLAGS_pairs < 1) return Refuse("--pairs: expected at least 1", error);
  if (files) options->experiment = RansacExperiment::kFiles;
  const auto is_known = [](const std::string& name) { return FindSolver(name) != nullptr; };
  return ParseSolvers(FLAGS_solvers, is_known, SolverNames(), &options->solvers, error);
}

int RunRansac() {
  RansacBenchmarkOptions options;
  PriorSourceOptions prior;
  std::string error;
  if (!RansacOptionsFromFlags(&options, &prior, &error)) return UsageError(error);

  bool ok = true;
  std::vector<RansacBenchmarkRow> rows;
  if (options.experiment == RansacExperiment::kFiles) {
    std::vector<FramePair> pairs;
    std::vector<std::string> ignored;  // told when they are read
    if (!OutputsAreNoInputs(Outputs(), ListMatchFiles(FLAGS_matches, &ignored), &error)) {
      return UsageError(error);
    }
    ok = ReadPairs(prior, &pairs);
    if (pairs.empty()) return kExitFailed;
    rows = BenchmarkRansacOnFiles(options, pairs);
  } else {
    Progress progress(ProgramName(), CountRansacRows(options));
    rows = BenchmarkRansac(options, [&] { progress.Step(); });
  }
  ok = Write(RansacBenchmarkTable(rows, options.experiment), RansacBenchmarkJson(rows, options)) &&
       ok;
  return ExitCode(ok);
}

std::string NoPointInView() {
  std::ostringstream message;
  message << "with --rotation_deg=" << FLAGS_rotation_deg << " hardly any point stays in view";
  return message.str();
}

int RunRefinement() {
  // Problems: half a minute of one core. More are of no use, the medians have settled.
  constexpr int kMostProblems = 200;
  RefineBenchmarkOptions options;
  options.problems = std::min(FLAGS_trials, kMostProblems);
  options.rotation_deg = FLAGS_rotation_deg;
  options.seed = FLAGS_seed;
  const std::vector<RefineBenchmarkRow> rows = BenchmarkRefinement(options);
  if (rows.empty()) return Failure(NoPointInView());
  const std::string below = "\nmedian over the problems of the least of five repetitions; " +
                            std::to_string(options.num_matches) +
                            " matches, 0.5 px, start 1 deg off\n";
  return ExitCode(Write(RefineBenchmarkTable(rows) + below, RefineBenchmarkJson(rows, options)));
}

bool SolverOptionsFromFlags(SolverBenchmarkOptions* options, std::string* error) {
  const std::string flag = FirstGiven({"matches", "pairs", "prior"});
  if (!flag.empty()) return Refuse("--" + flag + ": has no effect without --ransac", error);
  options->num_cameras = FLAGS_num_cameras;
  options->trials = FLAGS_trials;
  options->rotation_deg = FLAGS_rotation_deg;
  options->random_axis = FLAGS_random_axis;
  options->seed = FLAGS_seed;
  constexpr int kMaxCameras = 4;  // cameras: more have no place in the scene without a ring
  if (FLAGS_num_cameras < 1 || FLAGS_num_cameras > kMaxCameras) {
    return Refuse("--num_cameras: expected 1 to " + std::to_string(kMaxCameras), error);
  }
  if (FLAGS_trials < 1) return Refuse("--trials: expected at least 1", error);
  if (!std::isfinite(FLAGS_rotation_deg)) return Refuse("--rotation_deg: expected a number", error);
  if (FLAGS_refine && !FLAGS_solvers.empty())
    return Refuse("--solvers: --refine times no solver", error);
  return true;
}

// A solver of Rigel or, where they are built, of OpenGV; null if there is none of that name.
const SolverInfo* FindSolverOrPeer(const std::string& name) {
  for (const SolverInfo& peer : OpenGvPeers()) {
    if (name == peer.name) return &peer;
  }
  return FindSolver(name);
}

bool SolversFromFlag(std::vector<const SolverInfo*>* solvers, std::string* error) {
  std::vector<std::string> names;
  const auto is_known = [](const std::string& name) { return FindSolverOrPeer(name) != nullptr; };
  if (!ParseSolvers(FLAGS_solvers, is_known, SolverNames(), &names, error)) return false;
  for (const std::string& name : names) solvers->push_back(FindSolverOrPeer(name));
  if (!solvers->empty()) return true;
  for (const SolverInfo& solver : SolverCatalogue()) solvers->push_back(&solver);
  for (const SolverInfo& solver : OpenGvPeers()) solvers->push_back(&solver);
  return true;
}

// False with a message on stderr if there was no problem to solve for one of them.
bool TimeSolvers(const SolverBenchmarkOptions& options,
                 const std::vector<const SolverInfo*>& solvers,
                 std::vector<SolverBenchmarkRow>* rows) {
  bool ok = true;
  Progress progress(ProgramName(), static_cast<int>(solvers.size()));
  for (const SolverInfo* solver : solvers) {
    for (const SolverBenchmarkRow& row : BenchmarkSolver(*solver, options)) {
      if (row.mean_us > 0) {
        rows->push_back(row);
      } else {
        ok = false;
        std::cerr << row.solver << ", " << row.matches << ": " << NoPointInView() << "\n";
      }
    }
    progress.Step();
  }
  return ok;
}

std::string SolverText(const std::vector<SolverBenchmarkRow>& rows, double reference_us) {
  const std::string paper = PaperTable1(rows);
  return SolverBenchmarkTable(rows) +
         "\nreference kernel (4x4 LU solve by Eigen): " + FormatNumber(reference_us, 4) +
         " us, for each ratio anew;\npreparing a match: " + FormatNumber(rows[0].prepare_us, 3) +
         " us\n" + (paper.empty() ? "" : "\n" + paper);
}

int Run() {
  SolverBenchmarkOptions options;
  std::vector<const SolverInfo*> solvers;
  std::string error;
  if (!OutputsDiffer(Outputs(), &error)) return UsageError(error);
  if (IsGiven("ransac")) {
    const std::string flag =
        FirstGiven({"num_cameras", "random_axis", "refine", "rotation_deg", "trials"});
    if (!flag.empty()) return UsageError("--" + flag + ": has no effect with --ransac");
    return FLAGS_ransac == "hostile" ? RunHostile() : RunRansac();
  }
  if (!SolverOptionsFromFlags(&options, &error)) return UsageError(error);
  if (FLAGS_refine) return RunRefinement();
  if (!SolversFromFlag(&solvers, &error)) return UsageError(error);

  std::vector<SolverBenchmarkRow> rows;
  bool ok = TimeSolvers(options, solvers, &rows);
  if (rows.empty()) return kExitFailed;
  const double reference_us = ReferenceKernelMicroseconds();
  ok =
      Write(SolverText(rows, reference_us), SolverBenchmarkJson(rows, options, reference_us)) && ok;
  return ExitCode(ok);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
