#include "rigel/problems/io/header_lines.h"

#include <algorithm>
#include <vector>

#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

using namespace match_file;  // NOLINT(google-build-using-namespace): the words of the format

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

// The words of a camera's line, with the names of the model's parameters.
std::string UsageOf(CameraModel model) {
  std::string usage = std::string("camera K ") + CameraModelName(model) + " ";
  for (const char* c = CameraParameterNames(model); *c != 0; ++c) {
    usage += *c >= 'a' && *c <= 'z' ? static_cast<char>(*c - 'a' + 'A') : *c;
  }
  return usage + " WIDTH HEIGHT QW QX QY QZ SX SY SZ";
}

bool IsDeclared(int index, const Rig& rig, int64_t line, MatchLines* lines) {
  if (index < rig.size()) return true;
  return lines->FailAt(line, "K is '" + std::to_string(index) +
                                 "', expected a declared camera (0 to " +
                                 std::to_string(rig.size() - 1) + ")");
}

}  // namespace

bool CameraLines::ReadCamera(MatchLines* lines) {
  constexpr size_t kLeast = 3;  // words: with the model, which says how many there are
  if (lines->num_columns() < kLeast) {
    return lines->Fail("no camera model, expected '" + std::string(kCameraLine.usage) + "'");
  }
  int index;
  if (!lines->Integer(1, 0, &index)) return false;
  Declared declared;
  declared.line = lines->line();
  Camera& c = declared.camera.intrinsics;
  if (!ParseCameraModel(lines->Column(2), &c.model)) {
    return lines->Fail("camera model " + Quoted(lines->Column(2)) + ", expected one of " +
                       CameraModelNames());
  }
  const size_t num_parameters = NumCameraParameters(c.model);
  usage_ = UsageOf(c.model);
  lines->SetUsage(usage_);
  if (!lines->CheckColumns(kCameraColumns + num_parameters)) return false;
  std::string_view names = CameraParameterNames(c.model);
  for (size_t k = 0; k < num_parameters; ++k) {
    const bool is_focal_length = names.front() == 'f';
    double* const value = &c.parameters[k];
    if (!(is_focal_length ? lines->PositiveNumber(3 + k, value) : lines->Number(3 + k, value))) {
      return false;
    }
    names.remove_prefix(std::min(names.find(' ') + 1, names.size()));
  }
  std::string what;
  if (!c.IsValid(&what)) return lines->Fail(what);
  const size_t next = 3 + num_parameters;
  Pose body_from_camera;
  if (!lines->Integer(next, 1, &c.width) || !lines->Integer(next + 1, 1, &c.height) ||
      !lines->RotationAndVector(next + 2, &body_from_camera)) {
    return false;
  }
  declared.camera.Q = body_from_camera.R;
  declared.camera.s = body_from_camera.t;
  return Declare(index, declared, "camera", lines, &cameras_);
}

bool CameraLines::Declare(int index, const Declared& declared, const char* what, MatchLines* lines,
                          DeclaredCameras* cameras) {
  const auto [known, is_new] = cameras->emplace(index, declared);
  if (is_new) return true;
  return lines->Fail(std::string(what) + " " + std::to_string(index) +
                     " for the second time, expected once (line " +
                     std::to_string(known->second.line) + ")");
}

bool CameraLines::ReadSigma(MatchLines* lines) {
  constexpr size_t kColumns = 4;  // without the one that may be absent
  int index;
  Declared declared;
  declared.line = lines->line();
  RigCamera& camera = declared.camera;
  const bool has_focal = lines->num_columns() == kColumns + 1;
  if ((!has_focal && !lines->CheckColumns(kColumns)) || !lines->Integer(1, 0, &index) ||
      !lines->SigmaDeg(2, &camera.rotation_sigma) ||
      !lines->PositiveNumber(3, &camera.position_sigma) ||
      (has_focal && !lines->PositiveNumber(kColumns, &camera.focal_sigma))) {
    return false;
  }
  return Declare(index, declared, "camera_sigma", lines, &sigmas_);
}

bool CameraLines::ReadTime(MatchLines* lines) {
  int index;
  Declared declared;
  declared.line = lines->line();
  if (!lines->Integer(1, 0, &index) || !lines->Number(2, &declared.camera.time_offset)) {
    return false;
  }
  return Declare(index, declared, "camera_time", lines, &times_);
}

bool CameraLines::Finish(std::string_view rows, MatchLines* lines, Rig* rig) const {
  if (cameras_.empty()) {
    return lines->Fail("no 'camera' line before '" + std::string(rows) +
                       "', expected one a camera (" + std::string(kCameraLine.usage) + ")");
  }
  for (const auto& [index, declared] : cameras_) {
    if (index != rig->size()) {
      return lines->FailAt(declared.line,
                           "camera " + std::to_string(index) + " without a camera " +
                               std::to_string(rig->size()) +
                               ", expected cameras numbered 0, 1, ... without a gap");
    }
    rig->cameras.push_back(declared.camera);
  }
  // These lines may be before those of their cameras.
  for (const auto& [index, declared] : sigmas_) {
    if (!IsDeclared(index, *rig, declared.line, lines)) return false;
    RigCamera& camera = rig->cameras[index];
    camera.rotation_sigma = declared.camera.rotation_sigma;
    camera.position_sigma = declared.camera.position_sigma;
    camera.focal_sigma = declared.camera.focal_sigma;
  }
  for (const auto& [index, declared] : times_) {
    if (!IsDeclared(index, *rig, declared.line, lines)) return false;
    rig->cameras[index].time_offset = declared.camera.time_offset;
  }
  return true;
}

