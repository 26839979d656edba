// What the readers of calibrations share: files as text, messages with lines, poses from numbers.
//
// Within this folder a reader throws; ReadWith() turns that into a message.
#ifndef RIGEL_PROBLEMS_RIGS_CALIBRATION_TEXT_H_
#define RIGEL_PROBLEMS_RIGS_CALIBRATION_TEXT_H_

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/pose.h"
#include "rigel/core/rig.h"
#include "rigel/problems/io/text_lines.h"
#include "rigel/problems/rigs/calibration.h"

namespace rigel {

// What is wrong with a file, and in which line, from 1; 0 if that is not known.
class LineError : public std::runtime_error {
 public:
  LineError(int line, const std::string& what) : std::runtime_error(what), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

// Bytes. The largest files are tables of nuScenes, of 6 MB.
inline constexpr size_t kMaxCalibrationBytes = size_t{64} << 20;

// Reads a text file and hands it to `parse`, which throws LineError or another std::exception if
// it is not what it should be. False with a message of one line, "path:line: what".
bool ReadWith(const std::string& path, const std::function<void(const std::string& text)>& parse,
              std::string* error);

// The lines of a text that are not blank and do not start with '#', without blanks at their ends.
std::vector<TextLine> LinesOf(const std::string& text);

// The finite number that the word is. Throws LineError with `what`.
double NumberOf(std::string_view word, const std::string& what, int line);
std::vector<double> NumbersOf(const std::vector<std::string_view>& words, const std::string& what,
                              int line);

// The pose of the 12 or 16 numbers of its rows [R t] or [R t; 0 0 0 1]. R is made a rotation from
// one of few digits. Throws LineError with `what` if it mirrors or is none.
Pose PoseOfRows(const std::vector<double>& rows, const std::string& what, int line);

// The same of a quaternion w x y z and a translation.
Pose PoseOfQuaternion(const std::vector<double>& wxyz, const std::vector<double>& t,
                      const std::string& what, int line);

// The width or height of an image from a number. Throws LineError if it is none.
int PixelsOf(double number, const std::string& what, int line);

// Adds a camera, on the body where body_from_camera says.
RigCamera* AddCamera(const std::string& name, const Camera& lens, const Pose& body_from_camera,
                     RigFile* rig);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_CALIBRATION_TEXT_H_
