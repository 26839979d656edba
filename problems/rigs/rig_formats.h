// The calibration formats that can be read, and which of them a file has.
#ifndef RIGEL_PROBLEMS_RIGS_RIG_FORMATS_H_
#define RIGEL_PROBLEMS_RIGS_RIG_FORMATS_H_

#include <string>

#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// The names of the formats, ", " between them.
std::string RigFormatNames();
bool IsRigFormat(const std::string& name);

// Whether files of the format state quaternions, whose order can be mistaken.
bool HasQuaternions(const std::string& format);

// The format of a file or folder, told from what is in it. False with a message of one line if it
// has none of these or cannot be read.
bool DetectRigFormat(const std::string& path, std::string* format, std::string* error);

// Reads a calibration of the format. False with a message of one line, and *calibration unchanged,
// if it is not of that format or its rig is not valid (Rig::IsValid, image sizes).
bool ReadRigCalibration(const std::string& path, const std::string& format,
                        const CalibrationOptions& options, Calibration* calibration,
                        std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_RIG_FORMATS_H_