void CameraLines::Write(const Rig& rig, MatchText* f) {
  for (int k = 0; k < rig.size(); ++k) {
    const RigCamera& camera = rig.cameras[k];
    const Camera& c = camera.intrinsics;
    f->Word(kCameraLine.name).Number(k).Word(CameraModelName(c.model));
    for (int i = 0; i < NumCameraParameters(c.model); ++i) f->Number(c.parameters[i]);
    f->Number(c.width).Number(c.height);
    f->Quaternion(camera.Q).Vector(camera.s).EndLine();
  }
  for (int k = 0; k < rig.size(); ++k) {
    const RigCamera& camera = rig.cameras[k];
    if (camera.rotation_sigma == 0 && camera.position_sigma == 0 && camera.focal_sigma == 0) {
      continue;
    }
    f->Word(kCameraSigmaLine.name).Number(k);
    f->SigmaDeg(camera.rotation_sigma).Number(camera.position_sigma);
    if (camera.focal_sigma != 0) f->Number(camera.focal_sigma);
    f->EndLine();
  }
  for (int k = 0; k < rig.size(); ++k) {
    if (rig.cameras[k].time_offset == 0) continue;
    f->Word(kCameraTimeLine.name).Number(k).Number(rig.cameras[k].time_offset).EndLine();
  }
}

int HeaderLines::FindKeyword(std::string_view word) const {
  for (int id = 0; id < num_keywords_; ++id) {
    if (keywords_[id].name == word) return id;
  }
  return -1;
}

// Always false.
bool HeaderLines::UnknownKeyword(bool has_format) {
  if (!has_format) {
    return Fail(Quoted(Column(0)) + ", expected " + what_ + " with a line '" +
                std::string(keywords_[0].usage) + "'");
  }
  std::string names;
  for (int id = 0; id < num_keywords_; ++id) {
    names += (names.empty() ? "" : ", ") + std::string(keywords_[id].name);
  }
  return Fail("unknown keyword " + Quoted(Column(0)) + ", expected one of " + names);
}

bool HeaderLines::Format() {
  const std::string usage(keywords_[0].usage);
  if ("format " + std::string(Column(1)) + " " + std::string(Column(2)) == usage) return true;
  return Fail("format " + Quoted(Column(1)) + " version " + Quoted(Column(2)) + ", expected '" +
              usage + "', the version that is read here");
}

bool HeaderLines::ReadHeader() {
  if (!Begin(what_)) return false;
  const int last = num_keywords_ - 1;
  const std::string rows(keywords_[last].name), format(keywords_[0].usage);
  std::vector<int64_t> seen(num_keywords_, 0);  // line of each keyword
  while (NextLine()) {
    const int id = FindKeyword(Column(0));
    if (id < 0) return UnknownKeyword(seen[0] > 0);
    const Keyword& keyword = keywords_[id];
    if (seen[id] > 0 && !keyword.repeats) {
      return Fail("'" + std::string(keyword.name) + "' for the second time, expected once (line " +
                  std::to_string(seen[id]) + ")");
    }
    seen[id] = line();
    SetUsage(keyword.usage);
    if (id == last && seen[0] == 0) {
      return Fail("no 'format' line before '" + rows + "', expected '" + format + "'");
    }
    if (keyword.columns != kAnyColumns && !CheckColumns(keyword.columns)) return false;
    if (!(id == 0 ? Format() : HeaderLine(id))) return false;
    if (id == last) return true;
  }
  if (seen[0] == 0) {
    return Fail("the file ends without a 'format' line, expected '" + format + "'");
  }
  return Fail("the file ends without a '" + rows + "' line, expected '" +
              std::string(keywords_[last].usage) + "' and N rows");
}

bool HeaderLines::CheckRow(size_t row, size_t num_rows) {
  const std::string rows(keywords_[num_keywords_ - 1].name);
  if (FindKeyword(Column(0)) >= 0) {
    return Fail(Quoted(Column(0)) + " after '" + rows + "', expected header lines before it");
  }
  if (row < num_rows) return true;
  return Fail("more rows than '" + rows + " " + std::to_string(num_rows) +
              "' announces, expected the end of the file");
}

bool HeaderLines::CheckNumRows(size_t rows, size_t num_rows) {
  if (rows == num_rows) return true;
  return Fail("the file ends after " + std::to_string(rows) + " rows, expected " +
              std::to_string(num_rows));
}

bool HeaderLines::Direction(std::optional<Eigen::Vector3d>* value, size_t column) {
  Eigen::Vector3d v;
  if (!UnitVector(column, "direction", &v)) return false;
  *value = v;
  return true;
}

bool HeaderLines::Positive(std::optional<double>* value) {
  double number;
  if (!PositiveNumber(1, &number)) return false;
  *value = number;
  return true;
}

bool HeaderLines::SigmaDeg(std::optional<double>* radians) {
  double sigma;
  if (!SigmaDeg(1, &sigma)) return false;
  *radians = sigma;
  return true;
}

bool HeaderLines::Distance(size_t column, double* distance, double* sigma) {
  if (!Number(column, distance)) return false;
  if (*distance < 0) return FailColumn(column, "a number >= 0");
  return PositiveNumber(column + 1, sigma);
}

// The name goes into tables and JSON, which must not break on it.
bool HeaderLines::Sequence(std::string* name) {
  const std::string_view word = Column(1);
  if (std::any_of(word.begin(), word.end(), IsControl) || !IsUtf8(word)) {
    return FailColumn(1, "a name in UTF-8 without control characters");
  }
  *name = std::string(word);
  return true;
}

}  // namespace rigel
