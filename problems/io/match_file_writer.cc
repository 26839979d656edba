// Writer of match files (match_file.h).
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "rigel/core/angles.h"
#include "rigel/problems/io/gzip.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_words.h"
#include "rigel/problems/io/parse_number.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {
namespace {

using namespace match_file;

// Text of a match file, line by line.
class Formatter {
 public:
  explicit Formatter(size_t num_bytes) { text_.reserve(num_bytes); }

  Formatter& Word(std::string_view word) {
    if (!text_.empty() && text_.back() != '\n') text_ += ' ';
    text_ += word;
    return *this;
  }

  template <typename Value>
  Formatter& Number(Value value) {
    std::array<char, 32> buffer;  // the shortest form of a double has at most 24 characters
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return Word({buffer.data(), size_t(result.ptr - buffer.data())});
  }

  template <typename Derived>
  Formatter& Vector(const Eigen::MatrixBase<Derived>& v) {
    for (Eigen::Index k = 0; k < v.size(); ++k) Number(v[k]);
    return *this;
  }

  Formatter& Quaternion(const Eigen::Matrix3d& R) {
    Pose pose;
    pose.R = R;
    const Eigen::Quaterniond q = pose.Quaternion();
    return Number(q.w()).Number(q.x()).Number(q.y()).Number(q.z());
  }

  // Writes degrees. Multiplying back and forth by pi/180 loses an ulp now and then, so look for
  // the plainest degrees that read back as the same radians. About a tenth of all doubles are no
  // double's radians; those move by one ulp.
  Formatter& SigmaDeg(double radians) {
    const double degrees = RadToDeg(radians);
    const auto is_exact = [radians](double d) { return DegToRad(d) == radians; };
    std::array<char, 64> buffer;
    for (int digits = 1; digits <= 15; ++digits) {
      const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), degrees,
                                        std::chars_format::general, digits);
      const std::string_view word(buffer.data(), result.ptr - buffer.data());
      double rounded;
      if (ParseFinite(word, &rounded) && is_exact(rounded)) return Number(rounded);
    }
    const double inf = std::numeric_limits<double>::infinity();
    double below = degrees;
    double above = degrees;
    for (int k = 0; k < 4; ++k) {
      if (is_exact(below)) return Number(below);
      if (is_exact(above)) return Number(above);
      below = std::nextafter(below, -inf);
      above = std::nextafter(above, inf);
    }
    return Number(degrees);
  }

  void EndLine() { text_ += '\n'; }

  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

std::string FormatMatches(const FramePair& pair) {
  // Bytes to reserve, both of them: a file that has more grows as it is written.
  constexpr size_t kHeaderBytes = 4096;
  constexpr size_t kUsualRowBytes = 100;
  Formatter f(kHeaderBytes + kUsualRowBytes * pair.matches.size());
  const auto direction = [&f](KeywordId id, const std::optional<Eigen::Vector3d>& v) {
    if (v) f.Word(kKeywords[id].name).Vector(*v).EndLine();
  };
  const auto sigma = [&f](KeywordId id, const std::optional<double>& radians) {
    if (radians) f.Word(kKeywords[id].name).SigmaDeg(*radians).EndLine();
  };

  f.Word(kKeywords[kFormat].usage).EndLine();
  for (int k = 0; k < pair.rig.size(); ++k) {
    const RigCamera& camera = pair.rig.cameras[k];
    const PinholeCamera& c = camera.intrinsics;
    f.Word(kKeywords[kCamera].name).Number(k).Word("pinhole");
    f.Number(c.fx).Number(c.fy).Number(c.cx).Number(c.cy).Number(c.width).Number(c.height);
    f.Quaternion(camera.Q).Vector(camera.s).EndLine();
  }
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
  f.Word(kKeywords[kMatches].name).Number(pair.matches.size()).EndLine();
  for (const Match& m : pair.matches) {
    f.Number(m.camera1).Vector(m.pixel1).Number(m.camera2).Vector(m.pixel2).Number(m.score);
    f.EndLine();
  }
  return f.Take();
}

std::string MatchFileBytes(const std::string& path, const std::string& text) {
  constexpr std::string_view kCompressed = ".gz";
  const bool compressed =
      path.size() > kCompressed.size() &&
      path.compare(path.size() - kCompressed.size(), kCompressed.size(), kCompressed) == 0;
  return compressed ? Gzip(text) : text;
}

bool WriteMatchFile(const std::string& path, const FramePair& pair, std::string* error) {
  const std::string text = FormatMatches(pair);
  // Reading it back costs little and finds everything a reader would reject.
  const std::string refusal = path + ": not written, it could not be read back";
  FramePair read;
  if (!ParseMatches(text, refusal, &read, error)) return false;
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

}  // namespace rigel
