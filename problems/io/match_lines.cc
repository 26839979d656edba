#include "rigel/problems/io/match_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "rigel/core/angles.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

using match_file::kMaxColumns;

// Directions and quaternions must have unit length to within this.
constexpr double kMaxNormError = 1e-3;
// A norm that is off by less is 1 but for rounding. It stays as it is, so that what was written is
// read back exactly.
constexpr double kUnitRounding = 1e-14;

// Carriage returns count as blanks, which accepts CRLF line ends.
bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

}  // namespace

bool MatchLines::Begin(const char* what) {
  std::string wrong;
  int64_t bad_line;
  if (!CheckText(&text_, &bad_line, &wrong)) {
    return FailAt(bad_line, wrong + ", expected " + what + " (UTF-8 text)");
  }
  pos_ = text_.data();
  end_ = pos_ + text_.size();
  return true;
}

bool MatchLines::FailAt(int64_t line, const std::string& message) {
  *error_ = Printable(name_) + (line > 0 ? ":" + std::to_string(line) : "") + ": " + message;
  return false;
}

bool MatchLines::NextLine() {
  while (pos_ != end_) {
    ++line_;
    SplitLine();
    if (num_columns_ > 0) return true;
  }
  return false;
}

// The next word of the line at *p, which moves behind it; empty at the end of the line.
std::string_view MatchLines::NextWord(const char** p) const {
  while (*p != end_ && IsBlank(**p)) ++*p;
  const char* const begin = *p;
  while (*p != end_ && **p != '\n' && !IsBlank(**p)) ++*p;
  return {begin, static_cast<size_t>(*p - begin)};
}

// Splits the line at pos_ and moves behind it. A comment has no columns.
void MatchLines::SplitLine() {
  const char* p = pos_;
  num_columns_ = 0;
  for (std::string_view word = NextWord(&p); !word.empty(); word = NextWord(&p)) {
    if (num_columns_ == 0 && word[0] == '#') {
      p = std::find(p, end_, '\n');
      break;
    }
    if (num_columns_ < kMaxColumns) columns_[num_columns_] = word;
    ++num_columns_;
  }
  pos_ = p == end_ ? p : p + 1;
}

// The usage's word for a column, so that messages name what the format names.
std::string MatchLines::ColumnName(size_t column) const {
  std::string_view rest = usage_;
  for (size_t k = 0; k < column; ++k) rest.remove_prefix(rest.find(' ') + 1);
  return std::string(rest.substr(0, rest.find(' ')));
}

bool MatchLines::FailColumn(size_t column, const std::string& expected) {
  return Fail(ColumnName(column) + " is " + Quoted(columns_[column]) + ", expected " + expected);
}

bool MatchLines::CheckColumns(size_t expected) {
  if (num_columns_ == expected) return true;
  return Fail(std::to_string(num_columns_) + (num_columns_ == 1 ? " column" : " columns") +
              ", expected " + std::to_string(expected) + " (" + std::string(usage_) + ")");
}

bool MatchLines::Number(size_t column, double* value) {
  if (ParseFinite(columns_[column], value)) return true;
  return FailColumn(column, "a finite number");
}

bool MatchLines::PositiveNumber(size_t column, double* value) {
  if (!Number(column, value)) return false;
  return *value > 0 || FailColumn(column, "a positive number");
}

bool MatchLines::Integer(size_t column, int min, int* value) {
  if (ParseInteger(columns_[column], min, value)) return true;
  return FailColumn(column, "an integer from " + std::to_string(min) + " to " +
                                std::to_string(std::numeric_limits<int>::max()));
}

bool MatchLines::SigmaDeg(size_t column, double* radians) {
  double degrees;
  if (!PositiveNumber(column, &degrees)) return false;
  // The smallest doubles become zero in radians.
  if (!(DegToRad(degrees) > 0)) return FailColumn(column, "a positive number");
  *radians = DegToRad(degrees);
  return true;
}

bool MatchLines::RotationAndVector(size_t column, Pose* pose) {
  Eigen::Vector4d q;
  Eigen::Vector3d t;
  if (!UnitVector(column, "quaternion", &q) || !Vector(column + 4, &t)) return false;
  *pose = Pose::FromQuaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), t);
  return true;
}

bool MatchLines::CheckUnit(const char* what, double norm) {
  if (std::abs(norm - 1.0) <= kMaxNormError) return true;
  return Fail("the " + std::string(what) + " has norm " + FormatShort(norm) +
              ", expected 1 within 0.001");
}

bool MatchLines::IsRounding(double norm) { return !(std::abs(norm - 1.0) > kUnitRounding); }

bool MatchLines::TakePlainRow(int num_cameras, Match* m) {
  const char* p = pos_;
  const auto column = [&](auto* value) {
    while (p != end_ && IsBlank(*p)) ++p;
    const auto [stop, status] = std::from_chars(p, end_, *value);
    p = stop;
    return status == std::errc() && (p == end_ || IsBlank(*p) || *p == '\n');
  };
  if (!column(&m->camera1) || !column(&m->pixel1[0]) || !column(&m->pixel1[1]) ||
      !column(&m->camera2) || !column(&m->pixel2[0]) || !column(&m->pixel2[1]) ||
      !column(&m->score)) {
    return false;
  }
  while (p != end_ && IsBlank(*p)) ++p;
  if (p != end_ && *p != '\n') return false;
  if (m->camera1 < 0 || m->camera1 >= num_cameras || m->camera2 < 0 || m->camera2 >= num_cameras ||
      !m->pixel1.allFinite() || !m->pixel2.allFinite() || !std::isfinite(m->score)) {
    return false;
  }
  pos_ = p == end_ ? p : p + 1;
  ++line_;
  return true;
}

}  // namespace rigel
