#include "rigel/problems/rigs/calibration_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/LU>

#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/rotation_check.h"

namespace rigel {

bool ReadWith(const std::string& path, const std::function<void(const std::string& text)>& parse,
              std::string* error) {
  InputBytes bytes;
  if (!ReadInputFile(path, &bytes, error, kMaxCalibrationBytes)) return false;
  std::string_view text = bytes.text();
  int64_t line = 0;
  std::string what;
  if (!CheckText(&text, &line, &what)) {
    what += ", expected UTF-8 text";
  } else {
    line = 0;
    try {
      parse(std::string(text));
      return true;
    } catch (const LineError& exception) {
      line = exception.line();
      what = exception.what();
    } catch (const std::exception& exception) {
      what = ExceptionMessage(exception);
    }
  }
  *error = Printable(InputName(path) + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what);
  return false;
}

std::vector<TextLine> LinesOf(const std::string& text) {
  std::vector<TextLine> lines;
  int number = 0;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = TrimBlanks(std::string_view(text).substr(begin, end - begin));
    ++number;
    if (!line.empty() && line[0] != '#') lines.push_back({number, std::string(line)});
    begin = end + 1;
  }
  return lines;
}

double NumberOf(std::string_view word, const std::string& what, int line) {
  double number;
  if (!ParseFinite(word, &number)) {
    throw LineError(line, what + " is " + Quoted(word) + ", expected a finite number");
  }
  return number;
}

std::vector<double> NumbersOf(const std::vector<std::string_view>& words, const std::string& what,
                              int line) {
  std::vector<double> numbers;
  for (size_t k = 0; k < words.size(); ++k) {
    numbers.push_back(NumberOf(words[k], what + ": number " + std::to_string(k + 1), line));
  }
  return numbers;
}

Pose PoseOfRows(const std::vector<double>& rows, const std::string& what, int line) {
  constexpr size_t kThreeRows = 12, kFourRows = 16;  // numbers of [R t], and with 0 0 0 1
  if (rows.size() != kThreeRows && rows.size() != kFourRows) {
    throw LineError(line, what + " has " + std::to_string(rows.size()) +
                              " numbers, expected the rows of a 4x4 matrix [R t; 0 0 0 1]");
  }
  Pose pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.R(r, c) = rows[4 * r + c];
    pose.t(r) = rows[4 * r + 3];
  }
  if (!pose.AllFinite()) throw LineError(line, what + ": expected finite numbers");
  if (rows.size() == kFourRows && std::vector<double>(rows.begin() + kThreeRows, rows.end()) !=
                                      std::vector<double>{0, 0, 0, 1}) {
    throw LineError(line, what + ": the last row is not 0 0 0 1, expected a rigid motion");
  }
  if (IsNearRotation(-pose.R)) {
    throw LineError(line, what +
                              ": the rotation is left-handed, it mirrors; expected a right-handed "
                              "one, of determinant 1");
  }
  if (!IsNearRotation(pose.R)) {
    throw LineError(line, what + ": R is not a rotation, expected orthonormal rows to 0.001");
  }
  pose.R = Eigen::Quaterniond(pose.R).normalized().toRotationMatrix();
  return pose;
}

Pose PoseOfQuaternion(const std::vector<double>& wxyz, const std::vector<double>& t,
                      const std::string& what, int line) {
  if (wxyz.size() != 4 || t.size() != 3) {
    throw LineError(line, what + ": expected a quaternion w x y z and a translation x y z");
  }
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(q.norm() - 1.0) <= kMaxRotationError)) {
    throw LineError(line, what +
                              ": the quaternion has a norm that is not 1, expected one within "
                              "0.001 of it");
  }
  return Pose::FromQuaternion(q, {t[0], t[1], t[2]});
}

int PixelsOf(double number, const std::string& what, int line) {
  constexpr double kMaxSide = 1e6;  // pixels: more is a mistake, and still fits an int
  if (!(number >= 1 && number <= kMaxSide) || number != std::floor(number)) {
    throw LineError(line, what + ": expected an image's width and height in pixels");
  }
  return static_cast<int>(number);
}

RigCamera* AddCamera(const std::string& name, const Camera& lens, const Pose& body_from_camera,
                     RigFile* rig) {
  RigCamera camera;
  camera.intrinsics = lens;
  camera.Q = body_from_camera.R;
  camera.s = body_from_camera.t;
  rig->rig.cameras.push_back(camera);
  rig->camera_names.push_back(name);
  rig->camera_images.emplace_back();
  return &rig->rig.cameras.back();
}

}  // namespace rigel
