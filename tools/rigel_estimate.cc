// rigel_estimate: the motions of match files.
#include <iostream>

#include <gflags/gflags.h>

#include "rigel/problems/g2o_file.h"
#include "rigel/problems/parallel.h"
#include "rigel/problems/report.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(solver, "4pt-axis", "name of the minimal solver of RANSAC");
DEFINE_string(json, "", "write the motions (format rigel-estimate 1) to this file; - is stdout");
DEFINE_string(csv, "", "write one line a pair to this file; - is stdout");
DEFINE_string(
    g2o, "",
    "write a pose graph of g2o, files in order one after the other along a drive, to this "
    "file; - is stdout");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_estimate: the motion (R, t), X_2 = R X_1 + t, of each match file.\n"
    "\n"
    "  rigel_estimate --matches=DIR --solver=4pt-axis --prior=body --json=motions.json\n"
    "\n"
    "RANSAC with a minimal solver makes hypotheses, a refinement makes them accurate. The table\n"
    "gives the rotation angle, the direction of translation and |t| with their standard "
    "deviations,\n"
    "and \"-\" for what the matches do not determine. With --refine=none nothing says what they\n"
    "determine: the direction is shown as it is, |t| only where there are matches between "
    "cameras.\n"
    "The JSON and CSV give the motions in full, raw and refined; --g2o chains the refined ones,\n"
    "with their information, to trajectories.\n";

// The outputs that ask for stdout: one at most. False with a message if there are more.
bool StdoutIsAskedForOnce(std::string* error) {
  const std::pair<const char*, std::string> outputs[] = {
      {"json", FLAGS_json}, {"csv", FLAGS_csv}, {"g2o", FLAGS_g2o}};
  const char* first = nullptr;
  for (const auto& [flag, file] : outputs) {
    if (file != "-") continue;
    if (first != nullptr) {
      *error = "--" + std::string(flag) + "=-: stdout has that of --" + first +
               " already; name a file for one of them";
      return false;
    }
    first = flag;
  }
  return true;
}

int Run() {
  ComparisonOptions options;
  std::string error;
  if (!OptionsFromFlags(&options, &error)) return UsageError(error);
  EstimateOptions& estimate = options.estimate;
  estimate.solver = FLAGS_solver;
  if (FindSolver(FLAGS_solver) == nullptr) {
    return UsageError("--solver=" + FLAGS_solver + ": expected one of " + SolverNames());
  }
  if (!CanRefine(estimate, FLAGS_solver, &error)) return UsageError(error);
  if (!StdoutIsAskedForOnce(&error)) return UsageError(error);
  if (!FLAGS_g2o.empty() && !estimate.refine_motion) {
    return UsageError("--g2o: without a refinement (--refine=none) a motion has no information");
  }

  bool ok = true;
  std::vector<int> positions;
  const std::vector<FramePair> pairs = ReadPairs(options, &ok, &positions);
  if (pairs.empty()) return kExitFailed;
  ReportUnweighedPriors(options, {FLAGS_solver}, pairs);
  std::vector<MotionEstimate> estimates(pairs.size());
  {
    Progress progress(FLAGS_solver, static_cast<int>(pairs.size()));
    ParallelFor(static_cast<int>(pairs.size()), options.num_threads, [&](int k) {
      EstimateOptions pair_options = estimate;
      if (options.use_stated_noise && pairs[k].noise_px)
        pair_options.refine.noise_px = pairs[k].noise_px;
      estimates[k] = EstimateMotion(pair_options, pairs[k]);
      progress.Step();
    });
  }
  for (size_t k = 0; k < pairs.size(); ++k) {
    if (estimates[k].status != EstimateStatus::kSuccess) {
      std::cerr << FailureMessage(pairs[k], FLAGS_solver, estimates[k].message) << "\n";
    }
  }

  // stdout belongs to the machine if it asked for it.
  if (FLAGS_json != "-" && FLAGS_csv != "-" && FLAGS_g2o != "-") {
    std::cout << EstimateTable(pairs, estimates);
    ok = FlushStdout() && ok;
  }
  const ReportOptions report_options = FlagValues({"json", "csv", "g2o", "threads"});
  ok = WriteOutput(FLAGS_json, EstimateJson(pairs, estimates, report_options)) && ok;
  ok = WriteOutput(FLAGS_csv, EstimateCsv(pairs, estimates)) && ok;
  if (!FLAGS_g2o.empty()) {
    std::vector<std::string> notes;
    const std::string graph = FormatG2o(pairs, estimates, positions, &notes);
    for (const std::string& note : notes) std::cerr << "--g2o: " << note << "\n";
    ok = WriteOutput(FLAGS_g2o, graph) && ok;
  }
  return ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  rigel::ParseFlags(rigel::kUsage, &argc, &argv);
  return rigel::Run();
}
