// rigel_compare: accuracy of raw and refined motions against the truth of match files.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/problems/evaluation/batch.h"
#include "rigel/problems/evaluation/bounds.h"
#include "rigel/problems/evaluation/comparison_report.h"
#include "rigel/problems/evaluation/sequence_tables.h"
#include "rigel/problems/evaluation/shard_report.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/estimation_messages.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/solver_names.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    solvers, "",
    "minimal solvers, comma separated; auto is allowed, as in rigel_estimate. If empty: all "
    "whose prior every file has");
DEFINE_string(
    by, "",
    "sequence: also print tables per sequence, as in the paper: RANSAC time, median rotation "
    "error and median direction error; one row per sequence, one column per solver. --json then "
    "has entries per sequence");
DEFINE_string(
    json, "",
    "write the report as JSON (format rigel-report 1, docs/formats.md) to this file; - is stdout");
DEFINE_string(csv, "", "write one line per pair and solver to this file; - is stdout");
DEFINE_bool(per_pair, false,
            "write the results of each pair to --json, too. Always on with --shard");
DEFINE_string(
    merge, "",
    "reports of --shard runs, comma separated: combine them to one report instead of reading "
    "match files");
DEFINE_string(
    fail_above, "",
    "bounds, comma separated: STATISTIC:LIMIT for all solvers or SOLVER/STATISTIC:LIMIT for one, "
    "for example refined.rotation_deg.median:0.03. Statistics have the names of --json and cover "
    "all pairs. If one is above its limit or missing, the exit code is 3");
DEFINE_int32(
    max_failures, -1,
    "bound on the number of pairs without a motion, per solver; above it the exit code is 3. -1: "
    "no bound");
DEFINE_string(
    baseline, "",
    "report of an earlier run (--json): the exit code is 3 if a refined error, the number of "
    "failures or of pairs without a direction is worse than there, for any solver and sequence");
DEFINE_double(tolerance, 0.05,
              "fraction by which results may be worse than those of --baseline; 0.05 is 5 percent");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_compare: measures the accuracy of solvers on match files with known motion.\n"
    "\n"
    "  rigel_compare --matches=DIR --solvers=4pt-axis,3pt --prior=body\n"
    "\n"
    "Estimates each pair with each solver and prints the median errors of the motions, from\n"
    "RANSAC (raw) and refined: rotation, direction of translation and scale, where these are\n"
    "observable. Files need a truth line. If they state the image noise, the table also shows\n"
    "the Cramer-Rao bound, which no unbiased estimate can beat. With --refine=none it is not\n"
    "known what is observable: errors of direction are then of all pairs, errors of scale of the\n"
    "pairs with matches between different cameras.\n"
    "\n"
    "Parallel runs over many files (docs/batch.md):\n"
    "\n"
    "  rigel_compare --matches=DIR --shard=0/2 --json=0.json      (and 1/2 to 1.json)\n"
    "  rigel_compare --merge=0.json,1.json --json=whole.json\n"
    "\n"
    "Regression test, exit code 3 if results are worse than before (docs/regression.md):\n"
    "\n"
    "  rigel_compare --matches=DIR --baseline=report.json --max_failures=0\n";

const std::vector<std::string> kBoundFlags = {"baseline", "fail_above", "max_failures",
                                              "tolerance"};

// False with a message if a flag of them is wrong. Reads no file.
bool BoundsFromFlags(ReportBounds* bounds, std::string* error) {
  if (!ParseStatisticBounds(FLAGS_fail_above, &bounds->statistics, error)) {
    *error = "--fail_above: " + *error;
    return false;
  }
  if (FLAGS_max_failures < -1) {
    return Refuse("--max_failures=" + std::to_string(FLAGS_max_failures) +
                      ": expected 0 or more, or -1 for no bound",
                  error);
  }
  if (FLAGS_max_failures >= 0) bounds->max_failures = FLAGS_max_failures;
  if (IsGiven("tolerance") && FLAGS_baseline.empty()) {
    return Refuse("--tolerance: has no effect without --baseline", error);
  }
  if (!(FLAGS_tolerance >= 0) || !std::isfinite(FLAGS_tolerance)) {
    return Refuse("--tolerance: expected a number from 0, as 0.05 for 5 percent", error);
  }
  bounds->tolerance = FLAGS_tolerance;
  if (!FirstGiven(kBoundFlags).empty() && IsGiven("shard")) {
    return Refuse("--shard: bounds are of the whole; state them where the shards are merged",
                  error);
  }
  return true;
}

// A report of --json as text. False with a message on stderr if it cannot be read.
bool ReadReport(const std::string& path, std::string* text) {
  InputBytes bytes;
  std::string error;
  if (!ReadInputFile(path, &bytes, &error, kMaxJsonBytes)) {
    std::cerr << error << "\n";
    return false;
  }
  std::string_view input = bytes.text();
  int64_t line;
  if (!CheckText(&input, &line, &error)) {
    std::cerr << PrintablePath(InputName(path)) << (line > 0 ? ":" + std::to_string(line) : "")
              << ": " << error << ", expected UTF-8 text\n";
    return false;
  }
  *text = std::string(input);
  return true;
}

