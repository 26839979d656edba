// rigel_estimate: the motions of match files.
#include <algorithm>
#include <functional>
#include <iostream>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/problems/evaluation/drift_report.h"
#include "rigel/problems/evaluation/estimate_report.h"
#include "rigel/problems/evaluation/rig_test_report.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/message_groups.h"
#include "rigel/problems/io/trajectory_file.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/problems/trajectories/g2o_file.h"
#include "rigel/tools/estimate_files.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/estimation_messages.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    solver, "auto",
    "minimal solver of RANSAC (docs/solvers.md), or auto: tries the solvers that the prior "
    "allows, the most constrained one first, until the motion is not doubtful");
DEFINE_string(
    json, "",
    "write the motions as JSON (format rigel-estimate 1, docs/formats.md) to this file; - is "
    "stdout");
DEFINE_string(csv, "", "write the motions as CSV, one line per pair, to this file; - is stdout");
DEFINE_string(
    g2o, "",
    "write a g2o pose graph to this file; - is stdout. The files, in order, are consecutive "
    "pairs of one drive. Needs a refinement");
DEFINE_string(
    kitti_trajectory, "",
    "chain the motions of consecutive pairs and write the poses of the body in KITTI format (12 "
    "numbers per line, metres) to this file; - is stdout. Several trajectories go to FILE_0.EXT, "
    "FILE_1.EXT, ...");
DEFINE_string(
    tum_trajectory, "",
    "the same in TUM format, as evo reads it: TIME X Y Z QX QY QZ QW per line; seconds and "
    "metres");
DEFINE_bool(truth_trajectory, false, "also write the true trajectory, to FILE_truth.EXT");
DEFINE_bool(drift, false,
            "chain the motions and print the drift: the errors of the KITTI odometry benchmark, of "
            "single steps and of the final pose. Needs truth lines");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_estimate: estimates the relative pose (R, t), X_2 = R X_1 + t, of each match file.\n"
    "\n"
    "  rigel_estimate --matches=DIR --prior=body --json=motions.json\n"
    "\n"
    "RANSAC with a minimal solver finds a motion and its inliers; a nonlinear refinement then\n"
    "minimizes their error. The table shows the rotation angle, the direction of translation and\n"
    "|t|, each with its standard deviation, and \"-\" for what the matches do not determine. With\n"
    "--refine=none this is not known: the table then shows every direction, and |t| only if\n"
    "there are matches between different cameras.\n"
    "\n"
    "The JSON and CSV files hold the complete motions, from RANSAC (raw) and refined. The other\n"
    "outputs chain the refined motions of a drive to a pose graph or a trajectory.\n";

// Flags of outputs, with their files.
std::vector<OutputFlag> Outputs() {
  return {{"json", FLAGS_json},
          {"csv", FLAGS_csv},
          {"g2o", FLAGS_g2o},
          {"kitti_trajectory", FLAGS_kitti_trajectory},
          {"tum_trajectory", FLAGS_tum_trajectory}};
}

bool IsTrajectory(const std::string& flag) {
  return flag == "kitti_trajectory" || flag == "tum_trajectory";
}

bool Chained() {
  return FLAGS_drift || !FLAGS_kitti_trajectory.empty() || !FLAGS_tum_trajectory.empty();
}

// Notes on single pairs, on stderr with a word before each.
void ReportNotes(const std::string& before, const std::vector<std::string>& notes,
                 const std::vector<FramePair>& pairs) {
  std::vector<std::string> files;
  for (const FramePair& pair : pairs) files.push_back(pair.name);
  for (const std::string& note : GroupMessages(notes, files)) std::cerr << before << note << "\n";
}

bool SettingsFromFlags(ComparisonOptions* options, std::string* error) {
  if (!OptionsFromFlags(options, error) ||
      !SolverFromFlag(FLAGS_solver, &options->estimate, error) ||
      !OutputsDiffer(Outputs(), error)) {
    return false;
  }
  options->estimate.refine.score_rig = true;
  if (!FLAGS_g2o.empty() && !options->estimate.refine_motion) {
    return Refuse("--g2o: without a refinement (--refine=none) a motion has no information", error);
  }
  if (FLAGS_truth_trajectory && FLAGS_kitti_trajectory.empty() && FLAGS_tum_trajectory.empty()) {
    return Refuse("--truth_trajectory: needs --kitti_trajectory or --tum_trajectory", error);
  }
  if (FLAGS_truth_trajectory &&
      (IsStdout(FLAGS_kitti_trajectory) || IsStdout(FLAGS_tum_trajectory))) {
    return Refuse("--truth_trajectory: stdout takes one trajectory; name a file", error);
  }
  return true;
}

