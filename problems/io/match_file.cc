#include "rigel/problems/io/match_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "rigel/core/angles.h"
#include "rigel/problems/io/gzip.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/match_lines.h"
#include "rigel/problems/io/match_rows.h"
#include "rigel/problems/io/match_text.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {
namespace {

using namespace match_file;  // NOLINT(google-build-using-namespace): the words that this file reads

constexpr std::string_view kSuffix = ".matches";
constexpr std::string_view kCompressed = ".gz";

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// "0 0 0 0 0 0 0\n": bounds what `matches N` can truthfully announce.
constexpr size_t kMinRowBytes = 14;

int FindKeyword(std::string_view word) {
  for (int id = 0; id < kNumKeywords; ++id) {
    if (kKeywords[id].name == word) return id;
  }
  return -1;
}

bool IsControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

// The words of a camera's line, with the names of the model's parameters.
std::string UsageOf(CameraModel model) {
  std::string usage = std::string("camera K ") + CameraModelName(model) + " ";
  for (const char* c = CameraParameterNames(model); *c != 0; ++c) {
    usage += *c >= 'a' && *c <= 'z' ? static_cast<char>(*c - 'a' + 'A') : *c;
  }
  return usage + " WIDTH HEIGHT QW QX QY QZ SX SY SZ";
}

class Parser : private MatchLines {
 public:
  Parser(std::string_view text, const std::string& name, std::string* error)
      : MatchLines(text, name, error) {
    pair_.name = name;
  }

  bool Parse(FramePair* pair) {
    if (!Begin() || !ParseHeader() || !FinishRig() || !ParseRows()) return false;
    *pair = std::move(pair_);
    return true;
  }

 private:
  // What lines say of cameras, by their numbers. All but the line is of one kind of line.
  struct DeclaredCamera {
    RigCamera camera;
    int64_t line;
  };
  using DeclaredCameras = std::map<int, DeclaredCamera>;

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

  bool SigmaDeg(size_t column, double* radians) {
    double degrees;
    if (!PositiveNumber(column, &degrees)) return false;
    // The smallest doubles become zero in radians.
    if (!(DegToRad(degrees) > 0)) return FailColumn(column, "a positive number");
    *radians = DegToRad(degrees);
    return true;
  }

  bool SigmaDeg(std::optional<double>* radians) {
    double sigma;
    if (!SigmaDeg(1, &sigma)) return false;
    *radians = sigma;
    return true;
  }

  bool RotationAndVector(size_t column, Pose* pose) {
    Eigen::Vector4d q;
    Eigen::Vector3d t;
    if (!UnitVector(column, "quaternion", &q) || !Vector(column + 4, &t)) return false;
    *pose = Pose::FromQuaternion(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), t);
    return true;
  }

  // Checked only: nothing that is estimated uses it yet.
  bool Rotation() {
    Eigen::Vector4d q;
    double sigma;
    return UnitVector(1, "quaternion", &q) && SigmaDeg(5, &sigma);
  }

  bool Format() {
    if (Column(1) == "rigmatch" && Column(2) == "1") return true;
    return Fail("format " + Quoted(Column(1)) + " version " + Quoted(Column(2)) +
                ", expected 'format rigmatch 1', the version that is read here");
  }

