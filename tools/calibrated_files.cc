#include "rigel/tools/calibrated_files.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_header.h"
#include "rigel/problems/io/table.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/tools/output_directory.h"
#include "rigel/tools/tool.h"

namespace rigel {
namespace {

// The lines that are calibrated.
std::vector<std::string> Names(const CalibratedLines& lines) {
  std::vector<std::string> names;
  if (lines.normal) names.emplace_back("normal");
  if (lines.axis) names.emplace_back("axis");
  if (lines.gravity) names.emplace_back("gravity");
  return names;
}

bool SameMark(const std::vector<std::string>& paths, const std::string& line, std::string* error) {
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
  return Refuse(
      "--lines=" + line + ": " + what + " (line '" + CalibrationMark(line) +
          "'), as an interrupted run leaves them; begin again with the files as they were before",
      error);
}

// All marks of calibrations in a file.
std::string Marks(const std::string& path) {
  std::string marks;
  for (const char* line : {"normal", "axis", "gravity"}) {
    marks += FindHeaderComment(path, CalibrationMark(line)) + "\n";
  }
  return marks;
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

// The new text of each file, staged beside its target.
bool Stage(const CalibrationReport& report, const CalibratedLines& lines,
           const std::map<std::string, std::string>& marks, const std::vector<FramePair>& pairs,
           const std::vector<std::string>& targets, StagedFiles* files, std::string* error) {
  for (size_t k = 0; k < pairs.size(); ++k) {
    std::map<std::string, std::string> changed = marks;
    if (report.plane) changed.merge(PlaneLines(*report.plane, lines.normal, lines.axis));
    if (report.gravity) changed.merge(GravityLines(*report.gravity, pairs[k].prior));
    std::string text;
    if (!ReadWithHeaderLines(pairs[k].name, changed, &text, error) ||
        !files->Add(targets[k], MatchFileBytes(targets[k], text), error)) {
      return false;
    }
  }
  return true;
}

bool Fail(const std::string& message) {
  std::cerr << message << "\n";
  return false;
}

}  // namespace

bool ParseLines(const std::string& text, CalibratedLines* lines) {
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

bool SameMarks(const std::vector<std::string>& paths, const CalibratedLines& lines,
               std::string* error) {
  const std::vector<std::string> names = Names(lines);
  return std::all_of(names.begin(), names.end(),
                     [&](const std::string& line) { return SameMark(paths, line, error); });
}

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
  std::cerr << "finished an interrupted run: replaced " << finished << " of " << paths.size()
            << " files\n";
}

std::vector<std::string> Targets(const std::vector<std::string>& paths,
                                 const std::string& directory, std::string* error) {
  return directory.empty() ? paths
                           : CopyTargets(paths, directory, "# rigel_calibrate_prior",
                                         "use --in_place for that", error);
}

bool WriteCalibratedFiles(const CalibrationReport& report, const CalibratedLines& lines,
                          const std::vector<FramePair>& pairs, const std::string& directory) {
  const bool in_place = directory.empty();
  std::vector<std::string> paths;
  for (const FramePair& pair : pairs) paths.push_back(pair.name);
  std::string error;
  const std::vector<std::string> targets = Targets(paths, directory, &error);
  if (targets.empty() || (!in_place && !MakeDirectory(directory, &error))) return Fail(error);
  const std::map<std::string, std::string> marks = MarkLines(report, lines.normal, lines.axis);
  const std::string count = std::to_string(pairs.size());
  if (in_place && AlreadyCalibrated(marks, pairs)) {
    std::cerr << "nothing is written: all " << count << " files are calibrated so already\n";
    return true;
  }
  StagedFiles files;
  if (!Stage(report, lines, marks, pairs, targets, &files, &error)) {
    return Fail(error + "; no file is written");
  }
  if (!files.Commit(&error)) {
    return Fail(error + "; " + std::to_string(files.committed()) + " of " + count +
                " files are written");
  }
  std::cerr << "wrote " << count << (pairs.size() == 1 ? " match file" : " match files")
            << (in_place ? " in place" : " to " + PrintablePath(directory)) << "\n";
  return true;
}

}  // namespace rigel
