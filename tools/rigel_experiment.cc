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
#include "rigel/tools/output_directory.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/python_script.h"
#include "rigel/tools/tool.h"

DEFINE_string(name, "", "names of experiments, comma separated, or all; see --list");
DEFINE_bool(list, false, "print the names of the experiments and exit");
DEFINE_string(output, "", "directory for the results; created if missing");
DEFINE_bool(quick, false, "fewer pairs and a coarser grid: minutes instead of hours");
DEFINE_int32(pairs, 0, "number of frame pairs per point. 0: 500, with --quick 30");
DEFINE_string(poses, "",
              "directory of KITTI odometry poses (00.txt, ...), for the experiment kitti-motions");
DEFINE_string(kitti_root, "",
              "directory of the KITTI odometry data; uses the poses in it, as --poses");
DEFINE_int32(every, 0, "kitti-motions takes every n-th motion. 0: 20, with --quick 100");
DEFINE_bool(resume, false, "continue an interrupted run with the same flags in --output");
DEFINE_bool(overwrite, false, "discard earlier results in --output");
DEFINE_bool(figures, true, "draw figures with rigel_plot.py (needs python3-matplotlib)");
DEFINE_string(html, "",
              "also write all tables and figures to this one HTML file, which needs no other file");
DEFINE_bool(no_times, false,
            "leave run times out of the results, which are then equal in every run");
DEFINE_uint64(seed, 1, "seed of the random numbers. The same seed gives the same frame pairs");
DEFINE_int32(threads, 0,
             "number of threads, 0 to 1024; 0: one per core. Results do not depend on it");

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr char kUsage[] =
    "rigel_experiment: runs the experiments of the paper and further ones on the same scene.\n"
    "\n"
    "  rigel_experiment --name=all --quick --output=DIR\n"
    "\n"
    "A point of an experiment is one motion with, for example, one noise level. At each point\n"
    "all solvers of the experiment run on the same frame pairs, with RANSAC as in the paper\n"
    "(maximum inlier count) and with Rigel's RANSAC, each followed by the refinement.\n"
    "\n"
    "The directory gets, for each experiment NAME, NAME.json, NAME.csv, NAME.txt (the table) and\n"
    "figures/NAME*.png and .svg. claims.md and claims.json hold the verdict of rigel_claims.py\n"
    "(needs python3) on each claim of the paper. NAME.points.jsonl stores finished points: to\n"
    "continue an interrupted run, repeat the command with --resume. Only one run at a time can\n"
    "use a directory. docs/experiments.md lists the experiments with their run times.\n";

int PrintList() {
  constexpr size_t kNameColumns = 20;  // columns: the longest name and two blanks
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    std::cout << spec.name << std::string(kNameColumns - std::string(spec.name).size(), ' ')
              << spec.about << "\n";
  }
  return ExitCode(FlushStdout());
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
  std::string error;
  if (!MakeDirectory(FLAGS_output, &error)) return Failed(error);
  if (!lock->Take(OutputPath("rigel_experiment.lock"), &error)) return Failed(error);
  for (const std::string& directory : {FLAGS_output, OutputPath("figures")}) {
    RemoveLeftOvers(directory, [](const std::string&) { return true; });
  }
  for (const ExperimentPlan& plan : plans) {
    if (FLAGS_resume || FLAGS_overwrite || !fs::exists(StorePath(plan), code)) continue;
    return Failed(PrintablePath(StorePath(plan)) +
                  ": is of an earlier run; --resume continues it, --overwrite discards it");
  }
  return true;
}

void DropTimes(std::vector<ExperimentRow>* rows) {
  for (ExperimentRow& row : *rows) {
    row.summary.ransac_ms.reset();
    row.summary.refine_ms.reset();
  }
}

// Opens the store of each plan. *num_pairs is how many are still to be worked on.
bool OpenStores(const std::vector<ExperimentPlan>& plans, std::vector<ExperimentStore>* stores,
                int* num_pairs) {
  stores->resize(plans.size());
  *num_pairs = 0;
  std::string error;
  for (size_t k = 0; k < plans.size(); ++k) {
    ExperimentStore& store = (*stores)[k];
    if (!store.Open(StorePath(plans[k]), plans[k], FLAGS_resume, &error)) return Failed(error);
    for (const ExperimentPoint& point : plans[k].points) {
      if (!store.Has(point)) *num_pairs += CountPairs(plans[k], point);
    }
  }
  return true;
}

