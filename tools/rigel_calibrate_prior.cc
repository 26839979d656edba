// rigel_calibrate_prior: motion plane and mounting of the IMU from the motions of match files.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <set>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/core/body_axes.h"
#include "rigel/core/rig_centre.h"
#include "rigel/problems/calibration/calibration_report.h"
#include "rigel/problems/evaluation/batch.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_header.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/refine/solver_choice.h"
#include "rigel/tools/estimation_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(solver, "5pt+1", "name of the minimal solver, or auto; 5pt+1 needs no prior");
DEFINE_string(lines, "normal",
              "what is calibrated, comma separated: normal (of the motion plane), axis (the same "
              "direction as rotation axis), gravity (the rotation from the frame of the stated "
              "gravity to the body)");
DEFINE_string(output, "",
              "write copies of the match files with the calibrated lines to this directory, made "
              "if missing; one with match files other than those of an earlier run is refused");
DEFINE_bool(in_place, false, "write the calibrated lines into the match files themselves");
DEFINE_string(json, "",
              "write the calibration (format rigel-prior-calibration 1) to this file; - is stdout");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_calibrate_prior: the motion plane and the mounting of an IMU from a clip's motions.\n"
    "\n"
    "  rigel_calibrate_prior --matches=DIR --lines=normal,axis --output=CALIBRATED\n"
    "  rigel_compare --matches=CALIBRATED --solvers=3pt --prior=file\n"
    "\n"
    "Estimates the motion of each match file of one vehicle and from them all the normal of the\n"
    "plane that it moves in, starting from the files' normal or the body's down, and the rotation\n"
    "that turns the stated gravity into the body frame. What the motions do not determine is said\n"
    "and left as it was: a drive straight ahead says nothing of the plane's roll, and without\n"
    "turns nothing of the IMU's mounting. Files are replaced whole, all new ones written before "
    "the\n"
    "first takes its place, their other lines and comments untouched; what a killed run had not "
    "put\n"
    "in its place is finished by the next. A comment line tells the calibrated ones; input of "
    "which\n"
    "only a part is calibrated is refused.\n";

struct Lines {
  bool normal = false;
  bool axis = false;
  bool gravity = false;

  bool Plane() const { return normal || axis; }
};

bool ParseLines(const std::string& text, Lines* lines) {
  const std::vector<std::string> names = SplitCommas(text);
  for (const std::string& name : names) {
    bool* const line = name == "normal"    ? &lines->normal
                       : name == "axis"    ? &lines->axis
                       : name == "gravity" ? &lines->gravity
                                           : nullptr;
    if (line == nullptr) return false;
    *line = true;
  }
  return !names.empty();
}

// The lines that are calibrated.
std::vector<std::string> Names(const Lines& lines) {
  std::vector<std::string> names;
  if (lines.normal) names.push_back("normal");
  if (lines.axis) names.push_back("axis");
  if (lines.gravity) names.push_back("gravity");
  return names;
}

// Whether all files were calibrated by the same run, or none. An interrupted run leaves a part, and
// with it no calibration would be that of all.
bool SameMarks(const std::vector<std::string>& paths, const std::string& line, std::string* error) {
  std::set<std::string> marks;
  size_t marked = 0;
  for (const std::string& path : paths) {
    const std::string mark = FindHeaderComment(path, CalibrationMark(line));
    if (mark.empty()) continue;
    marks.insert(mark);
    ++marked;
  }
  if (marked == 0 || (marked == paths.size() && marks.size() == 1)) return true;
  const std::string what =
      marked < paths.size()
          ? std::to_string(marked) + " of " + std::to_string(paths.size()) +
                " files are calibrated already, the others are not"
          : "the files were calibrated by " + std::to_string(marks.size()) + " different runs";
  *error = "--lines=" + line + ": " + what + " (line '" + CalibrationMark(line) +
           "'), as an interrupted run leaves them; begin again with the files as they were before";
  return false;
}

// All marks of calibrations in a file.
std::string Marks(const std::string& path) {
  std::string marks;
  for (const char* line : {"normal", "axis", "gravity"}) {
    marks += FindHeaderComment(path, CalibrationMark(line)) + "\n";
  }
  return marks;
}

