// rigel_calibrate_prior: motion plane and mounting of the IMU from the motions of match files.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <set>
#include <utility>

#include <gflags/gflags.h>

#include "rigel/problems/batch.h"
#include "rigel/problems/calibration_report.h"
#include "rigel/problems/match_file.h"
#include "rigel/problems/match_header.h"
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
              "if missing");
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
    "plane that it moves in, starting from the files' normal or the body's Y, and the rotation\n"
    "that turns the stated gravity into the body frame. What the motions do not determine is said\n"
    "and left as it was: a drive straight ahead says nothing of the plane's roll, and without\n"
    "turns nothing of the IMU's mounting. Files are replaced whole, one after the other, their\n"
    "other lines and comments untouched.\n";

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

// Where each file is written to; empty with a message if two would be one, or one its own source.
std::vector<std::string> Targets(const std::vector<std::string>& paths, std::string* error) {
  namespace fs = std::filesystem;
  if (FLAGS_in_place) return paths;
  std::error_code code;
  fs::create_directories(FLAGS_output, code);
  if (code) {
    *error = PrintablePath(FLAGS_output) + ": cannot be made: " + code.message();
    return {};
  }
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
  return targets;
}

// The body's Y unless all files state the same normal.
Eigen::Vector3d Start(const std::vector<FramePair>& pairs) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  for (const FramePair& pair : pairs) {
    if (!pair.prior.normal || *pair.prior.normal != *pairs.front().prior.normal) return y;
  }
  return *pairs.front().prior.normal;
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
  for (size_t k = 0; k < pairs.size(); ++k) {
    std::map<std::string, std::string> changed;
    if (report.plane) changed = PlaneLines(*report.plane, lines.normal, lines.axis);
    if (report.gravity) changed.merge(GravityLines(*report.gravity, pairs[k].prior));
    if (!RewriteMatchFile(paths[k], changed, targets[k], &error)) {
      std::cerr << error << "; " << k << " of " << pairs.size() << " files are written\n";
      return false;
    }
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

  const InputFiles input = ListInput();
  if (input.total == 0) return kExitFailed;
  bool ok = input.all_there;
  const std::function<CalibrationMotion(const FramePair&)> work = [&](const FramePair& pair) {
    EstimateOptions pair_options = estimate;
    if (options.use_stated_noise && pair.noise_px) pair_options.refine.noise_px = pair.noise_px;
    const MotionEstimate e = EstimateMotion(pair_options, pair);
    const bool refined = e.status == EstimateStatus::kSuccess && e.refine.IsSolutionUsable();
    return CalibrationMotion{e.pose, refined && e.refine.rotation_observable,
                             refined && e.refine.translation_observable, pair.prior};
  };
  std::vector<BatchItem<CalibrationMotion>> items;
  {
    Progress progress("rigel_calibrate_prior", static_cast<int>(input.paths.size()));
    items = RunBatch(options, input.paths, input.first, work, [&] { progress.Step(); });
  }
  std::vector<FramePair> pairs;
  std::vector<CalibrationMotion> motions;
  CalibrationReport report;
  for (BatchItem<CalibrationMotion>& item : items) {
    if (!item.error.empty()) {
      std::cerr << PrintablePath(item.error) << "\n";
      ok = false;
      continue;
    }
    pairs.push_back(std::move(item.pair));
    motions.push_back(item.result);
    report.estimated += item.result.has_rotation ? 1 : 0;
  }
  if (pairs.empty()) return kExitFailed;
  report.pairs = static_cast<int>(pairs.size());
  report.start = Start(pairs);
  if (lines.Plane()) report.plane = CalibratePlane(motions, report.start);
  if (lines.gravity) report.gravity = CalibrateGravity(motions);
  std::vector<std::string> output_flags = OutputFlags();
  output_flags.insert(output_flags.end(), {"output", "in_place"});
  report.options = FlagValues(output_flags);

  // stdout belongs to the machine if it asked for it.
  if (FLAGS_json != "-") {
    std::cout << CalibrationText(report);
    ok = FlushStdout() && ok;
  }
  if (!FLAGS_json.empty()) ok = WriteOutput(FLAGS_json, CalibrationJson(report)) && ok;
  if (!writes) return ok ? kExitDone : kExitFailed;
  const bool any = (report.plane && report.plane->level != CalibrationLevel::kNone) ||
                   (report.gravity && report.gravity->level != CalibrationLevel::kNone);
  if (!any) {
    std::cerr << "nothing is written: nothing that was asked for is observable\n";
    return kExitFailed;
  }
  return WriteFiles(report, lines, pairs) && ok ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  rigel::ParseFlags(rigel::kUsage, &argc, &argv);
  return rigel::Run();
}
