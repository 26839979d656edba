// rigel_experiment: the paper's experiments, and more, with tables, figures and verdicts.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <gflags/gflags.h>

#include "rigel/problems/experiments/experiment.h"
#include "rigel/problems/experiments/experiment_report.h"
#include "rigel/problems/experiments/experiment_store.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/run_lock.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/tools/python_script.h"
#include "rigel/tools/tool.h"

DEFINE_string(name, "", "names of experiments, comma separated, or all; --list shows them");
DEFINE_bool(list, false, "print the experiments, one a line, and end");
DEFINE_string(output, "", "directory that gets the results; made if missing");
DEFINE_bool(quick, false, "few pairs and a coarse grid: minutes instead of hours");
DEFINE_int32(pairs, 0, "frame pairs of each point; 0: 500, with --quick 30");
DEFINE_string(poses, "",
              "directory of KITTI odometry poses (00.txt, ...), which kitti-motions needs");
DEFINE_string(kitti_root, "", "directory of the KITTI odometry data: its poses are --poses");
DEFINE_int32(every, 0, "kitti-motions takes each n-th motion; 0: 20, with --quick 100");
DEFINE_bool(resume, false, "continue an interrupted run of the same flags in --output");
DEFINE_bool(overwrite, false, "begin anew where --output has results");
DEFINE_bool(figures, true, "draw figures with rigel_plot.py (python3-matplotlib)");
DEFINE_string(html, "",
              "write tables and figures of the run to this one file, too; it needs no other file");
DEFINE_bool(no_times, false, "leave times out, so that two runs give the same files");
DEFINE_uint64(seed, 1, "the same seed makes the same frame pairs");
DEFINE_int32(threads, 0, "pairs worked on at a time; 0: all cores. Results do not depend on it");

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr char kUsage[] =
    "rigel_experiment: the experiments of the paper, and more on the same scene.\n"
    "\n"
    "  rigel_experiment --name=all --quick --output=DIR\n"
    "\n"
    "At each point of an experiment (a motion and, say, a noise level) all of its solvers run on\n"
    "the same frame pairs, in the paper's RANSAC (the largest inlier count wins) and in Rigel's,\n"
    "then the refinement. Per experiment NAME the directory gets NAME.json, NAME.csv, NAME.txt\n"
    "(table) and figures/NAME*.png and .svg; and claims.md, claims.json: each claim of the paper\n"
    "with a verdict, by rigel_claims.py (python3). NAME.points.jsonl keeps finished points: after\n"
    "an interruption the same command with --resume continues. One run at a time works in a\n"
    "directory. docs/experiments.md has sizes and times.\n";

int PrintList() {
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    std::cout << spec.name << std::string(20 - std::string(spec.name).size(), ' ') << spec.about
              << "\n";
  }
  return FlushStdout() ? kExitDone : kExitFailed;
}

std::string OutputPath(const std::string& name) { return (fs::path(FLAGS_output) / name).string(); }

std::string StorePath(const ExperimentPlan& plan) {
  return OutputPath(std::string(plan.spec->name) + ".points.jsonl");
}

bool Failed(const std::string& message) {
  std::cerr << message << "\n";
  return false;
}

// False with a message on stderr if --html could not be written: better before a long run.
bool HtmlWritable() {
  std::string error;
  return FLAGS_html.empty() || CanWriteWholeFile(FLAGS_html, &error) || Failed("--html: " + error);
}

// The one page is none of the other results and none of the recorded poses.
bool HtmlHasAPlaceOfItsOwn(const std::vector<ExperimentPlan>& plans, const std::string& poses,
                           std::string* error) {
  std::vector<OutputFlag> outputs;
  for (const char* name : {"claims.md", "claims.json"}) outputs.emplace_back("output", name);
  for (const ExperimentPlan& plan : plans) {
    for (const char* ending : {".json", ".csv", ".txt", ".points.jsonl"}) {
      outputs.emplace_back("output", std::string(plan.spec->name) + ending);
    }
  }
  for (auto& [flag, path] : outputs) path = OutputPath(path);
  outputs.emplace_back("html", FLAGS_html);
  std::vector<std::string> inputs;
  std::error_code code;
  fs::directory_iterator entry(poses, code);
  for (; !poses.empty() && !code && entry != fs::directory_iterator(); entry.increment(code)) {
    inputs.push_back(entry->path().string());
  }
  return OutputsDiffer(outputs, error) && OutputsAreNoInputs(outputs, inputs, error);
}