// A run with --in_place that was killed while its files took their places had written all of them:
// those that did not get there yet do it now.
void FinishInterruptedRun(const std::vector<std::string>& paths) {
  std::set<std::string> in_place;
  for (const std::string& path : paths) in_place.insert(Marks(path));
  int finished = 0;
  for (const std::string& path : paths) {
    const bool done = FinishLeftOver(path, [&](const std::string& temporary) {
      const std::string marks = Marks(temporary);
      FramePair pair;
      std::string ignored;
      return marks != Marks(path) && in_place.count(marks) > 0 &&
             ReadMatchFile(temporary, &pair, &ignored);
    });
    finished += done ? 1 : 0;
  }
  if (finished == 0) return;
  std::cerr << "an interrupted run is finished: " << finished << " of " << paths.size()
            << " files take their places\n";
}

// Match files in --output that this run does not overwrite, or that are not the program's own
// work. In byte order.
std::set<std::string> OtherMatchFiles(const std::set<std::string>& targets, std::error_code* code) {
  namespace fs = std::filesystem;
  std::set<std::string> others;
  fs::directory_iterator entry(FLAGS_output, *code);
  for (; !*code && entry != fs::directory_iterator(); entry.increment(*code)) {
    const std::string path = entry->path().string();
    std::error_code ignored;
    if (!IsMatchFileName(entry->path().filename().string()) || entry->is_directory(ignored)) {
      continue;
    }
    const bool own = targets.count((fs::path(FLAGS_output) / entry->path().filename()).string()) &&
                     !FindHeaderComment(path, "# rigel_calibrate_prior").empty();
    if (!own) others.insert(entry->path().filename().string());
  }
  return others;
}

// Where each file is written to; empty with a message if two would be one, one its own source, or
// the files of --output not all of this run.
std::vector<std::string> Targets(const std::vector<std::string>& paths, std::string* error) {
  namespace fs = std::filesystem;
  if (FLAGS_in_place) return paths;
  std::error_code code;
  std::vector<std::string> targets;
  std::set<std::string> seen;
  for (const std::string& path : paths) {
    targets.push_back((fs::path(FLAGS_output) / fs::path(path).filename()).string());
    if (!seen.insert(targets.back()).second) {
      *error = PrintablePath(path) + ": another file has the same name, both would be " +
               PrintablePath(targets.back());
      return {};
    }
    if (fs::equivalent(path, targets.back(), code)) {
      *error = PrintablePath(path) + ": --output would overwrite it; use --in_place for that";
      return {};
    }
  }
  if (!fs::is_directory(FLAGS_output, code)) return targets;
  code.clear();
  const std::set<std::string> others = OtherMatchFiles(seen, &code);
  if (code) {
    *error = PrintablePath(FLAGS_output) + ": cannot be listed: " + code.message();
    return {};
  }
  if (!others.empty()) {
    *error = PrintablePath(FLAGS_output) + ": holds " + PrintablePath(*others.begin()) +
             (others.size() > 1 ? " and " + std::to_string(others.size() - 1) + " more" : "") +
             ", which this run does not overwrite and which would be read as if it were of this "
             "run; empty the directory or name another";
    return {};
  }
  return targets;
}

// Whether the cameras are the same but for where they sit, which rigel_simulate draws anew for each
// pair.
bool SameCameras(const Rig& a, const Rig& b) {
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                    [](const RigCamera& camera1, const RigCamera& camera2) {
                      const PinholeCamera& c1 = camera1.intrinsics;
                      const PinholeCamera& c2 = camera2.intrinsics;
                      return c1.fx == c2.fx && c1.fy == c2.fy && c1.cx == c2.cx && c1.cy == c2.cy &&
                             c1.width == c2.width && c1.height == c2.height;
                    });
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

// Whether all files have these marks already and the calibration turns nothing: after a run that
// was killed at its end, too.
bool AlreadyCalibrated(const std::map<std::string, std::string>& marks,
                       const std::vector<FramePair>& pairs) {
  return std::all_of(marks.begin(), marks.end(), [&](const auto& mark) {
    const auto& [words, line] = mark;
    return line == words + " turned by " + FormatNumber(0.0, 6) + " deg" &&
           std::all_of(pairs.begin(), pairs.end(), [&words = words](const FramePair& pair) {
             return !FindHeaderComment(pair.name, words).empty();
           });
  });
}