// The motions of the run and, for each pair, its place among all files and the axes of its body.
struct Motions {
  EstimateReport report;
  std::vector<int> positions;
  std::vector<AppliedAxes> axes;
};

Motions Estimate(const ComparisonOptions& options, const InputFiles& input) {
  struct Estimated {
    MotionEstimate estimate;
    MatchCount matches;
  };
  const auto keep = [](const FramePair& pair, MotionEstimate estimate) {
    estimate.refine.inliers = std::vector<char>();
    return Estimated{
        std::move(estimate),
        {static_cast<int>(pair.matches.size()), HasInterCameraMatches(pair), RigNumber(pair.rig)}};
  };
  Motions motions;
  for (BatchItem<Estimated>& item : EstimateFiles<Estimated>(options, input, keep)) {
    motions.axes.push_back(item.axes);
    motions.positions.push_back(item.position);
    motions.report.pairs.push_back(std::move(item.pair));
    motions.report.matches.push_back(item.result.matches);
    motions.report.estimates.push_back(std::move(item.result.estimate));
  }
  motions.report.rig_test = TestRigOfRun(motions.report);
  motions.report.refined = options.estimate.refine_motion;
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.insert(output_flags.end(),
                      {"g2o", "kitti_trajectory", "tum_trajectory", "truth_trajectory", "drift"});
  motions.report.options = FlagValues(output_flags);
  return motions;
}

// Failed and doubtful motions, on stderr. False if no pair has a motion.
bool ReportMotions(const EstimateReport& report, const InputFiles& input) {
  std::vector<std::string> failures;
  std::vector<DoubtedMotion> motions;
  for (size_t k = 0; k < report.pairs.size(); ++k) {
    const MotionEstimate& e = report.estimates[k];
    if (e.HasMotion()) motions.push_back({report.pairs[k].name, e.doubt});
    if (e.status == EstimateStatus::kSuccess) continue;
    failures.push_back(FailureMessage(report.pairs[k], FLAGS_solver, e.message));
  }
  ReportGrouped(failures, input.paths);
  // That is to be told of the whole, not of a part.
  const bool none = motions.empty() && !input.shard;
  if (none) std::cerr << "no pair has a motion\n";
  ReportDoubts(FLAGS_solver, motions);
  for (const std::string& line : RigDoubtLines(report)) std::cerr << line << "\n";
  const std::string rig = RigTestLine(report.rig_test);
  if (!rig.empty()) std::cerr << rig << "\n";
  return !none;
}

// Chains the motions of the report. `positions` as in ChainMotions(). False if
// there is no trajectory, or none with the truth that --drift needs: told on stderr.
bool Chain(const std::vector<int>& positions, EstimateReport* report) {
  std::vector<char> has_inter;
  for (const MatchCount& count : report->matches) has_inter.push_back(count.any_inter ? 1 : 0);
  std::vector<std::string> notes;
  report->trajectories =
      ChainMotions(report->pairs, report->estimates, has_inter, positions, &notes);
  ReportNotes("trajectory: ", notes, report->pairs);
  bool any_truth = false;
  for (size_t k = 0; k < report->trajectories->size(); ++k) {
    const Trajectory& trajectory = (*report->trajectories)[k];
    any_truth = any_truth || !trajectory.truth.empty();
    const auto count = [&](int pairs, const char* what) {
      if (pairs == 0) return;
      std::cerr << "trajectory " << k << ": " << pairs << " of " << trajectory.NumPairs()
                << (trajectory.NumPairs() == 1 ? " pair " : " pairs ") << what << "\n";
    };
    count(trajectory.num_still, "with |t| consistent with zero, taken as zero");
    count(trajectory.num_stated_lengths, "without scale, of the distance that the file states");
  }
  if (report->trajectories->empty()) {
    std::cerr << "trajectory: no motion to chain\n";
    return false;
  }
  if (any_truth || (!FLAGS_drift && !FLAGS_truth_trajectory)) return true;
  std::cerr << (FLAGS_drift ? "--drift" : "--truth_trajectory")
            << ": no trajectory whose pairs all have a truth line\n";
  return false;
}

// The outputs with the names that several trajectories and their truths have.
std::vector<OutputFlag> AllOutputs(const std::vector<Trajectory>& trajectories) {
  std::vector<OutputFlag> all;
  for (const OutputFlag& output : Outputs()) {
    const auto& [flag, path] = output;
    if (!IsTrajectory(flag) || path.empty() || IsStdout(path)) {
      all.push_back(output);
      continue;
    }
    for (size_t k = 0; k < trajectories.size(); ++k) {
      all.emplace_back(flag, TrajectoryPath(path, k, trajectories.size(), false));
      if (!FLAGS_truth_trajectory || trajectories[k].truth.empty()) continue;
      all.emplace_back(flag, TrajectoryPath(path, k, trajectories.size(), true));
    }
  }
  return all;
}

