#include "rigel/problems/sensors/mounting.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/rotation_check.h"
#include "rigel/problems/io/text_lines.h"

namespace rigel {
namespace {

// False if a word is no number.
bool ParseNumbers(std::string text, std::vector<double>* numbers) {
  std::replace(text.begin(), text.end(), ',', ' ');
  for (const std::string_view word : SplitAtBlanks(text)) {
    numbers->emplace_back();
    if (!ParseFinite(word, &numbers->back())) return false;
  }
  return true;
}

}  // namespace

bool ReadMounting(const std::string& text, Eigen::Matrix3d* rotation, std::string* error) {
  std::vector<double> n;
  std::string name = Quoted(text);
  if (!ParseNumbers(text, &n)) {
    n.clear();
    name = Printable(text);
    std::vector<TextLine> lines;
    if (!ReadTextLines(text, &lines, error)) return false;
    for (const TextLine& line : lines) {
      if (ParseNumbers(line.text, &n)) continue;
      *error = Where(text, line) + ": " + Quoted(line.text) + ", expected numbers";
      return false;
    }
  }
  Eigen::Matrix3d R;
  if (n.size() == 4) {
    const Eigen::Quaterniond q(n[0], n[1], n[2], n[3]);
    if (std::abs(q.norm() - 1) <= kMaxRotationError) {
      *rotation = q.normalized().toRotationMatrix();
      return true;
    }
  } else if (n.size() == 9) {
    R << n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8];
    if (IsNearRotation(R)) {
      *rotation = Eigen::Quaterniond(R).normalized().toRotationMatrix();
      return true;
    }
  }
  *error = name + ": " + std::to_string(n.size()) +
           " numbers, expected a unit quaternion w,x,y,z or the nine of a rotation matrix, row by "
           "row";
  return false;
}

}  // namespace rigel
