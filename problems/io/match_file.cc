// Reader of match files. It goes once over the whole text and keeps no copy of it: a
// line is split into views, and numbers are converted in place by std::from_chars.
#include "rigel/problems/io/match_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "rigel/core/angles.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

using namespace match_file;

// Directions and quaternions must have unit length to within this.
constexpr double kMaxNormError = 1e-3;

constexpr std::string_view kRowUsage = "I U V J U2 V2 SCORE";
// Words of a row: those of kRowUsage.
constexpr size_t kRowColumns = 7;
// "0 0 0 0 0 0 0\n": bounds what `matches N` can truthfully announce.
constexpr size_t kMinRowBytes = 14;

int FindKeyword(std::string_view word) {
  for (int id = 0; id < kNumKeywords; ++id) {
    if (kKeywords[id].name == word) return id;
  }
  return -1;
}

// Carriage returns count as blanks, which accepts CRLF line ends.
bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

class Parser {
 public:
  Parser(std::string_view text, const std::string& name, std::string* error)
      : text_(text), name_(name), error_(error) {}

  bool Parse(FramePair* pair) {
    std::string what;
    if (!CheckText(&text_, &line_, &what)) {
      return Fail(what + ", expected a match file (UTF-8 text)");
    }
    line_ = 0;
    pos_ = text_.data();
    end_ = pos_ + text_.size();
    pair_.name = name_;
    if (!ParseHeader() || !FinishRig() || !ParseRows()) return false;
    *pair = std::move(pair_);
    return true;
  }

 private:
  struct DeclaredCamera {
    RigCamera camera;
    int64_t line;
  };

  bool Fail(const std::string& message) {
    *error_ = Printable(name_) + (line_ > 0 ? ":" + std::to_string(line_) : "") + ": " + message;
    return false;
  }

  // Splits the next line that has content into columns_. False at the end of the text; line_ is
  // then the last line.
  bool NextLine() {
    while (pos_ != end_) {
      ++line_;
      SplitLine();
      if (num_columns_ > 0) return true;
    }
    return false;
  }

  // The next word of the line at *p, which moves behind it; empty at the end of the line.
  std::string_view NextWord(const char** p) const {
    while (*p != end_ && IsBlank(**p)) ++*p;
    const char* const begin = *p;
    while (*p != end_ && **p != '\n' && !IsBlank(**p)) ++*p;
    return {begin, static_cast<size_t>(*p - begin)};
  }

