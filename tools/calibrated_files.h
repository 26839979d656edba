// Match files with calibrated lines: copies in another directory, or the files themselves.
//
// Each calibrated file has a comment line, its mark, that says which of its lines were calibrated
// and how far they were turned.
#ifndef RIGEL_TOOLS_CALIBRATED_FILES_H_
#define RIGEL_TOOLS_CALIBRATED_FILES_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/problems/calibration/calibration_report.h"

namespace rigel {

// Lines of a match file.
struct CalibratedLines {
  bool normal = false;
  bool axis = false;
  bool gravity = false;

  bool Plane() const { return normal || axis; }
};

// Comma separated: normal, axis, gravity. False if there is another or none.
bool ParseLines(const std::string& text, CalibratedLines* lines);

// Whether each of `lines` was calibrated by the same run in all files, or in none. An interrupted
// run leaves a part, and with it no calibration would be that of all. False with a message if not.
bool SameMarks(const std::vector<std::string>& paths, const CalibratedLines& lines,
               std::string* error);

// A run in place that was killed while its files took their places had written all of them: those
// that did not get there yet do it now. Says so on stderr.
void FinishInterruptedRun(const std::vector<std::string>& paths);

// Where each file is written to: in `directory`, or in place if that is empty. Empty with a message
// if two would be one file, one its own source, or the directory holds match files that are not of
// this run or not the program's work.
std::vector<std::string> Targets(const std::vector<std::string>& paths,
                                 const std::string& directory, std::string* error);

// Writes the calibrated lines that `report` has to files of the `pairs`, whose names are the paths
// of the sources. All other lines stay as they are. All files are written before the first takes
// its place. Says on stderr what was done; false if that is not all.
bool WriteCalibratedFiles(const CalibrationReport& report, const CalibratedLines& lines,
                          const std::vector<FramePair>& pairs, const std::string& directory);

}  // namespace rigel

#endif  // RIGEL_TOOLS_CALIBRATED_FILES_H_
