// rigel_estimate: the motions of match files.
#include <algorithm>
#include <functional>
#include <iostream>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/problems/evaluation/batch.h"
#include "rigel/problems/evaluation/report.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/message_groups.h"
#include "rigel/problems/io/trajectory_file.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/problems/trajectories/g2o_file.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(
    solver, "auto",
    "name of the minimal solver of RANSAC, or auto: the most constrained one that the priors "
    "allow, others after it while the result is doubtful");
DEFINE_string(json, "", "write the motions (format rigel-estimate 1) to this file; - is stdout");
DEFINE_string(csv, "", "write one line a pair to this file; - is stdout");
DEFINE_string(
    g2o, "",
    "write a pose graph of g2o, files in order one after the other along a drive, to this "
    "file; - is stdout");
DEFINE_string(
    kitti_trajectory, "",
    "chain the motions, files in order along a drive, and write the poses as KITTI does (12 "
    "numbers a line, body frame) to this file; several trajectories to FILE_0.EXT, FILE_1.EXT, "
    "...; - is stdout");
DEFINE_string(tum_trajectory, "", "the same as TUM's tools have it: TIME X Y Z QX QY QZ QW a line");
DEFINE_bool(truth_trajectory, false,
            "write the truth's trajectory as well, beside each: FILE_truth.EXT");
DEFINE_bool(drift, false,
            "chain the motions and print how far they drift from the truth: KITTI's metric, "
            "errors of single steps and of the end; as of the trajectory flags where there is a "
            "truth");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_estimate: the motion (R, t), X_2 = R X_1 + t, of each match file.\n"
    "\n"
    "  rigel_estimate --matches=DIR --prior=body --json=motions.json\n"
    "\n"
    "RANSAC with a minimal solver makes hypotheses, a refinement makes them accurate. The table\n"
    "gives the rotation angle, the direction of translation and |t| with their standard "
    "deviations,\n"
    "and \"-\" for what the matches do not determine. With --refine=none nothing says what they\n"
    "determine: the direction is shown as it is, |t| only where there are matches between "
    "cameras.\n"
    "The JSON and CSV give the motions in full, raw and refined; --g2o chains the refined ones,\n"
    "with their information, to a pose graph, --kitti_trajectory and --tum_trajectory to "
    "trajectories.\n";

// Flags of outputs, with their files.
std::vector<OutputFlag> Outputs() {
  return {{"json", FLAGS_json},
          {"csv", FLAGS_csv},
          {"g2o", FLAGS_g2o},
          {"kitti_trajectory", FLAGS_kitti_trajectory},
          {"tum_trajectory", FLAGS_tum_trajectory}};
}

