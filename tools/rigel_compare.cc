// rigel_compare: accuracy of raw and refined motions against the truth of match files.
#include <algorithm>
#include <iostream>
#include <map>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/problems/match_file.h"
#include "rigel/problems/report.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(solvers, "", "names of solvers, comma separated; all that the priors allow if empty");
DEFINE_string(by, "", "sequence: one more row for each sequence of the files");
DEFINE_string(json, "", "write the report (format rigel-report 1) to this file; - is stdout");
DEFINE_string(csv, "", "write one line a pair and solver to this file; - is stdout");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_compare: how accurate the raw motion of RANSAC and the refined one are.\n"
    "\n"
    "  rigel_compare --matches=DIR --solvers=4pt-axis,3pt --prior=body\n"
    "\n"
    "Reads match files with a truth line, estimates each pair with each solver and prints the "
    "median\n"
    "errors: rotation, direction of translation and scale, where these are observable; beside "
    "them,\n"
    "where the files state the image noise, the Cramer-Rao bound that no estimate can beat. With\n"
    "--refine=none nothing says what is observable: the direction is shown of every pair, the "
    "scale\n"
    "of pairs with matches between cameras.\n";

int Run() {
  ComparisonOptions options;
  std::string error;
  if (!OptionsFromFlags(&options, &error)) return UsageError(error);
  options.solvers = SplitCommas(FLAGS_solvers);
  if (!FLAGS_solvers.empty() && options.solvers.empty()) {
    return UsageError("--solvers=" + FLAGS_solvers + ": names no solver");
  }
  for (const std::string& name : options.solvers) {
    if (FindSolver(name) == nullptr) {
      return UsageError("--solvers: there is no solver '" + name + "'; expected some of " +
                        SolverNames());
    }
    if (!CanRefine(options.estimate, name, &error)) return UsageError(error);
    if (std::count(options.solvers.begin(), options.solvers.end(), name) > 1) {
      return UsageError("--solvers: '" + name + "' is named twice");
    }
  }
  if (FLAGS_json == "-" && FLAGS_csv == "-") {
    return UsageError("--csv=-: stdout has the JSON already; name a file for one of them");
  }
  if (!FLAGS_by.empty() && FLAGS_by != "sequence") {
    return UsageError("--by=" + FLAGS_by + ": expected sequence");
  }

  bool ok = true;
  std::vector<FramePair> pairs = ReadPairs(options, &ok);
  const auto no_truth = std::stable_partition(
      pairs.begin(), pairs.end(), [](const FramePair& pair) { return pair.truth.has_value(); });
  for (auto it = no_truth; it != pairs.end(); ++it) {
    std::cerr << PrintablePath(it->name) << ": has no truth line, nothing to compare with\n";
    ok = false;
  }
  pairs.erase(no_truth, pairs.end());
  if (pairs.empty()) return kExitFailed;
  if (options.solvers.empty()) {
    for (const std::string& name : SolversForPairs(pairs)) {
      if (CanRefine(options.estimate, name, &error)) options.solvers.push_back(name);
    }
  }
  if (options.solvers.empty()) {
    std::cerr << "no solver's prior is in every file; try --prior=body\n";
    return kExitFailed;
  }

  ReportUnweighedPriors(options, options.solvers, pairs);
  const bool any_sequence = std::any_of(
      pairs.begin(), pairs.end(), [](const FramePair& pair) { return !pair.sequence.empty(); });
  if (FLAGS_by == "sequence" && !any_sequence) {
    std::cerr << "--by=sequence: no file names a sequence\n";
  }

  std::vector<SolverSummary> summaries;
  std::vector<std::pair<std::string, std::vector<PairResult>>> all_results;
  for (const std::string& name : options.solvers) {
    EstimateOptions estimate = options.estimate;
    estimate.solver = name;
    Progress progress(name, static_cast<int>(pairs.size()));
    std::vector<PairResult> results = RunSolver(
        pairs, estimate, options.num_threads, [&] { progress.Step(); }, options.use_stated_noise);
    summaries.push_back(Summarize(name, "all", results));
    if (FLAGS_by == "sequence") {
      std::map<std::string, std::vector<PairResult>> by_sequence;
      for (const PairResult& r : results) by_sequence[r.sequence].push_back(r);
      for (const auto& [sequence, group] : by_sequence) {
        if (!sequence.empty()) summaries.push_back(Summarize(name, sequence, group));
      }
    }
    all_results.emplace_back(name, std::move(results));
  }
  for (const auto& [name, results] : all_results) {
    for (size_t k = 0; k < results.size(); ++k) {
      if (!results[k].failed) continue;
      std::cerr << FailureMessage(pairs[k], name, results[k].message) << "\n";
    }
  }

  // stdout belongs to the machine if it asked for it.
  if (FLAGS_json != "-" && FLAGS_csv != "-") {
    std::cout << ComparisonTable(summaries);
    ok = FlushStdout() && ok;
  }
  const ReportOptions report_options = FlagValues({"json", "csv", "threads"});
  ok = WriteOutput(FLAGS_json,
                   ComparisonJson(summaries, static_cast<int>(pairs.size()), report_options)) &&
       ok;
  ok = WriteOutput(FLAGS_csv, ComparisonCsv(all_results)) && ok;
  return ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  rigel::ParseFlags(rigel::kUsage, &argc, &argv);
  return rigel::Run();
}
