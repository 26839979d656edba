// rigel_calibrate_prior: motion plane and mounting of the IMU from the motions of match files.
#include <algorithm>
#include <functional>
#include <iostream>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/core/body_axes.h"
#include "rigel/core/rig_centre.h"
#include "rigel/problems/calibration/calibration_report.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/tools/calibrated_files.h"
#include "rigel/tools/estimate_files.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/estimation_messages.h"
#include "rigel/tools/outputs.h"
#include "rigel/tools/tool.h"

DEFINE_string(solver, "5pt+1", "minimal solver of RANSAC, or auto; 5pt+1 needs no prior");
DEFINE_string(
    lines, "normal",
    "lines to calibrate, comma separated: normal (of the motion plane), axis (of rotation, along "
    "the same direction) and gravity (by the rotation from the frame of the IMU to the body)");
DEFINE_string(
    output, "",
    "write copies of the match files with calibrated lines to this directory, which is created "
    "if missing. It must not hold match files other than those of an earlier run");
DEFINE_bool(in_place, false, "write the calibrated lines to the match files themselves");
DEFINE_string(
    json, "",
    "write the calibration as JSON (format rigel-prior-calibration 1, docs/formats.md) to this "
    "file; - is stdout");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_calibrate_prior: calibrates the motion plane and the mounting of an IMU of a vehicle.\n"
    "\n"
    "  rigel_calibrate_prior --matches=DIR --lines=normal,axis --output=CALIBRATED\n"
    "  rigel_compare --matches=CALIBRATED --solvers=3pt --prior=file\n"
    "\n"
    "All match files must be of one vehicle. From their estimated motions it determines the\n"
    "normal of the plane in which the vehicle moves, starting at the files' normal or at the\n"
    "body's down, and the rotation from the frame of the stated gravity to the body frame. A\n"
    "part that the motions do not determine is reported and left unchanged: driving straight\n"
    "does not determine the roll of the plane, and without turns the mounting of the IMU is not\n"
    "determined.\n"
    "\n"
    "With --output or --in_place the calibrated lines are written; all other lines stay the\n"
    "same, and a comment marks a calibrated file. All new files are written before the first one\n"
    "replaces an old one. If a run is killed while they do, the next run with --in_place\n"
    "finishes it. Input of which only some files are calibrated is an error.\n";

struct Settings {
  ComparisonOptions options;
  CalibratedLines lines;
};

std::vector<OutputFlag> Outputs() { return {{"json", FLAGS_json}}; }

bool WritesFiles() { return FLAGS_in_place || !FLAGS_output.empty(); }

bool SettingsFromFlags(Settings* settings, std::string* error) {
  ComparisonOptions& options = settings->options;
  if (!OptionsFromFlags(&options, error)) return false;
  if (!ParseLines(FLAGS_lines, &settings->lines)) {
    return WrongValue("lines", FLAGS_lines, "some of normal, axis, gravity", error);
  }
  if (!SolverFromFlag(FLAGS_solver, &options.estimate, error)) return false;
  if (!options.estimate.refine_motion) {
    return Refuse("--refine=none: a calibration needs refined motions", error);
  }
  if (settings->lines.gravity && options.prior.source != PriorSource::kFile) {
    return Refuse("--lines=gravity: needs --prior=file, the gravity that the files state", error);
  }
  if (FLAGS_in_place && !FLAGS_output.empty()) {
    return Refuse("--in_place and --output: expected one of them", error);
  }
  if (IsGiven("shard")) return Refuse("--shard: a calibration needs all files", error);
  if (WritesFiles() && ReadsStdin()) {
    return Refuse(
        "--matches=-: stdin cannot be written to; leave out --in_place and --output to read it",
        error);
  }
  return OutputsDiffer(Outputs(), error);
}

// What would be refused at the end is refused before the work. Returns an exit code.
int CheckFiles(const CalibratedLines& lines, const std::vector<std::string>& paths) {
  std::string error;
  if (!SameMarks(paths, lines, &error)) return Failure(error);
  if (!WritesFiles()) return kExitDone;
  const std::vector<std::string> targets = Targets(paths, FLAGS_output, &error);
  if (targets.empty()) return Failure(error);
  const bool json_is_one =
      std::any_of(targets.begin(), targets.end(),
                  [](const std::string& target) { return SameOutputFile(target, FLAGS_json); });
  if (!json_is_one) return kExitDone;
  return UsageError("--json=" + FLAGS_json + ": a match file goes to this file; name another");
}

// What is left of a file.
struct Estimated {
  CalibrationMotion motion;
  Rig rig;
  std::string failure;  // empty if there is a refined motion
};

Estimated Keep(const FramePair& pair, const MotionEstimate& estimate) {
  const RefineSummary& refine = estimate.refine;
  const bool refined = estimate.status == EstimateStatus::kSuccess && refine.IsSolutionUsable();
  // Any point of a body in planar motion will do. The rig's centre is the one that the matches
  // say most of.
  return {{MotionOfPoint(estimate.pose, RigCentre(pair.rig)), refined && refine.rotation_observable,
           refined && refine.rig_translation_observable, pair.prior},
          pair.rig,
          refined ? "" : FailureMessage(pair, FLAGS_solver, estimate.message)};
}

// What the files of a vehicle say.
struct Clip {
  std::vector<FramePair> pairs;
  std::vector<CalibrationMotion> motions;
  std::vector<AppliedAxes> axes;
  Rig rig;  // of the first pair
  std::vector<std::string> failures;
};