bool StdoutIsAskedFor() {
  const auto outputs = Outputs();
  return std::any_of(outputs.begin(), outputs.end(),
                     [](const auto& output) { return IsStdout(output.second); });
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
    const bool trajectory = flag == "kitti_trajectory" || flag == "tum_trajectory";
    if (!trajectory || path.empty() || IsStdout(path)) {
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

// Of a solver that was named; the table says it of auto's.
void ReportDoubts(const EstimateReport& report) {
  std::vector<DoubtedMotion> motions;
  for (size_t k = 0; k < report.estimates.size(); ++k) {
    const MotionEstimate& e = report.estimates[k];
    if (e.HasMotion()) motions.push_back({report.pairs[k].name, e.doubt});
  }
  ReportDoubts(FLAGS_solver, motions);
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
  if (!OutputsDiffer(Outputs(), &error)) return UsageError(error);
  if (!FLAGS_g2o.empty() && !estimate.refine_motion) {
    return UsageError("--g2o: without a refinement (--refine=none) a motion has no information");
  }
  if (FLAGS_truth_trajectory && FLAGS_kitti_trajectory.empty() && FLAGS_tum_trajectory.empty()) {
    return UsageError("--truth_trajectory: needs --kitti_trajectory or --tum_trajectory");
  }
  if (FLAGS_truth_trajectory &&
      (IsStdout(FLAGS_kitti_trajectory) || IsStdout(FLAGS_tum_trajectory))) {
    return UsageError("--truth_trajectory: stdout takes one trajectory; name a file");
  }

  const InputFiles input = ListInput();
  if (!OutputsAreNoInputs(Outputs(), input.all, &error)) return UsageError(error);
  if (input.total == 0) return kExitFailed;
  bool ok = input.all_there;
  struct Estimated {
    MotionEstimate estimate;
    MatchCount matches;
  };
  const std::function<Estimated(const FramePair&)> work = [&](const FramePair& pair) {
    const EstimateOptions pair_options =
        options.use_stated_noise ? WithStatedNoise(estimate, pair) : estimate;
    Estimated result{EstimateMotion(pair_options, pair),
                     {static_cast<int>(pair.matches.size()), HasInterCameraMatches(pair)}};
    result.estimate.refine.inliers = std::vector<char>();
    return result;
  };
  std::vector<BatchItem<Estimated>> items;
  {
    Progress progress(FLAGS_solver, static_cast<int>(input.paths.size()));
    estimate.refine.progress = ShowRefinement(&progress);
    items = RunBatch(options, input.paths, input.first, work, [&] { progress.Step(); });
    estimate.refine.progress = nullptr;
  }
  EstimateReport report;
  std::vector<int> positions;
  std::vector<std::string> errors, failures;
  std::vector<AppliedAxes> axes;
  for (BatchItem<Estimated>& item : items) {
    if (!item.error.empty()) {
      // Each that could not be read is told; of those that were many may lack the same.
      if (item.pair.name.empty()) {
        std::cerr << PrintablePath(item.error) << "\n";
      } else {
        errors.push_back(PrintablePath(item.error));
      }
      ok = false;
      continue;
    }
    axes.push_back(item.axes);
    positions.push_back(item.position);
    report.pairs.push_back(std::move(item.pair));
    report.matches.push_back(item.result.matches);
    report.estimates.push_back(std::move(item.result.estimate));
  }
  ReportGrouped(errors, input.paths);
  // A shard may have nothing to report, the whole may not.
  if (report.pairs.empty() && !input.shard) return kExitFailed;
  ReportSuggestedAxes(options, {FLAGS_solver}, axes);
  ReportUnweighedPriors(options, {FLAGS_solver}, report.pairs);
  bool any_motion = false;
  for (size_t k = 0; k < report.pairs.size(); ++k) {
    const MotionEstimate& e = report.estimates[k];
    any_motion = any_motion || e.HasMotion();
    if (e.status == EstimateStatus::kSuccess) continue;
    failures.push_back(FailureMessage(report.pairs[k], FLAGS_solver, e.message));
  }
  ReportGrouped(failures, input.paths);
  // That is to be told of the whole, not of a part.
  if (!any_motion && !input.shard) {
    std::cerr << "no pair has a motion\n";
    ok = false;
  }

  ReportDoubts(report);
  for (const std::string& line : RigDoubtLines(report)) std::cerr << line << "\n";
  report.refined = estimate.refine_motion;
  // An empty shard has nothing to chain, and nothing is wrong with it.
  if (Chained() && !report.pairs.empty()) ok = Chain(positions, &report) && ok;
  if (report.trajectories &&
      (!OutputsDiffer(AllOutputs(*report.trajectories), &error) ||
       !OutputsAreNoInputs(AllOutputs(*report.trajectories), input.all, &error))) {
    return UsageError(error);
  }
  // stdout belongs to the machine if it asked for it.
  if (!StdoutIsAskedFor()) {
    std::cout << EstimateTable(report);
    const std::string drift = DriftTable(report);
    if (!drift.empty()) std::cout << "\n" << drift;
    ok = FlushStdout() && ok;
  }
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.insert(output_flags.end(),
                      {"g2o", "kitti_trajectory", "tum_trajectory", "truth_trajectory", "drift"});
  report.options = FlagValues(output_flags);
  const bool times = TimesAreGiven();
  if (!FLAGS_json.empty()) ok = WriteOutput(FLAGS_json, EstimateJson(report, times)) && ok;
  if (!FLAGS_csv.empty()) ok = WriteOutput(FLAGS_csv, EstimateCsv(report, times)) && ok;
  if (!FLAGS_g2o.empty()) {
    std::vector<std::string> notes;
    const std::string graph = FormatG2o(report.pairs, report.estimates, positions, &notes);
    ReportNotes("--g2o: ", notes, report.pairs);
    ok = WriteOutput(FLAGS_g2o, graph) && ok;
  }
  if (report.trajectories) {
    const std::vector<Trajectory>& trajectories = *report.trajectories;
    ok = WriteTrajectories(trajectories, axes, "kitti_trajectory", FLAGS_kitti_trajectory) && ok;
    ok = WriteTrajectories(trajectories, axes, "tum_trajectory", FLAGS_tum_trajectory) && ok;
  }
  return ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