// False with a message on stderr. From then on no other run works in the directory.
bool PrepareOutput(const std::vector<ExperimentPlan>& plans, RunLock* lock) {
  std::error_code code;
  fs::create_directories(FLAGS_output, code);
  if (code) {
    return Failed(PrintablePath(FLAGS_output) + ": cannot be made: " + code.message());
  }
  std::string error;
  if (!lock->Take(OutputPath("rigel_experiment.lock"), &error)) return Failed(error);
  for (const std::string& directory : {FLAGS_output, OutputPath("figures")}) {
    RemoveLeftOvers(directory, [](const std::string&) { return true; });
  }
  for (const ExperimentPlan& plan : plans) {
    if (FLAGS_resume || FLAGS_overwrite || !fs::exists(StorePath(plan), code)) continue;
    return Failed(PrintablePath(StorePath(plan)) +
                  ": is of an earlier run; --resume continues it, --overwrite begins anew");
  }
  return true;
}

bool RunPoints(const std::vector<ExperimentPlan>& plans, std::vector<ExperimentStore>* stores) {
  stores->resize(plans.size());
  std::string error;
  int num_pairs = 0;
  for (size_t k = 0; k < plans.size(); ++k) {
    if (!(*stores)[k].Open(StorePath(plans[k]), plans[k], FLAGS_resume, &error)) {
      return Failed(error);
    }
    for (const ExperimentPoint& point : plans[k].points) {
      if (!(*stores)[k].Has(point)) num_pairs += CountPairs(plans[k], point);
    }
  }
  Progress progress("rigel_experiment, pairs", num_pairs);
  for (size_t k = 0; k < plans.size(); ++k) {
    ExperimentStore& store = (*stores)[k];
    for (const ExperimentPoint& point : plans[k].points) {
      if (store.Has(point)) continue;
      std::vector<ExperimentRow> rows;
      if (!RunExperimentPoint(
              plans[k], point, store.rows(), [&] { progress.Step(); }, &rows, &error)) {
        return Failed(error);
      }
      for (ExperimentRow& row : rows) {
        if (!FLAGS_no_times) continue;
        row.summary.ransac_ms.reset();
        row.summary.refine_ms.reset();
      }
      if (!store.Add(point, rows, &error)) return Failed(error);
    }
  }
  return true;
}

// Tables to stdout, all else to files.
bool WriteResults(const std::vector<ExperimentPlan>& plans,
                  const std::vector<ExperimentStore>& stores) {
  bool ok = true;
  for (size_t k = 0; k < plans.size(); ++k) {
    const std::string name = plans[k].spec->name;
    const std::vector<ExperimentRow> rows = stores[k].RowsInOrder(plans[k]);
    const std::string table = ExperimentTable(plans[k], rows);
    std::cout << table << "\n";
    const std::pair<std::string, std::string> files[] = {
        {name + ".json", ExperimentJson(plans[k], rows)},
        {name + ".csv", ExperimentCsv(plans[k], rows)},
        {name + ".txt", table}};
    for (const auto& [file, text] : files) {
      std::string error;
      if (!WriteWholeFile(OutputPath(file), text, &error)) ok = Failed(error);
    }
  }
  return FlushStdout() && ok;
}

// Else than kDone with a message on stderr that says how to go on.
ScriptOutcome RunOnResults(const std::string& name, const std::vector<std::string>& arguments,
                           const std::string& what) {
  std::string error;
  const ScriptOutcome outcome = RunScript(name, arguments, &error);
  if (outcome == ScriptOutcome::kDone) return outcome;
  std::cerr << "no " << what << ": " << error << "\nThe results are in "
            << PrintablePath(FLAGS_output) << "; once that is mended, get the " << what
            << " with\n  " << ScriptCommand(name, arguments) << "\n";
  return outcome;
}