// Points that the stores do not have yet.
bool RunPoints(const std::vector<ExperimentPlan>& plans, std::vector<ExperimentStore>* stores) {
  int num_pairs = 0;
  if (!OpenStores(plans, stores, &num_pairs)) return false;
  Progress progress(ProgramName() + ", pairs", num_pairs);
  const auto step = [&] { progress.Step(); };
  std::string error;
  for (size_t k = 0; k < plans.size(); ++k) {
    ExperimentStore& store = (*stores)[k];
    for (const ExperimentPoint& point : plans[k].points) {
      if (store.Has(point)) continue;
      std::vector<ExperimentRow> rows;
      if (!RunExperimentPoint(plans[k], point, store.rows(), step, &rows, &error)) {
        return Failed(error);
      }
      if (FLAGS_no_times) DropTimes(&rows);
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
            << PrintablePath(FLAGS_output) << "; when this is fixed, get the " << what
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

bool OptionsFromFlags(ExperimentOptions* options, std::string* error) {
  if (FLAGS_output.empty()) return Refuse("--output is missing: name a directory", error);
  if (FLAGS_pairs < 0) return Refuse("--pairs: expected at least 1", error);
  if (FLAGS_every < 0) return Refuse("--every: expected at least 1", error);
  if (!CheckThreads(FLAGS_threads, 0, error)) return false;
  if (FLAGS_resume && FLAGS_overwrite) {
    return Refuse("--resume and --overwrite contradict each other", error);
  }
  if (!FLAGS_poses.empty() && !FLAGS_kitti_root.empty()) {
    return Refuse("--poses and --kitti_root name the same; give one of them", error);
  }
  options->quick = FLAGS_quick;
  options->pairs = FLAGS_pairs;
  options->every = FLAGS_every;
  options->seed = FLAGS_seed;
  options->num_threads = FLAGS_threads > 0
                             ? FLAGS_threads
                             : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options->poses = FLAGS_poses;
  if (!FLAGS_kitti_root.empty()) options->poses = (fs::path(FLAGS_kitti_root) / "poses").string();
  return true;
}

bool NeedsPoses(const ExperimentSpec& spec) { return spec.variable == ExperimentVariable::kNone; }

// All experiments for which there is what they need; says on stderr which are left out.
std::vector<const ExperimentSpec*> AllExperiments(const ExperimentOptions& options) {
  std::vector<const ExperimentSpec*> specs;
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    if (NeedsPoses(spec) && options.poses.empty()) {
      std::cerr << spec.name << ": left out, it needs --poses=DIR or --kitti_root=DIR\n";
    } else {
      specs.push_back(&spec);
    }
  }
  return specs;
}

bool ExperimentsFromFlags(const ExperimentOptions& options,
                          std::vector<const ExperimentSpec*>* specs, std::string* error) {
  const std::vector<std::string> names = SplitCommas(FLAGS_name);
  if (names == std::vector<std::string>{"all"}) {
    *specs = AllExperiments(options);
    return true;
  }
  if (names.empty())
    return Refuse("--name is missing; expected all or some of " + ExperimentNames(), error);
  for (const std::string& name : names) {
    const ExperimentSpec* spec = FindExperiment(name);
    if (spec == nullptr) {
      return Refuse("--name: there is no experiment '" + name + "'; expected all or some of " +
                        ExperimentNames(),
                    error);
    }
    if (std::find(specs->begin(), specs->end(), spec) != specs->end()) {
      return Refuse("--name: '" + name + "' is named twice", error);
    }
    if (NeedsPoses(*spec) && options.poses.empty()) {
      return Refuse(name + " needs --poses=DIR (00.txt, ...) or --kitti_root=DIR", error);
    }
    specs->push_back(spec);
  }
  return true;
}

bool MakePlans(const std::vector<const ExperimentSpec*>& specs, const ExperimentOptions& options,
               std::vector<ExperimentPlan>* plans, std::string* error) {
  plans->resize(specs.size());
  for (size_t k = 0; k < specs.size(); ++k) {
    if (!PlanExperiment(*specs[k], options, &(*plans)[k], error)) return false;
  }
  return true;
}

int Run() {
  if (FLAGS_list) return PrintList();
  ExperimentOptions options;
  std::vector<const ExperimentSpec*> specs;
  std::vector<ExperimentPlan> plans;
  std::string error;
  if (!OptionsFromFlags(&options, &error) || !ExperimentsFromFlags(options, &specs, &error)) {
    return UsageError(error);
  }
  if (!MakePlans(specs, options, &plans, &error)) return Failure(error);
  if (!HtmlHasAPlaceOfItsOwn(plans, options.poses, &error)) return UsageError(error);

  RunLock lock;
  std::vector<ExperimentStore> stores;
  if (!PrepareOutput(plans, &lock) || !HtmlWritable() || !RunPoints(plans, &stores)) {
    return kExitFailed;
  }
  bool ok = WriteResults(plans, stores);
  ok = JudgeClaims() && ok;
  ok = DrawFigures() && ok;
  return ExitCode(ok);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