bool WriteFiles(const CalibrationReport& report, const Lines& lines,
                const std::vector<FramePair>& pairs) {
  std::vector<std::string> paths;
  for (const FramePair& pair : pairs) paths.push_back(pair.name);
  std::string error;
  const std::vector<std::string> targets = Targets(paths, &error);
  if (targets.empty()) {
    std::cerr << error << "\n";
    return false;
  }
  std::error_code code;
  if (!FLAGS_in_place) std::filesystem::create_directories(FLAGS_output, code);
  if (code) {
    std::cerr << PrintablePath(FLAGS_output) << ": cannot be made: " << code.message() << "\n";
    return false;
  }
  const std::map<std::string, std::string> marks = MarkLines(report, lines.normal, lines.axis);
  if (FLAGS_in_place && AlreadyCalibrated(marks, pairs)) {
    std::cerr << "nothing is written: all " << pairs.size() << " files are calibrated so already\n";
    return true;
  }
  StagedFiles files;
  for (size_t k = 0; k < pairs.size(); ++k) {
    std::map<std::string, std::string> changed = marks;
    if (report.plane) changed.merge(PlaneLines(*report.plane, lines.normal, lines.axis));
    if (report.gravity) changed.merge(GravityLines(*report.gravity, pairs[k].prior));
    std::string text;
    if (!ReadWithHeaderLines(paths[k], changed, &text, &error) ||
        !files.Add(targets[k], MatchFileBytes(targets[k], text), &error)) {
      std::cerr << error << "; no file is written\n";
      return false;
    }
  }
  if (!files.Commit(&error)) {
    std::cerr << error << "; " << files.committed() << " of " << pairs.size()
              << " files are written\n";
    return false;
  }
  std::cerr << "wrote " << pairs.size() << (pairs.size() == 1 ? " match file" : " match files")
            << (FLAGS_in_place ? " in place" : " to " + PrintablePath(FLAGS_output)) << "\n";
  return true;
}

