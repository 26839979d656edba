// rigel_estimate: the motions of match files.
#include <iostream>

#include <gflags/gflags.h>

#include "rigel/problems/parallel.h"
#include "rigel/problems/report.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(solver, "4pt-axis", "name of the minimal solver of RANSAC");
DEFINE_string(json, "", "write the motions (format rigel-estimate 1) to this file; - is stdout");
DEFINE_string(csv, "", "write one line a pair to this file; - is stdout");

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
    "The JSON and CSV give the motions in full, raw and refined.\n";

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
  if (FLAGS_json == "-" && FLAGS_csv == "-") {
    return UsageError("--csv=-: stdout has the JSON already; name a file for one of them");
  }

  bool ok = true;
  const std::vector<FramePair> pairs = ReadPairs(options, &ok);
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
  if (FLAGS_json != "-" && FLAGS_csv != "-") {
    std::cout << EstimateTable(pairs, estimates);
    ok = FlushStdout() && ok;
  }
  const ReportOptions report_options = FlagValues({"json", "csv", "threads"});
  ok = WriteOutput(FLAGS_json, EstimateJson(pairs, estimates, report_options)) && ok;
  ok = WriteOutput(FLAGS_csv, EstimateCsv(pairs, estimates)) && ok;
  return ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  rigel::ParseFlags(rigel::kUsage, &argc, &argv);
  return rigel::Run();
}