  // Splits the line at pos_ and moves behind it. A comment has no columns.
  void SplitLine() {
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
  std::string ColumnName(size_t column) const {
    std::string_view rest = usage_;
    for (size_t k = 0; k < column; ++k) rest.remove_prefix(rest.find(' ') + 1);
    return std::string(rest.substr(0, rest.find(' ')));
  }

  bool FailColumn(size_t column, const std::string& expected) {
    return Fail(ColumnName(column) + " is " + Quoted(columns_[column]) + ", expected " + expected);
  }

  bool CheckColumns(size_t expected) {
    if (num_columns_ == expected) return true;
    return Fail(std::to_string(num_columns_) + (num_columns_ == 1 ? " column" : " columns") +
                ", expected " + std::to_string(expected) + " (" + std::string(usage_) + ")");
  }

  bool Number(size_t column, double* value) {
    if (ParseFinite(columns_[column], value)) return true;
    return FailColumn(column, "a finite number");
  }

  bool PositiveNumber(size_t column, double* value) {
    if (!Number(column, value)) return false;
    return *value > 0 || FailColumn(column, "a positive number");
  }

  bool Integer(size_t column, int min, int* value) {
    if (ParseInteger(columns_[column], min, value)) return true;
    return FailColumn(column, "an integer from " + std::to_string(min) + " to " +
                                  std::to_string(std::numeric_limits<int>::max()));
  }

  // The columns column, column + 1, ... as a vector.
  template <int kSize, int kOptions>
  bool Vector(size_t column, Eigen::Matrix<double, kSize, 1, kOptions>* value) {
    for (int k = 0; k < kSize; ++k) {
      if (!Number(column + k, &(*value)[k])) return false;
    }
    return true;
  }

  template <int kSize>
  bool UnitVector(size_t column, const char* what, Eigen::Matrix<double, kSize, 1>* value) {
    if (!Vector(column, value)) return false;
    const double norm = value->norm();
    if (!(std::abs(norm - 1.0) <= kMaxNormError)) {
      return Fail("the " + std::string(what) + " has norm " + FormatShort(norm) +
                  ", expected 1 within 0.001");
    }
    // What is of unit length but for rounding stays as it is, so that written files read back
    // exactly.
    if (std::abs(norm - 1.0) > 1e-14) *value /= norm;
    return true;
  }

  bool Direction(std::optional<Eigen::Vector3d>* value) {
    Eigen::Vector3d v;
    if (!UnitVector(1, "direction", &v)) return false;
    *value = v;
    return true;
  }

  bool Positive(std::optional<double>* value) {
    double number;
    if (!PositiveNumber(1, &number)) return false;
    *value = number;
    return true;
  }

  bool SigmaDeg(std::optional<double>* radians) {
    double degrees;
    if (!PositiveNumber(1, &degrees)) return false;
    // The smallest doubles become zero in radians.
    if (!(DegToRad(degrees) > 0)) return FailColumn(1, "a positive number");
    *radians = DegToRad(degrees);
    return true;
  }

  bool RotationAndVector(size_t column, Pose* pose) {
    Eigen::Vector4d q;
    Eigen::Vector3d t;
    if (!UnitVector(column, "quaternion", &q) || !Vector(column + 4, &t)) return false;
    *pose = Pose::FromQuaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), t);
    return true;
  }

  bool Format() {
    if (columns_[1] == "rigmatch" && columns_[2] == "1") return true;
    return Fail("format " + Quoted(columns_[1]) + " version " + Quoted(columns_[2]) +
                ", expected 'format rigmatch 1', the version that is read here");
  }

  bool Camera() {
    int index;
    if (!Integer(1, 0, &index)) return false;
    if (columns_[2] != "pinhole") {
      return Fail("camera model " + Quoted(columns_[2]) + ", expected 'pinhole'");
    }
    DeclaredCamera declared;
    declared.line = line_;
    PinholeCamera& c = declared.camera.intrinsics;
    Pose body_from_camera;
    if (!PositiveNumber(3, &c.fx) || !PositiveNumber(4, &c.fy) || !Number(5, &c.cx) ||
        !Number(6, &c.cy) || !Integer(7, 1, &c.width) || !Integer(8, 1, &c.height) ||
        !RotationAndVector(9, &body_from_camera)) {
      return false;
    }
    declared.camera.Q = body_from_camera.R;
    declared.camera.s = body_from_camera.t;
    const auto [known, is_new] = cameras_.emplace(index, declared);
    if (is_new) return true;
    return Fail("camera " + std::to_string(index) + " for the second time, expected once (line " +
                std::to_string(known->second.line) + ")");
  }

  bool Time() {
    double t1, t2;
    if (!Number(1, &t1) || !Number(2, &t2)) return false;
    pair_.time1 = t1;
    pair_.time2 = t2;
    return true;
  }

  bool Truth() {
    Pose truth;
    if (!RotationAndVector(1, &truth)) return false;
    pair_.truth = truth;
    return true;
  }

  bool Distance() {
    double distance, sigma;
    if (!Number(1, &distance)) return false;
    if (distance < 0) return FailColumn(1, "a number >= 0");
    if (!PositiveNumber(2, &sigma)) return false;
    pair_.prior.distance = distance;
    pair_.prior.distance_sigma = sigma;
    return true;
  }

  // The name goes into tables and JSON, which must not break on it.
  bool Sequence() {
    const std::string_view name = columns_[1];
    if (std::any_of(name.begin(), name.end(), IsControl) || !IsUtf8(name)) {
      return FailColumn(1, "a name in UTF-8 without control characters");
    }
    pair_.sequence = std::string(name);
    return true;
  }

  bool HeaderLine(KeywordId id) {
    MotionPrior& prior = pair_.prior;
    switch (id) {
      case kFormat:
        return Format();
      case kCamera:
        return Camera();
      case kTime:
        return Time();
      case kTruth:
        return Truth();
      case kGravity1:
        return Direction(&prior.gravity1);
      case kGravity2:
        return Direction(&prior.gravity2);
      case kGravitySigma:
        return SigmaDeg(&prior.gravity_sigma);
      case kAxis:
        return Direction(&prior.axis);
      case kAxisSigma:
        return SigmaDeg(&prior.axis_sigma);
      case kNormal:
        return Direction(&prior.normal);
      case kNormalSigma:
        return SigmaDeg(&prior.normal_sigma);
      case kForward:
        return Direction(&prior.forward);
      case kDistance:
        return Distance();
      case kNoise:
        return Positive(&pair_.noise_px);
      case kSequence:
        return Sequence();
      case kMatches:
        return Integer(1, 0, &num_matches_);
      case kNumKeywords:
        break;
    }
    return false;
  }

  bool ParseHeader() {
    std::array<int64_t, kNumKeywords> seen{};  // line of each keyword
    while (NextLine()) {
      const int id = FindKeyword(columns_[0]);
      if (id < 0) {
        if (seen[kFormat] == 0) {
          return Fail(Quoted(columns_[0]) + ", expected a match file with a line '" +
                      std::string(kKeywords[kFormat].usage) + "'");
        }
        std::string names;
        for (const Keyword& keyword : kKeywords) {
          names += (names.empty() ? "" : ", ") + std::string(keyword.name);
        }
        return Fail("unknown keyword " + Quoted(columns_[0]) + ", expected one of " + names);
      }
      const Keyword& keyword = kKeywords[id];
      if (seen[id] > 0 && id != kCamera) {
        return Fail("'" + std::string(keyword.name) +
                    "' for the second time, expected once (line " + std::to_string(seen[id]) + ")");
      }
      seen[id] = line_;
      usage_ = keyword.usage;
      if (id == kMatches && seen[kFormat] == 0) {
        return Fail("no 'format' line before 'matches', expected '" +
                    std::string(kKeywords[kFormat].usage) + "'");
      }
      if (!CheckColumns(keyword.columns) || !HeaderLine(static_cast<KeywordId>(id))) return false;
      if (id == kMatches) return true;
    }
    if (seen[kFormat] == 0) {
      return Fail("the file ends without a 'format' line, expected '" +
                  std::string(kKeywords[kFormat].usage) + "'");
    }
    return Fail("the file ends without a 'matches' line, expected 'matches N' and N rows");
  }

  bool FinishRig() {
    if (cameras_.empty()) {
      return Fail("no 'camera' line before 'matches', expected one a camera (" +
                  std::string(kKeywords[kCamera].usage) + ")");
    }
    for (const auto& [index, declared] : cameras_) {
      if (index != pair_.rig.size()) {
        line_ = declared.line;
        return Fail("camera " + std::to_string(index) + " without a camera " +
                    std::to_string(pair_.rig.size()) +
                    ", expected cameras numbered 0, 1, ... without a gap");
      }
      pair_.rig.cameras.push_back(declared.camera);
    }
    return true;
  }

  bool CameraOfRow(size_t column, int* camera) {
    if (!Integer(column, 0, camera)) return false;
    if (*camera < pair_.rig.size()) return true;
    return FailColumn(column,
                      "a declared camera (0 to " + std::to_string(pair_.rig.size() - 1) + ")");
  }

  // Takes the next line if it is a plain row, as nearly all lines are, without splitting it
  // first: that is a third faster. Leaves everything else, valid or not, to the general way.
  bool TakePlainRow(Match* m) {
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
    const int num_cameras = pair_.rig.size();
    if (m->camera1 < 0 || m->camera1 >= num_cameras || m->camera2 < 0 ||
        m->camera2 >= num_cameras || !m->pixel1.allFinite() || !m->pixel2.allFinite() ||
        !std::isfinite(m->score)) {
      return false;
    }
    pos_ = p == end_ ? p : p + 1;
    ++line_;
    return true;
  }

  bool ParseRows() {
    usage_ = kRowUsage;
    // N is only believed as far as the text could hold it.
    const size_t num_rows = static_cast<size_t>(num_matches_);
    std::vector<Match>& matches = pair_.matches;
    matches.reserve(std::min(num_rows, static_cast<size_t>(end_ - pos_) / kMinRowBytes + 1));
    for (;;) {
      Match m;
      while (matches.size() < num_rows && TakePlainRow(&m)) matches.push_back(m);
      if (!NextLine()) break;
      if (FindKeyword(columns_[0]) >= 0) {
        return Fail(Quoted(columns_[0]) + " after 'matches', expected header lines before it");
      }
      if (matches.size() == num_rows) {
        return Fail("more rows than 'matches " + std::to_string(num_rows) +
                    "' announces, expected the end of the file");
      }
      if (!CheckColumns(kRowColumns) || !CameraOfRow(0, &m.camera1) || !Vector(1, &m.pixel1) ||
          !CameraOfRow(3, &m.camera2) || !Vector(4, &m.pixel2) || !Number(6, &m.score)) {
        return false;
      }
      matches.push_back(m);
    }
    if (matches.size() == num_rows) return true;
    return Fail("the file ends after " + std::to_string(matches.size()) + " rows, expected " +
                std::to_string(num_rows));
  }

  std::string_view text_;
  const char* pos_ = nullptr;
  const char* end_ = nullptr;
  const std::string& name_;
  std::string* const error_;

  int64_t line_ = 0;  // from 1
  std::string_view usage_;
  std::array<std::string_view, kMaxColumns> columns_;
  size_t num_columns_ = 0;  // may exceed kMaxColumns; the surplus is not kept

  FramePair pair_;
  std::map<int, DeclaredCamera> cameras_;
  int num_matches_ = 0;
};

}  // namespace

std::string PrintablePath(const std::string& path) { return Printable(path); }

bool ParseMatches(std::string_view text, const std::string& name, FramePair* pair,
                  std::string* error) {
  return Parser(text, name, error).Parse(pair);
}

bool ReadMatchFile(const std::string& path, FramePair* pair, std::string* error) {
  InputBytes bytes;
  return ReadInputFile(path, &bytes, error) &&
         ParseMatches(bytes.text(), InputName(path), pair, error);
}

}  // namespace rigel
