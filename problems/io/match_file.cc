#include "rigel/problems/io/match_file.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "rigel/problems/io/gzip.h"
#include "rigel/problems/io/header_lines.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file_words.h"
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

class Parser final : private HeaderLines {
 public:
  Parser(std::string_view text, const std::string& name, std::string* error)
      : HeaderLines(kKeywords.data(), kNumKeywords, "a match file", text, name, error) {
    pair_.name = name;
  }

  bool Parse(FramePair* pair) {
    if (!ReadHeader() || !cameras_.Finish(kKeywords[kMatches].name, this, &pair_.rig) ||
        !ParseRows()) {
      return false;
    }
    *pair = std::move(pair_);
    return true;
  }

 private:
  // Checked only: nothing that is estimated uses it yet.
  bool Rotation() {
    Eigen::Vector4d q;
    double sigma;
    return UnitVector(1, "quaternion", &q) && SigmaDeg(5, &sigma);
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
    if (!HeaderLines::Distance(1, &distance, &sigma)) return false;
    pair_.prior.distance = distance;
    pair_.prior.distance_sigma = sigma;
    return true;
  }

  bool HeaderLine(int id) override {
    MotionPrior& prior = pair_.prior;
    switch (id) {
      case kCamera:
        return cameras_.ReadCamera(this);
      case kCameraSigma:
        return cameras_.ReadSigma(this);
      case kCameraTime:
        return cameras_.ReadTime(this);
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
        return Sequence(&pair_.sequence);
      case kColumns:
        return rows_.ReadNames(this);
      case kMatches:
        return Integer(1, 0, &num_matches_);
      default:
        return false;
    }
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
      if (!CheckRow(matches.size(), num_rows)) return false;
      if (!rows_.ReadRow(this, &pair_)) return false;
    }
    return CheckNumRows(matches.size(), num_rows);
  }

  FramePair pair_;
  CameraLines cameras_;
  MatchRows rows_;
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
  CameraLines::Write(pair.rig, &f);
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
