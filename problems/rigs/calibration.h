// A calibration file of another tool, as it was read: the rig, and what the file leaves open.
#ifndef RIGEL_PROBLEMS_RIGS_CALIBRATION_H_
#define RIGEL_PROBLEMS_RIGS_CALIBRATION_H_

#include <optional>
#include <string>
#include <vector>

#include "rigel/problems/io/rig_file.h"

namespace rigel {

struct ImageSize {
  int width = 0, height = 0;  // pixels
};

struct CalibrationOptions {
  std::optional<ImageSize> size;  // of all cameras, for formats that do not state it
  int index = 0;                  // which of the rigs of a file that has several
  std::string cameras;            // COLMAP's cameras.txt; empty: the one beside the rig
};

struct Calibration {
  RigFile rig;
  std::string body;                // what the body frame is
  std::vector<std::string> notes;  // what was assumed or left out, one line each
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_CALIBRATION_H_