// Whether the cameras are the same but for where they sit, which rigel_simulate draws anew for each
// pair.
bool SameCameras(const Rig& a, const Rig& b) {
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                    [](const RigCamera& camera1, const RigCamera& camera2) {
                      const Camera& c1 = camera1.intrinsics;
                      const Camera& c2 = camera2.intrinsics;
                      return SameLens(c1, c2) && c1.width == c2.width && c1.height == c2.height;
                    });
}

// False with a message if the files are not of one vehicle.
bool Gather(std::vector<BatchItem<Estimated>> items, Clip* clip, std::string* error) {
  for (BatchItem<Estimated>& item : items) {
    if (!item.result.failure.empty()) clip->failures.push_back(item.result.failure);
    if (clip->pairs.empty()) clip->rig = item.result.rig;
    if (!SameCameras(clip->rig, item.result.rig)) {
      return Refuse("the files are not of one vehicle: cameras differ between " +
                        PrintablePath(clip->pairs.front().name) + " and " +
                        PrintablePath(item.pair.name),
                    error);
    }
    clip->pairs.push_back(std::move(item.pair));
    clip->axes.push_back(item.axes);
    clip->motions.push_back(item.result.motion);
  }
  return true;
}

// What --down says, else the normal that all files state, else what the cameras suggest: that is
// then noted in `applied`.
Eigen::Vector3d Start(const ComparisonOptions& options, const std::vector<FramePair>& pairs,
                      const Rig& rig, std::vector<AppliedAxes>* applied) {
  if (options.prior.down) return *options.prior.down;
  const std::optional<Eigen::Vector3d>& normal = pairs.front().prior.normal;
  const bool stated = options.prior.source == PriorSource::kFile && normal &&
                      std::all_of(pairs.begin(), pairs.end(), [&](const FramePair& pair) {
                        return pair.prior.normal && *pair.prior.normal == *normal;
                      });
  if (stated) return *normal;
  BodyAxes axes;
  std::string error;
  ResolveBodyAxes(rig, {}, pairs.front().prior.forward, &axes, &error);
  for (AppliedAxes& of_pair : *applied) {
    of_pair.axes.down = axes.down;
    of_pair.down_suggested = true;
    of_pair.cameras_off_down = CamerasOffDown(rig, axes.down);
  }
  return axes.down;
}

CalibrationReport Calibrate(const Settings& settings, Clip* clip) {
  CalibrationReport report;
  report.pairs = static_cast<int>(clip->pairs.size());
  for (const CalibrationMotion& motion : clip->motions) report.estimated += motion.has_rotation;
  if (settings.lines.Plane()) {
    report.start = Start(settings.options, clip->pairs, clip->rig, &clip->axes);
    report.plane = CalibratePlane(clip->motions, report.start);
  }
  if (settings.lines.gravity) report.gravity = CalibrateGravity(clip->motions);
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.insert(output_flags.end(), {"output", "in_place"});
  report.options = FlagValues(output_flags);
  return report;
}

// Returns an exit code. The part that --in_place calibrated would not be of one kind with the rest.
int WriteLines(const CalibrationReport& report, const CalibratedLines& lines,
               const std::vector<FramePair>& pairs, const InputFiles& input) {
  if (FLAGS_in_place && (pairs.size() < input.paths.size() || !input.all_there)) {
    return Failure("nothing is written: --in_place needs all of the files, " +
                   std::to_string(input.paths.size() - pairs.size()) + " of " +
                   std::to_string(input.paths.size()) + " cannot be used");
  }
  const bool any = (report.plane && report.plane->level != CalibrationLevel::kNone) ||
                   (report.gravity && report.gravity->level != CalibrationLevel::kNone);
  if (!any) return Failure("nothing is written: the motions determine none of --lines");
  return ExitCode(WriteCalibratedFiles(report, lines, pairs, FLAGS_output));
}

int Run() {
  Settings settings;
  InputFiles input;
  std::string error;
  if (!SettingsFromFlags(&settings, &error)) return UsageError(error);
  if (const int code = ListInput(Outputs(), &input); code != kExitDone) return code;
  if (FLAGS_in_place) FinishInterruptedRun(input.paths);
  if (const int code = CheckFiles(settings.lines, input.paths); code != kExitDone) return code;

  Clip clip;
  if (!Gather(EstimateFiles<Estimated>(settings.options, input, Keep), &clip, &error)) {
    return Failure(error);
  }
  ReportGrouped(clip.failures, input.paths);
  if (clip.pairs.empty()) return kExitFailed;
  const CalibrationReport report = Calibrate(settings, &clip);
  ReportSuggestedAxes(settings.options, {FLAGS_solver}, clip.axes);
  bool ok = input.all_there && clip.pairs.size() == input.paths.size();
  if (clip.failures.size() == clip.pairs.size()) {
    std::cerr << "no pair has a motion\n";
    ok = false;
  }

  ok = PrintTable(CalibrationText(report), Outputs()) && ok;
  if (!FLAGS_json.empty()) ok = WriteOutput(FLAGS_json, CalibrationJson(report)) && ok;
  if (!WritesFiles()) return ExitCode(ok);
  const int code = WriteLines(report, settings.lines, clip.pairs, input);
  return code != kExitDone ? code : ExitCode(ok);
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