  bool Camera() {
    constexpr size_t kLeast = 3;  // words: with the model, which says how many there are
    if (num_columns() < kLeast) {
      return Fail("no camera model, expected '" + std::string(kKeywords[kCamera].usage) + "'");
    }
    int index;
    if (!Integer(1, 0, &index)) return false;
    DeclaredCamera declared;
    declared.line = line();
    rigel::Camera& c = declared.camera.intrinsics;
    if (!ParseCameraModel(Column(2), &c.model)) {
      return Fail("camera model " + Quoted(Column(2)) + ", expected one of " + CameraModelNames());
    }
    const size_t num_parameters = NumCameraParameters(c.model);
    camera_usage_ = UsageOf(c.model);
    SetUsage(camera_usage_);
    if (!CheckColumns(kCameraColumns + num_parameters)) return false;
    std::string_view names = CameraParameterNames(c.model);
    for (size_t k = 0; k < num_parameters; ++k) {
      const bool is_focal_length = names.front() == 'f';
      double* const value = &c.parameters[k];
      if (!(is_focal_length ? PositiveNumber(3 + k, value) : Number(3 + k, value))) return false;
      names.remove_prefix(std::min(names.find(' ') + 1, names.size()));
    }
    std::string what;
    if (!c.IsValid(&what)) return Fail(what);
    const size_t next = 3 + num_parameters;
    Pose body_from_camera;
    if (!Integer(next, 1, &c.width) || !Integer(next + 1, 1, &c.height) ||
        !RotationAndVector(next + 2, &body_from_camera)) {
      return false;
    }
    declared.camera.Q = body_from_camera.R;
    declared.camera.s = body_from_camera.t;
    return Declare(index, declared, "camera", &cameras_);
  }

  bool Declare(int index, const DeclaredCamera& declared, const char* what,
               DeclaredCameras* cameras) {
    const auto [known, is_new] = cameras->emplace(index, declared);
    if (is_new) return true;
    return Fail(std::string(what) + " " + std::to_string(index) +
                " for the second time, expected once (line " + std::to_string(known->second.line) +
                ")");
  }

  bool CameraSigma() {
    constexpr size_t kColumns = 4;  // without the one that may be absent
    int index;
    DeclaredCamera declared;
    declared.line = line();
    RigCamera& camera = declared.camera;
    const bool has_focal = num_columns() == kColumns + 1;
    if ((!has_focal && !CheckColumns(kColumns)) || !Integer(1, 0, &index) ||
        !SigmaDeg(2, &camera.rotation_sigma) || !PositiveNumber(3, &camera.position_sigma) ||
        (has_focal && !PositiveNumber(kColumns, &camera.focal_sigma))) {
      return false;
    }
    return Declare(index, declared, "camera_sigma", &sigmas_);
  }