// Writes the trajectories of --kitti_trajectory or --tum_trajectory. False with a message on stderr
// if that fails.
bool WriteTrajectories(const std::vector<Trajectory>& trajectories,
                       const std::vector<AppliedAxes>& axes, const std::string& flag,
                       const std::string& path) {
  if (path.empty() || trajectories.empty()) return true;
  const auto format = [&](const std::vector<Pose>& poses, const Trajectory& trajectory) {
    return flag == "tum_trajectory"
               ? FormatTumTrajectory(poses, trajectory.times, axes[trajectory.first_pair].axes)
               : FormatKittiTrajectory(poses);
  };
  if (IsStdout(path)) {
    if (trajectories.size() == 1) {
      return WriteOutput(path, format(trajectories[0].estimate, trajectories[0]));
    }
    std::cerr << "--" << flag << "=-: there are " << trajectories.size()
              << " trajectories, stdout takes one; name a file\n";
    return false;
  }
  std::string error;
  for (size_t k = 0; k < trajectories.size(); ++k) {
    const Trajectory& t = trajectories[k];
    const std::string file = TrajectoryPath(path, k, trajectories.size(), false);
    const std::string truth = TrajectoryPath(path, k, trajectories.size(), true);
    if (!WriteWholeFile(file, format(t.estimate, t), &error) ||
        (FLAGS_truth_trajectory && !t.truth.empty() &&
         !WriteWholeFile(truth, format(t.truth, t), &error))) {
      std::cerr << error << "\n";
      return false;
    }
    if (trajectories.size() > 1) {
      std::cerr << "--" << flag << ": trajectory " << k << ", " << t.NumPairs()
                << (t.NumPairs() == 1 ? " pair" : " pairs") << ", is in " << PrintablePath(file)
                << "\n";
    }
  }
  return true;
}

// The table and the files that the flags name. False with a message on stderr if one cannot be
// written.
bool Write(const Motions& motions) {
  const EstimateReport& report = motions.report;
  const std::string drift = DriftTable(report);
  bool ok = PrintTable(EstimateTable(report) + (drift.empty() ? "" : "\n" + drift), Outputs());
  const bool times = TimesAreGiven();
  if (!FLAGS_json.empty()) ok = WriteOutput(FLAGS_json, EstimateJson(report, times)) && ok;
  if (!FLAGS_csv.empty()) ok = WriteOutput(FLAGS_csv, EstimateCsv(report, times)) && ok;
  if (!FLAGS_g2o.empty()) {
    std::vector<std::string> notes;
    const std::string graph = FormatG2o(report.pairs, report.estimates, motions.positions, &notes);
    ReportNotes("--g2o: ", notes, report.pairs);
    ok = WriteOutput(FLAGS_g2o, graph) && ok;
  }
  if (!report.trajectories) return ok;
  for (const auto& [flag, path] : Outputs()) {
    if (!IsTrajectory(flag)) continue;
    ok = WriteTrajectories(*report.trajectories, motions.axes, flag, path) && ok;
  }
  return ok;
}

int Run() {
  ComparisonOptions options;
  InputFiles input;
  std::string error;
  if (!SettingsFromFlags(&options, &error)) return UsageError(error);
  if (const int code = ListInput(Outputs(), &input); code != kExitDone) return code;

  Motions motions = Estimate(options, input);
  EstimateReport& report = motions.report;
  // A shard may have nothing to report, the whole may not.
  if (report.pairs.empty() && !input.shard) return kExitFailed;
  ReportSuggestedAxes(options, {FLAGS_solver}, motions.axes);
  ReportUnweighedPriors(options, {FLAGS_solver}, report.pairs);
  bool ok = input.all_there && report.pairs.size() == input.paths.size();
  ok = ReportMotions(report, input) && ok;
  // An empty shard has nothing to chain, and nothing is wrong with it.
  if (Chained() && !report.pairs.empty()) ok = Chain(motions.positions, &report) && ok;
  if (report.trajectories) {
    const std::vector<OutputFlag> outputs = AllOutputs(*report.trajectories);
    if (!OutputsDiffer(outputs, &error) || !OutputsAreNoInputs(outputs, input.all, &error)) {
      return UsageError(error);
    }
  }
  ok = Write(motions) && ok;
  return ExitCode(ok);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
