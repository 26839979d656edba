// rigel_convert: adds what the vehicle's sensors say to match files.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <gflags/gflags.h>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/problems/io/match_header.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/tools/estimation_messages.h"
#include "rigel/tools/output_directory.h"
#include "rigel/tools/progress.h"
#include "rigel/tools/sensor_flags.h"
#include "rigel/tools/tool.h"

DEFINE_string(matches, "",
              "match files and directories of them, comma separated; each needs its line time");
DEFINE_string(output, "",
              "directory for the new match files, of the same names; created if missing. It must "
              "not hold match files other than those of an earlier run");

namespace rigel {
namespace {

constexpr char kUsage[] =
    "rigel_convert: adds priors from the vehicle's sensors to match files.\n"
    "\n"
    "  rigel_convert --matches=DIR --attitude=imu.csv --odometry=speed.csv --output=NEW\n"
    "  rigel_convert --matches=DIR --gyro=mav0/imu0/data.csv --output=NEW\n"
    "\n"
    "The readings are interpolated to the times of each file. It gets the lines gravity1,\n"
    "gravity2 and gravity_sigma_deg from the attitude, rotation, axis and axis_sigma_deg from the\n"
    "gyro, distance from the odometry, in place of those that it has. Where a sensor says\n"
    "nothing, outside its readings or in a gap of them, its lines are left out. Sigmas are those\n"
    "of the flags, with what is lost between two readings. All other lines stay the same.\n"
    "docs/formats.md has the CSV files, docs/sensors.md what is left out.\n";

constexpr char kMark[] = "# rigel_convert";

bool CheckFlags(std::string* error) {
  if (FLAGS_matches.empty()) return Refuse("--matches is missing: name match files", error);
  if (FLAGS_output.empty()) return Refuse("--output is missing: name a directory", error);
  if (!HasSensors()) {
    return Refuse("nothing to add: name a file by --attitude, --odometry or --gyro", error);
  }
  return CheckSensorFlags(error);
}

// Writes one file. False with a message if it cannot be read or written, or has no times.
bool Convert(const std::string& path, const std::string& target, SensorSource* sensors,
             std::string* error) {
  FramePair pair;
  if (!ReadMatchFile(path, &pair, error)) return false;
  if (!pair.time1 || !pair.time2) {
    *error = PrintablePath(path) + ": not written, it has no line 'time T1 T2'";
    return false;
  }
  std::map<std::string, std::string> lines = sensors->Lines(pair);
  lines[kMark] = std::string(kMark) + " added lines from sensors";
  std::string text;
  return ReadWithHeaderLines(path, lines, &text, error) &&
         WriteWholeFile(target, MatchFileBytes(target, text), error);
}

int Run() {
  std::string error;
  if (!CheckFlags(&error)) return UsageError(error);
  std::vector<std::string> errors, notes;
  const std::vector<std::string> paths = ListMatchFiles(FLAGS_matches, &errors, &notes);
  for (const std::string& note : notes) std::cerr << note << "\n";
  for (const std::string& message : errors) std::cerr << message << "\n";
  if (paths.empty()) return Failure("nothing to read in " + PrintablePath(FLAGS_matches));
  const bool all_there = errors.empty();
  for (const std::string& path : paths) {
    if (path == "-") return UsageError("--matches=-: stdin has no name, expected files");
  }
  const std::vector<std::string> targets =
      CopyTargets(paths, FLAGS_output, kMark, "name another directory", &error);
  SensorSource sensors;
  if (targets.empty() || !sensors.Load(&error) || !MakeDirectory(FLAGS_output, &error)) {
    return Failure(error);
  }

  const auto replaced = std::count_if(targets.begin(), targets.end(), [](const std::string& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
  });
  if (replaced > 0) {
    std::cerr << replaced << " files of an earlier run in " << PrintablePath(FLAGS_output)
              << " are replaced, with the lines of that run\n";
  }

  errors.clear();
  auto progress = std::make_unique<Progress>(ProgramName(), static_cast<int>(paths.size()));
  for (size_t k = 0; k < paths.size(); ++k) {
    if (!Convert(paths[k], targets[k], &sensors, &error)) errors.push_back(error);
    progress->Step();
  }
  progress.reset();
  ReportGrouped(errors, paths);
  sensors.Report();
  const size_t written = paths.size() - errors.size();
  std::cerr << "wrote " << written << (written == 1 ? " match file" : " match files") << " to "
            << PrintablePath(FLAGS_output) << "\n";
  return ExitCode(all_there && errors.empty());
}

}  // namespace
}  // namespace rigel

int main(int argc, char** argv) {
  return rigel::RunProgram(argc, argv, rigel::kUsage, &rigel::Run);
}