  bool CameraTime() {
    int index;
    DeclaredCamera declared;
    declared.line = line();
    if (!Integer(1, 0, &index) || !Number(2, &declared.camera.time_offset)) return false;
    return Declare(index, declared, "camera_time", &times_);
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
    const std::string_view name = Column(1);
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
      case kCameraSigma:
        return CameraSigma();
      case kCameraTime:
        return CameraTime();
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
      case kRotation:
        return Rotation();
      case kDistance:
        return Distance();
      case kNoise:
        return Positive(&pair_.noise_px);
      case kSequence:
        return Sequence();
      case kColumns:
        return rows_.ReadNames(this);
      case kMatches:
        return Integer(1, 0, &num_matches_);
      case kNumKeywords:
        break;
    }
    return false;
  }

  // Always false.
  bool UnknownKeyword(bool has_format) {
    if (!has_format) {
      return Fail(Quoted(Column(0)) + ", expected a match file with a line '" +
                  std::string(kKeywords[kFormat].usage) + "'");
    }
    std::string names;
    for (const Keyword& keyword : kKeywords) {
      names += (names.empty() ? "" : ", ") + std::string(keyword.name);
    }
    return Fail("unknown keyword " + Quoted(Column(0)) + ", expected one of " + names);
  }

  bool ParseHeader() {
    std::array<int64_t, kNumKeywords> seen{};  // line of each keyword
    while (NextLine()) {
      const int id = FindKeyword(Column(0));
      if (id < 0) return UnknownKeyword(seen[kFormat] > 0);
      const Keyword& keyword = kKeywords[id];
      const bool once = id != kCamera && id != kCameraSigma && id != kCameraTime;
      if (seen[id] > 0 && once) {
        return Fail("'" + std::string(keyword.name) +
                    "' for the second time, expected once (line " + std::to_string(seen[id]) + ")");
      }
      seen[id] = line();
      SetUsage(keyword.usage);
      if (id == kMatches && seen[kFormat] == 0) {
        return Fail("no 'format' line before 'matches', expected '" +
                    std::string(kKeywords[kFormat].usage) + "'");
      }
      const bool any = keyword.columns == kAnyColumns;
      if (!any && !CheckColumns(keyword.columns)) return false;
      if (!HeaderLine(static_cast<KeywordId>(id))) return false;
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
        return FailAt(declared.line, "camera " + std::to_string(index) + " without a camera " +
                                         std::to_string(pair_.rig.size()) +
                                         ", expected cameras numbered 0, 1, ... without a gap");
      }
      pair_.rig.cameras.push_back(declared.camera);
    }
    return FinishSigmasAndTimes();
  }

  // These lines may be before those of their cameras.
  bool FinishSigmasAndTimes() {
    for (const auto& [index, declared] : sigmas_) {
      if (!IsDeclared(index, declared.line)) return false;
      RigCamera& camera = pair_.rig.cameras[index];
      camera.rotation_sigma = declared.camera.rotation_sigma;
      camera.position_sigma = declared.camera.position_sigma;
      camera.focal_sigma = declared.camera.focal_sigma;
    }
    for (const auto& [index, declared] : times_) {
      if (!IsDeclared(index, declared.line)) return false;
      pair_.rig.cameras[index].time_offset = declared.camera.time_offset;
    }
    return true;
  }

  bool IsDeclared(int index, int64_t line) {
    if (index < pair_.rig.size()) return true;
    return FailAt(line, "K is '" + std::to_string(index) + "', expected a declared camera (0 to " +
                            std::to_string(pair_.rig.size() - 1) + ")");
  }

  bool ParseRows() {
    SetUsage(rows_.usage());
    // N is only believed as far as the text could hold it.
    const size_t num_rows = static_cast<size_t>(num_matches_);
    std::vector<Match>& matches = pair_.matches;
    matches.reserve(std::min(num_rows, BytesLeft() / kMinRowBytes + 1));
    for (;;) {
      Match m;
      while (rows_.IsDefault() && matches.size() < num_rows && TakePlainRow(pair_.rig.size(), &m)) {
        matches.push_back(m);
      }
      if (!NextLine()) break;
      if (FindKeyword(Column(0)) >= 0) {
        return Fail(Quoted(Column(0)) + " after 'matches', expected header lines before it");
      }
      if (matches.size() == num_rows) {
        return Fail("more rows than 'matches " + std::to_string(num_rows) +
                    "' announces, expected the end of the file");
      }
      if (!rows_.ReadRow(this, &pair_)) return false;
    }
    if (matches.size() == num_rows) return true;
    return Fail("the file ends after " + std::to_string(matches.size()) + " rows, expected " +
                std::to_string(num_rows));
  }

  FramePair pair_;
  DeclaredCameras cameras_, sigmas_, times_;
  std::string camera_usage_;  // of the last camera's model
  MatchRows rows_;
  int num_matches_ = 0;
};

// The lines of cameras that state an error or another time than the pair's.
void WriteSigmasAndTimes(const Rig& rig, MatchText* f) {
  for (int k = 0; k < rig.size(); ++k) {
    const RigCamera& camera = rig.cameras[k];
    if (camera.rotation_sigma == 0 && camera.position_sigma == 0 && camera.focal_sigma == 0) {
      continue;
    }
    f->Word(kKeywords[kCameraSigma].name).Number(k);
    f->SigmaDeg(camera.rotation_sigma).Number(camera.position_sigma);
    if (camera.focal_sigma != 0) f->Number(camera.focal_sigma);
    f->EndLine();
  }
  for (int k = 0; k < rig.size(); ++k) {
    if (rig.cameras[k].time_offset == 0) continue;
    f->Word(kKeywords[kCameraTime].name).Number(k).Number(rig.cameras[k].time_offset).EndLine();
  }
}

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

