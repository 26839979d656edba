// rigel_estimate: the motions of match files.
#include <functional>
#include <iostream>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/problems/batch.h"
#include "rigel/problems/g2o_file.h"
#include "rigel/problems/match_file.h"
#include "rigel/problems/report.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    solver, "4pt-axis",
    "name of the minimal solver of RANSAC, or auto: the most constrained one that the priors "
    "allow, others after it while the result is doubtful");
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
  if (!IsSolverName(FLAGS_solver)) {
    return UsageError("--solver=" + FLAGS_solver + ": expected one of " + SolverNamesWithAuto());
  }
  if (!CanRefine(estimate, FLAGS_solver, &error)) return UsageError(error);
  if (!StdoutIsAskedForOnce(&error)) return UsageError(error);
  if (!FLAGS_g2o.empty() && !estimate.refine_motion) {
    return UsageError("--g2o: without a refinement (--refine=none) a motion has no information");
  }

  const InputFiles input = ListInput();
  if (input.total == 0) return kExitFailed;
  bool ok = input.all_there;
  struct Estimated {
    MotionEstimate estimate;
    MatchCount matches;
  };
  const std::function<Estimated(const FramePair&)> work = [&](const FramePair& pair) {
    EstimateOptions pair_options = estimate;
    if (options.use_stated_noise && pair.noise_px) pair_options.refine.noise_px = pair.noise_px;
    Estimated result{EstimateMotion(pair_options, pair),
                     {static_cast<int>(pair.matches.size()), HasInterCameraMatches(pair)}};
    result.estimate.refine.inliers = std::vector<char>();
    return result;
  };
  std::vector<BatchItem<Estimated>> items;
  {
    Progress progress(FLAGS_solver, static_cast<int>(input.paths.size()));
    items = RunBatch(options, input.paths, input.first, work, [&] { progress.Step(); });
  }
  EstimateReport report;
  std::vector<int> positions;
  for (BatchItem<Estimated>& item : items) {
    if (!item.error.empty()) {
      std::cerr << PrintablePath(item.error) << "\n";
      ok = false;
      continue;
    }
    positions.push_back(item.position);
    report.pairs.push_back(std::move(item.pair));
    report.matches.push_back(item.result.matches);
    report.estimates.push_back(std::move(item.result.estimate));
  }
  // A shard may have nothing to report, the whole may not.
  if (report.pairs.empty() && !input.shard) return kExitFailed;
  ReportUnweighedPriors(options, {FLAGS_solver}, report.pairs);
  for (size_t k = 0; k < report.pairs.size(); ++k) {
    if (report.estimates[k].status != EstimateStatus::kSuccess) {
      std::cerr << FailureMessage(report.pairs[k], FLAGS_solver, report.estimates[k].message)
                << "\n";
    }
  }

  // stdout belongs to the machine if it asked for it.
  if (FLAGS_json != "-" && FLAGS_csv != "-" && FLAGS_g2o != "-") {
    std::cout << EstimateTable(report);
    ok = FlushStdout() && ok;
  }
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.push_back("g2o");
  report.options = FlagValues(output_flags);
  const bool times = TimesAreGiven();
  if (!FLAGS_json.empty()) ok = WriteOutput(FLAGS_json, EstimateJson(report, times)) && ok;
  if (!FLAGS_csv.empty()) ok = WriteOutput(FLAGS_csv, EstimateCsv(report, times)) && ok;
  if (!FLAGS_g2o.empty()) {
    std::vector<std::string> notes;
    const std::string graph = FormatG2o(report.pairs, report.estimates, positions, &notes);
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