// False with a message on stderr if --baseline cannot be read.
bool ReadBaseline(ReportBounds* bounds) {
  if (FLAGS_baseline.empty()) return true;
  std::string text, error;
  if (!ReadReport(FLAGS_baseline, &text)) return false;
  if (ParseBaseline(text, FLAGS_baseline, &bounds->baseline, &error)) return true;
  std::cerr << error << "\n";
  return false;
}

// One line on stderr each bound missed. Who could not do all there was to do has failed, whatever
// the bounds say of the rest.
int ExitCodeOfBounds(bool ok, const ReportBounds& bounds,
                     const std::vector<SolverResults>& solvers) {
  const std::vector<std::string> missed = MissedBounds(bounds, SummarizeAll(solvers, true));
  for (const std::string& line : missed) std::cerr << line << "\n";
  if (!ok) return kExitFailed;
  return missed.empty() ? kExitDone : kExitBoundMissed;
}

std::vector<OutputFlag> Outputs() { return {{"json", FLAGS_json}, {"csv", FLAGS_csv}}; }

void DropTimes(ComparisonReport* report) {
  for (SolverResults& solver : report->solvers) {
    for (PairResult& r : solver.pairs) {
      r.ransac_ms.reset();
      r.refine_ms.reset();
    }
  }
}

// A line for each solver whose prior no pair states: its rows of the table are empty.
std::string SolversWithoutPrior(const std::vector<SolverResults>& solvers) {
  std::string lines;
  for (const SolverResults& solver : solvers) {
    const auto no_prior = [](const PairResult& r) {
      return r.failed && r.message.find("the prior has no ") != std::string::npos;
    };
    if (solver.pairs.empty() || !std::all_of(solver.pairs.begin(), solver.pairs.end(), no_prior)) {
      continue;
    }
    // The message begins with the name of the solver.
    lines += solver.pairs.front().message + " in any pair; see --prior\n";
  }
  return lines;
}

// Table, JSON and CSV. False with a message on stderr if one cannot be written.
bool Write(ComparisonReport* report, bool by_sequence) {
  if (!TimesAreGiven()) DropTimes(report);
  const std::vector<SolverSummary> summaries = SummarizeAll(report->solvers, by_sequence);
  const bool has_pairs = !report->solvers.front().pairs.empty();
  if (by_sequence && has_pairs && summaries.size() == report->solvers.size()) {
    std::cerr << "--by=sequence: no file names a sequence\n";
  }
  const std::string table = ComparisonTable(summaries) + SolversWithoutPrior(report->solvers);
  const bool bold = by_sequence && isatty(STDOUT_FILENO) != 0;
  bool ok = PrintTable(bold ? BestInBold(table) : table, Outputs());
  const bool per_pair = FLAGS_per_pair || report->shard.has_value();
  if (!FLAGS_json.empty()) {
    ok = WriteOutput(FLAGS_json, ComparisonJson(*report, summaries, per_pair)) && ok;
  }
  if (!FLAGS_csv.empty()) ok = WriteOutput(FLAGS_csv, ComparisonCsv(report->solvers)) && ok;
  return ok;
}

// Whether any solver has a motion of any pair. Says on stderr if not.
bool AnyMotion(const ComparisonReport& report) {
  for (const SolverResults& solver : report.solvers) {
    for (const PairResult& r : solver.pairs) {
      if (!r.failed || r.status == EstimateStatus::kNotRefined) return true;
    }
  }
  std::cerr << "no pair has a motion\n";
  return false;
}

// The whole of the shards' reports. False with a message on stderr if they are not one.
bool ReadShards(const std::vector<std::string>& names, ComparisonReport* whole) {
  std::vector<ComparisonReport> shards(names.size());
  std::string error;
  for (size_t k = 0; k < names.size(); ++k) {
    std::string text;
    if (!ReadReport(names[k], &text)) return false;
    if (!ParseShardReport(text, names[k], &shards[k], &error)) {
      std::cerr << error << "\n";
      return false;
    }
  }
  if (MergeShards(names, &shards, whole, &error)) return true;
  std::cerr << error << "\n";
  return false;
}

int Merge(ReportBounds* bounds) {
  std::vector<std::string> allowed = {"csv", "json", "merge", "no_times", "per_pair"};
  allowed.insert(allowed.end(), kBoundFlags.begin(), kBoundFlags.end());
  for (const std::string& flag : GivenFlags()) {
    if (std::find(allowed.begin(), allowed.end(), flag) == allowed.end()) {
      return UsageError("--merge: --" + flag + " has no effect, it is as in the reports");
    }
  }
  const std::vector<std::string> names = SplitCommas(FLAGS_merge);
  if (names.empty()) return UsageError("--merge=" + FLAGS_merge + ": names no report");
  std::string error;
  if (!OutputsAreNoInputs(Outputs(), names, &error)) return UsageError(error);
  if (!ReadBaseline(bounds)) return kExitFailed;
  ComparisonReport whole;
  if (!ReadShards(names, &whole)) return kExitFailed;
  const std::pair<std::string, std::string> by_sequence("by", "sequence");
  const bool by =
      std::find(whole.options.begin(), whole.options.end(), by_sequence) != whole.options.end();
  const bool ok = Write(&whole, by) && AnyMotion(whole);
  return ExitCodeOfBounds(ok, *bounds, whole.solvers);
}