// Verdicts to stdout, claims.md and claims.json: of this and of earlier runs in --output.
bool JudgeClaims() {
  return RunOnResults("rigel_claims.py", {"--", FLAGS_output}, "claims") == ScriptOutcome::kDone;
}

// That they cannot be drawn fails nothing but --html.
bool DrawFigures() {
  if (!FLAGS_figures && FLAGS_html.empty()) return true;
  std::vector<std::string> arguments = {FLAGS_output, "--output=" + OutputPath("figures")};
  if (!FLAGS_html.empty()) arguments.push_back("--html=" + FLAGS_html);
  const ScriptOutcome outcome = RunOnResults("rigel_plot.py", arguments, "figures");
  return outcome == ScriptOutcome::kDone ||
         (outcome == ScriptOutcome::kUnavailable && FLAGS_html.empty());
}

int Run() {
  if (FLAGS_list) return PrintList();
  const std::vector<std::string> names = SplitCommas(FLAGS_name);
  if (names.empty())
    return UsageError("--name is missing; expected all or some of " + ExperimentNames());
  if (FLAGS_output.empty()) return UsageError("--output is missing: name a directory");
  if (FLAGS_pairs < 0) return UsageError("--pairs: expected at least 1");
  if (FLAGS_every < 0) return UsageError("--every: expected at least 1");
  if (FLAGS_threads < 0 || FLAGS_threads > 1024) return UsageError("--threads: expected 0 to 1024");
  if (FLAGS_resume && FLAGS_overwrite) {
    return UsageError("--resume and --overwrite contradict each other");
  }
  if (!FLAGS_poses.empty() && !FLAGS_kitti_root.empty()) {
    return UsageError("--poses and --kitti_root name the same; give one of them");
  }
  ExperimentOptions options;
  options.quick = FLAGS_quick;
  options.pairs = FLAGS_pairs;
  options.every = FLAGS_every;
  options.seed = FLAGS_seed;
  options.num_threads = FLAGS_threads > 0
                            ? FLAGS_threads
                            : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options.poses = FLAGS_poses;
  if (!FLAGS_kitti_root.empty()) options.poses = (fs::path(FLAGS_kitti_root) / "poses").string();

  const bool all = names.size() == 1 && names[0] == "all";
  std::vector<const ExperimentSpec*> specs;
  if (all) {
    for (const ExperimentSpec& spec : ExperimentCatalogue()) specs.push_back(&spec);
  }
  for (const std::string& name : names) {
    if (all) break;
    const ExperimentSpec* spec = FindExperiment(name);
    if (spec == nullptr) {
      return UsageError("--name: there is no experiment '" + name + "'; expected all or some of " +
                        ExperimentNames());
    }
    if (std::find(specs.begin(), specs.end(), spec) != specs.end()) {
      return UsageError("--name: '" + name + "' is named twice");
    }
    specs.push_back(spec);
  }
  std::vector<ExperimentPlan> plans;
  for (const ExperimentSpec* spec : specs) {
    if (spec->variable == ExperimentVariable::kNone && options.poses.empty()) {
      if (!all) {
        return UsageError(std::string(spec->name) +
                          " needs --poses=DIR (00.txt, ...) or --kitti_root=DIR");
      }
      std::cerr << spec->name << ": left out, it needs --poses=DIR or --kitti_root=DIR\n";
      continue;
    }
    ExperimentPlan plan;
    std::string error;
    if (!PlanExperiment(*spec, options, &plan, &error)) {
      std::cerr << error << "\n";
      return kExitFailed;
    }
    plans.push_back(std::move(plan));
  }
  std::string error;
  if (!HtmlHasAPlaceOfItsOwn(plans, options.poses, &error)) return UsageError(error);
  RunLock lock;
  std::vector<ExperimentStore> stores;
  if (!PrepareOutput(plans, &lock) || !HtmlWritable() || !RunPoints(plans, &stores))
    return kExitFailed;
  bool ok = WriteResults(plans, stores);
  ok = JudgeClaims() && ok;
  ok = DrawFigures() && ok;
  return ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