std::string FormatMatches(const FramePair& pair) {
  // Bytes to reserve, both of them: a file that has more grows as it is written.
  constexpr size_t kHeaderBytes = 4096;
  constexpr size_t kUsualRowBytes = 100;
  MatchText f(kHeaderBytes + kUsualRowBytes * pair.matches.size());
  const auto direction = [&f](KeywordId id, const std::optional<Eigen::Vector3d>& v) {
    if (v) f.Word(kKeywords[id].name).Vector(*v).EndLine();
  };
  const auto sigma = [&f](KeywordId id, const std::optional<double>& radians) {
    if (radians) f.Word(kKeywords[id].name).SigmaDeg(*radians).EndLine();
  };

  f.Word(kKeywords[kFormat].usage).EndLine();
  for (int k = 0; k < pair.rig.size(); ++k) {
    const RigCamera& camera = pair.rig.cameras[k];
    const Camera& c = camera.intrinsics;
    f.Word(kKeywords[kCamera].name).Number(k).Word(CameraModelName(c.model));
    for (int i = 0; i < NumCameraParameters(c.model); ++i) f.Number(c.parameters[i]);
    f.Number(c.width).Number(c.height);
    f.Quaternion(camera.Q).Vector(camera.s).EndLine();
  }
  WriteSigmasAndTimes(pair.rig, &f);
  if (pair.time1 && pair.time2) {
    f.Word(kKeywords[kTime].name).Number(*pair.time1).Number(*pair.time2).EndLine();
  }
  if (pair.truth) {
    f.Word(kKeywords[kTruth].name).Quaternion(pair.truth->R).Vector(pair.truth->t).EndLine();
  }
  const MotionPrior& prior = pair.prior;
  direction(kGravity1, prior.gravity1);
  direction(kGravity2, prior.gravity2);
  sigma(kGravitySigma, prior.gravity_sigma);
  direction(kAxis, prior.axis);
  sigma(kAxisSigma, prior.axis_sigma);
  direction(kNormal, prior.normal);
  sigma(kNormalSigma, prior.normal_sigma);
  direction(kForward, prior.forward);
  if (prior.distance) {
    f.Word(kKeywords[kDistance].name).Number(*prior.distance).Number(prior.distance_sigma);
    f.EndLine();
  }
  if (pair.noise_px) f.Word(kKeywords[kNoise].name).Number(*pair.noise_px).EndLine();
  if (!pair.sequence.empty()) f.Word(kKeywords[kSequence].name).Word(pair.sequence).EndLine();
  const MatchRows rows(pair);
  if (!rows.IsDefault()) f.Word(kKeywords[kColumns].name).Word(rows.usage()).EndLine();
  f.Word(kKeywords[kMatches].name).Number(pair.matches.size()).EndLine();
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    rows.WriteRow(pair, k, &f);
    f.EndLine();
  }
  return f.Take();
}

std::string MatchFileBytes(const std::string& path, const std::string& text) {
  const bool compressed = path.size() > kCompressed.size() && EndsWith(path, kCompressed);
  return compressed ? Gzip(text) : text;
}

bool WriteMatchFile(const std::string& path, const FramePair& pair, std::string* error) {
  const std::string text = FormatMatches(pair);
  // Reading it back costs little and finds everything a reader would reject.
  const std::string refusal = path + ": not written, it could not be read back";
  FramePair read;
  if (!ParseMatches(text, refusal, &read, error)) return false;
  std::string what;
  if (!pair.columns.IsValid(pair.matches.size(), &what)) {
    *error = Printable(refusal) + ": " + what;
    return false;
  }
  if (read.time1 != pair.time1 || read.time2 != pair.time2) {
    *error = Printable(refusal) + ": one time is missing, expected both or none";
    return false;
  }
  if (read.sequence != pair.sequence) {
    *error = Printable(refusal) + ": sequence " + Quoted(pair.sequence) +
             ", expected a name without blanks";
    return false;
  }
  return WriteWholeFile(path, MatchFileBytes(path, text), error);
}

bool IsMatchFileName(const std::string& name) {
  std::string_view plain = name;
  if (EndsWith(plain, kCompressed)) plain.remove_suffix(kCompressed.size());
  return plain.size() > kSuffix.size() && EndsWith(plain, kSuffix);
}

}  // namespace rigel