bool SettingsFromFlags(ComparisonOptions* options, std::string* error) {
  if (!OptionsFromFlags(options, error) ||
      !ParseSolvers(FLAGS_solvers, IsSolverName, SolverNamesWithAuto(), &options->solvers, error)) {
    return false;
  }
  for (const std::string& name : options->solvers) {
    if (!CanRefine(options->estimate, name, error)) return false;
    if (std::count(options->solvers.begin(), options->solvers.end(), name) > 1) {
      return Refuse("--solvers: '" + name + "' is named twice", error);
    }
  }
  if (!FLAGS_by.empty() && FLAGS_by != "sequence") {
    return WrongValue("by", FLAGS_by, "sequence", error);
  }
  return true;
}

// Files that cannot be compared are told on stderr.
FileComparison Compare(ComparisonOptions options, const InputFiles& input) {
  FileComparison comparison;
  {
    Progress progress(ProgramName(), static_cast<int>(input.paths.size()));
    options.estimate.refine.progress = ShowRefinement(&progress);
    comparison = CompareFiles(options, input.paths, input.first, [&] { progress.Step(); });
  }
  for (const std::string& message : comparison.errors) std::cerr << PrintablePath(message) << "\n";
  std::vector<std::string> without_truth;
  for (const std::string& message : comparison.without_truth) {
    without_truth.push_back(PrintablePath(message));
  }
  ReportGrouped(without_truth, input.paths);
  return comparison;
}

// The axes and priors that were taken, failures and doubtful motions, on stderr.
void ReportMotions(const ComparisonOptions& options, const FileComparison& comparison,
                   const InputFiles& input) {
  std::vector<std::string> solvers;
  for (const SolverResults& results : comparison.solvers) solvers.push_back(results.solver);
  ReportSuggestedAxes(options, solvers, comparison.axes);
  ReportUnweighedPriors(options, solvers, comparison.pairs);
  for (const SolverResults& results : comparison.solvers) {
    std::vector<std::string> failures;
    std::vector<DoubtedMotion> motions;
    for (size_t k = 0; k < results.pairs.size(); ++k) {
      const PairResult& result = results.pairs[k];
      const FramePair& pair = comparison.pairs[k];
      if (result.failed) {
        failures.push_back(FailureMessage(pair, results.solver, result.message));
      } else {
        motions.push_back({pair.name, result.doubt});
      }
    }
    ReportGrouped(failures, input.paths);
    ReportDoubts(results.solver, motions);
  }
}

ComparisonReport MakeReport(FileComparison comparison, const InputFiles& input) {
  ComparisonReport report;
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.insert(output_flags.end(), {"merge", "per_pair"});
  output_flags.insert(output_flags.end(), kBoundFlags.begin(), kBoundFlags.end());
  report.options = FlagValues(output_flags);
  report.solvers = std::move(comparison.solvers);
  report.shard = input.shard;
  report.num_files = static_cast<int>(input.all.size());
  return report;
}

int Run() {
  ComparisonOptions options;
  ReportBounds bounds;
  InputFiles input;
  std::string error;
  if (!OutputsDiffer(Outputs(), &error) || !BoundsFromFlags(&bounds, &error)) {
    return UsageError(error);
  }
  if (!FLAGS_baseline.empty() && !OutputsAreNoInputs(Outputs(), {FLAGS_baseline}, &error)) {
    return UsageError(error);
  }
  if (!FLAGS_merge.empty()) return Merge(&bounds);
  if (!SettingsFromFlags(&options, &error)) return UsageError(error);
  if (!ReadBaseline(&bounds)) return kExitFailed;
  if (const int code = ListInput(Outputs(), &input); code != kExitDone) return code;

  FileComparison comparison = Compare(options, input);
  // A shard may have nothing to report, the whole may not.
  if (comparison.pairs.empty() && !input.shard) return kExitFailed;
  if (comparison.solvers.empty()) {
    return Failure("no solver's prior is in every file; try --prior=body");
  }
  ReportMotions(options, comparison, input);
  bool ok = input.all_there && comparison.errors.empty() && comparison.without_truth.empty();
  ComparisonReport report = MakeReport(std::move(comparison), input);
  ok = Write(&report, FLAGS_by == "sequence") && ok;
  // Of the whole, not of a part.
  ok = (input.shard || AnyMotion(report)) && ok;
  return ExitCodeOfBounds(ok, bounds, report.solvers);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