int Run() {
  ComparisonOptions options;
  std::string error;
  Lines lines;
  if (!OptionsFromFlags(&options, &error)) return UsageError(error);
  if (!ParseLines(FLAGS_lines, &lines)) {
    return UsageError("--lines=" + FLAGS_lines + ": expected some of normal, axis, gravity");
  }
  EstimateOptions& estimate = options.estimate;
  estimate.solver = FLAGS_solver;
  if (!IsSolverName(FLAGS_solver)) {
    return UsageError("--solver=" + FLAGS_solver + ": expected one of " + SolverNamesWithAuto());
  }
  if (!CanRefine(estimate, FLAGS_solver, &error)) return UsageError(error);
  if (!estimate.refine_motion) {
    return UsageError("--refine=none: a calibration is of refined motions");
  }
  if (lines.gravity && options.prior.source != PriorSource::kFile) {
    return UsageError(
        "--lines=gravity: the stated directions are those of the files: --prior=file");
  }
  if (FLAGS_in_place && !FLAGS_output.empty()) {
    return UsageError("--in_place: --output names another place");
  }
  const std::vector<std::string> given = GivenFlags();
  if (std::find(given.begin(), given.end(), "shard") != given.end()) {
    return UsageError("--shard: a calibration is of all files");
  }
  const bool writes = FLAGS_in_place || !FLAGS_output.empty();
  if (writes && ReadsStdin()) {
    return UsageError(
        "--matches: stdin has no file whose lines could be written; without --in_place and "
        "--output it is read");
  }

  const InputFiles input = ListInput();
  if (!OutputsDiffer({{"json", FLAGS_json}}, &error) ||
      !OutputsAreNoInputs({{"json", FLAGS_json}}, input.all, &error)) {
    return UsageError(error);
  }
  if (input.total == 0) return kExitFailed;
  bool ok = input.all_there;
  if (FLAGS_in_place) FinishInterruptedRun(input.paths);
  // What would be refused at the end is refused before the work.
  for (const std::string& line : Names(lines)) {
    if (SameMarks(input.paths, line, &error)) continue;
    std::cerr << error << "\n";
    return kExitFailed;
  }
  if (writes) {
    const std::vector<std::string> targets = Targets(input.paths, &error);
    if (targets.empty()) {
      std::cerr << error << "\n";
      return kExitFailed;
    }
    for (const std::string& target : targets) {
      if (!SameOutputFile(target, FLAGS_json)) continue;
      return UsageError("--json=" + FLAGS_json + ": a match file goes to this file; name another");
    }
  }
  struct Estimated {
    CalibrationMotion motion;
    Rig rig;
    std::string failure;  // empty if there is a refined motion
  };
  const std::function<Estimated(const FramePair&)> work = [&](const FramePair& pair) {
    const EstimateOptions pair_options =
        options.use_stated_noise ? WithStatedNoise(estimate, pair) : estimate;
    const MotionEstimate e = EstimateMotion(pair_options, pair);
    const bool refined = e.status == EstimateStatus::kSuccess && e.refine.IsSolutionUsable();
    // Any point of a body in planar motion will do. The rig's centre is the one that the matches
    // say most of.
    return Estimated{
        {MotionOfPoint(e.pose, RigCentre(pair.rig)), refined && e.refine.rotation_observable,
         refined && e.refine.rig_translation_observable, pair.prior},
        pair.rig,
        refined ? "" : FailureMessage(pair, FLAGS_solver, e.message)};
  };
  std::vector<BatchItem<Estimated>> items;
  {
    Progress progress("rigel_calibrate_prior", static_cast<int>(input.paths.size()));
    items = RunBatch(options, input.paths, input.first, work, [&] { progress.Step(); });
  }
  std::vector<FramePair> pairs;
  std::vector<CalibrationMotion> motions;
  CalibrationReport report;
  Rig rig;  // of the first pair
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
    if (!item.result.failure.empty()) failures.push_back(item.result.failure);
    if (pairs.empty()) rig = item.result.rig;
    if (!SameCameras(rig, item.result.rig)) {
      ReportGrouped(errors, input.paths);
      std::cerr << "a calibration is of one vehicle: cameras differ between "
                << PrintablePath(pairs.front().name) << " and " << PrintablePath(item.pair.name)
                << "\n";
      return kExitFailed;
    }
    pairs.push_back(std::move(item.pair));
    axes.push_back(item.axes);
    motions.push_back(item.result.motion);
    report.estimated += item.result.motion.has_rotation ? 1 : 0;
  }
  ReportGrouped(errors, input.paths);
  ReportGrouped(failures, input.paths);
  if (pairs.empty()) return kExitFailed;
  report.pairs = static_cast<int>(pairs.size());
  if (lines.Plane()) report.start = Start(options, pairs, rig, &axes);
  ReportSuggestedAxes(options, {FLAGS_solver}, axes);
  if (failures.size() == pairs.size()) {
    std::cerr << "no pair has a motion\n";
    ok = false;
  }
  if (lines.Plane()) report.plane = CalibratePlane(motions, report.start);
  if (lines.gravity) report.gravity = CalibrateGravity(motions);
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.insert(output_flags.end(), {"output", "in_place"});
  report.options = FlagValues(output_flags);

  // stdout belongs to the machine if it asked for it.
  if (!IsStdout(FLAGS_json)) {
    std::cout << CalibrationText(report);
    ok = FlushStdout() && ok;
  }
  if (!FLAGS_json.empty()) ok = WriteOutput(FLAGS_json, CalibrationJson(report)) && ok;
  if (!writes) return ok ? kExitDone : kExitFailed;
  if (FLAGS_in_place && (pairs.size() < items.size() || !input.all_there)) {
    // The part that is calibrated would no longer be of one kind with the rest.
    std::cerr << "nothing is written: --in_place needs all of the files, "
              << items.size() - pairs.size() << " of " << items.size() << " cannot be used\n";
    return kExitFailed;
  }
  const bool any = (report.plane && report.plane->level != CalibrationLevel::kNone) ||
                   (report.gravity && report.gravity->level != CalibrationLevel::kNone);
  if (!any) {
    std::cerr << "nothing is written: nothing that was asked for is determined\n";
    return kExitFailed;
  }
  return WriteFiles(report, lines, pairs) && ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
