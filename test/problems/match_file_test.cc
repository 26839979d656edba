// The reader and writer of match files: exact round trips, and every broken file refused with the
// line and what was expected.
#include "rigel/problems/match_file.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "rigel/core/angles.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;

// Each keyword once, a comment, a blank line. Tests of broken files name its lines by number.
constexpr std::string_view kValid =
    "# a comment\n"                                                       // 1
    "format rigmatch 1\n"                                                 // 2
    "camera 0 pinhole 700.5 701 600 180.25 1226 370 1 0 0 0 0 0 0\n"      // 3
    "camera 1 pinhole 710 711 610 190 1240 376 0.6 0.8 0 0 0.5 -0.1 2\n"  // 4
    "time 1.5 1.625\n"                                                    // 5
    "truth 0.8 0 -0.6 0 0.25 -0.5 1.25\n"                                 // 6
    "gravity1 0 1 0\n"                                                    // 7
    "gravity2 0.6 0.8 0\n"                                                // 8
    "gravity_sigma_deg 0.5\n"                                             // 9
    "axis 0 0.6 0.8\n"                                                    // 10
    "axis_sigma_deg 0.25\n"                                               // 11
    "normal 0 -1 0\n"                                                     // 12
    "normal_sigma_deg 2\n"                                                // 13
    "distance 1.5 0.125\n"                                                // 14
    "noise_px 0.75\n"                                                     // 15
    "sequence loop-06\n"                                                  // 16
    "\n"                                                                  // 17
    "matches 3\n"                                                         // 18
    "0 34.25 103.5 0 11.75 101 0.5\n"                                     // 19
    "0 -4.5 99 1 -0.25 98.5 0\n"                                          // 20
    "1 1e2 2.5E-1 1 3 4 -1\n";                                            // 21

// `text` with the first `from` replaced, which must be there.
std::string Replace(std::string_view text, std::string_view from, std::string_view to) {
  std::string out(text);
  const size_t at = out.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? out : out.replace(at, from.size(), to);
}

std::string ReplaceAll(std::string text, std::string_view from, std::string_view to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

bool IsOnePrintableLine(const std::string& message) {
  return !message.empty() && std::all_of(message.begin(), message.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
  });
}

FramePair MustParse(std::string_view text) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(ParseMatches(text, "x.matches", &pair, &error)) << error;
  EXPECT_TRUE(pair.IsValid(&error)) << error;
  return pair;
}

// Exact but for rotations, which pass through a quaternion.
void ExpectSame(const FramePair& a, const FramePair& b) {
  constexpr double kRotationTolerance = 2e-15;
  EXPECT_EQ(a.sequence, b.sequence);
  ASSERT_EQ(a.rig.size(), b.rig.size());
  for (int k = 0; k < a.rig.size(); ++k) {
    const RigCamera& ca = a.rig.cameras[k];
    const RigCamera& cb = b.rig.cameras[k];
    EXPECT_EQ(ca.intrinsics.fx, cb.intrinsics.fx);
    EXPECT_EQ(ca.intrinsics.fy, cb.intrinsics.fy);
    EXPECT_EQ(ca.intrinsics.cx, cb.intrinsics.cx);
    EXPECT_EQ(ca.intrinsics.cy, cb.intrinsics.cy);
    EXPECT_EQ(ca.intrinsics.width, cb.intrinsics.width);
    EXPECT_EQ(ca.intrinsics.height, cb.intrinsics.height);
    EXPECT_LT((ca.Q - cb.Q).cwiseAbs().maxCoeff(), kRotationTolerance);
    EXPECT_EQ(ca.s, cb.s);
  }
  EXPECT_EQ(a.time1, b.time1);
  EXPECT_EQ(a.time2, b.time2);
  ASSERT_EQ(a.truth.has_value(), b.truth.has_value());
  if (a.truth) {
    EXPECT_LT((a.truth->R - b.truth->R).cwiseAbs().maxCoeff(), kRotationTolerance);
    EXPECT_EQ(a.truth->t, b.truth->t);
  }
  EXPECT_EQ(a.noise_px, b.noise_px);
  EXPECT_EQ(a.prior.gravity1, b.prior.gravity1);
  EXPECT_EQ(a.prior.gravity2, b.prior.gravity2);
  EXPECT_EQ(a.prior.gravity_sigma, b.prior.gravity_sigma);
  EXPECT_EQ(a.prior.axis, b.prior.axis);
  EXPECT_EQ(a.prior.axis_sigma, b.prior.axis_sigma);
  EXPECT_EQ(a.prior.normal, b.prior.normal);
  EXPECT_EQ(a.prior.normal_sigma, b.prior.normal_sigma);
  EXPECT_EQ(a.prior.distance, b.prior.distance);
  EXPECT_EQ(a.prior.distance_sigma, b.prior.distance_sigma);
  ASSERT_EQ(a.matches.size(), b.matches.size());
  int num_different = 0;
  for (size_t k = 0; k < a.matches.size(); ++k) {
    const Match& ma = a.matches[k];
    const Match& mb = b.matches[k];
    num_different += !(ma.camera1 == mb.camera1 && ma.pixel1 == mb.pixel1 &&
                       ma.camera2 == mb.camera2 && ma.pixel2 == mb.pixel2 && ma.score == mb.score);
  }
  EXPECT_EQ(num_different, 0);
}

// A pair with everything in it and numbers of full length, over many magnitudes.
FramePair RandomPair(uint64_t seed) {
  Random random(seed);
  const auto number = [&random] {
    return random.Normal() * std::pow(10.0, random.Uniform(-12, 12));
  };
  const auto sigma = [&random] { return DegToRad(random.Uniform(1e-6, 30)); };
  const auto pose = [&random] {
    Pose p;
    p.R = ExpSO3(random.UnitVector3() * random.Uniform(0, kPi));
    p.t = random.NormalVector3();
    return p;
  };
  FramePair pair;
  pair.name = "random";
  pair.sequence = "s" + std::to_string(seed);
  pair.rig.cameras.resize(1 + random.Index(12));
  for (RigCamera& camera : pair.rig.cameras) {
    PinholeCamera& c = camera.intrinsics;
    c = {random.Uniform(1, 1e4),    random.Uniform(1, 1e4),   number(), number(),
         1 + random.Index(1 << 30), 1 + random.Index(1 << 30)};
    const Pose p = pose();
    camera.Q = p.R;
    camera.s = p.t;
  }
  pair.time1 = number();
  pair.time2 = number();
  pair.truth = pose();
  pair.noise_px = random.Uniform(0.01, 2);
  pair.prior.gravity1 = random.UnitVector3();
  pair.prior.gravity2 = random.UnitVector3();
  pair.prior.gravity_sigma = sigma();
  pair.prior.axis = random.UnitVector3();
  pair.prior.axis_sigma = sigma();
  pair.prior.normal = random.UnitVector3();
  pair.prior.normal_sigma = sigma();
  pair.prior.distance = std::abs(number());
  pair.prior.distance_sigma = std::abs(number());
  for (int k = 0; k < 50; ++k) {
    Match m;
    m.camera1 = random.Index(pair.rig.size());
    m.camera2 = random.Index(pair.rig.size());
    m.pixel1 = {number(), number()};
    m.pixel2 = {number(), number()};
    m.score = number();
    pair.matches.push_back(m);
  }
  return pair;
}

class TempDir {
 public:
  TempDir() {
    std::string name = (fs::temp_directory_path() / "rigel_match_file_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TempDir() { fs::remove_all(path_); }

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  fs::path path_;
};

void WriteText(const std::string& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string ReadText(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

TEST(MatchFile, ReadsEveryField) {
  const FramePair pair = MustParse(kValid);
  EXPECT_EQ(pair.name, "x.matches");
  EXPECT_EQ(pair.sequence, "loop-06");
  ASSERT_EQ(pair.rig.size(), 2);
  const RigCamera& c0 = pair.rig.cameras[0];
  EXPECT_EQ(c0.intrinsics.fx, 700.5);
  EXPECT_EQ(c0.intrinsics.fy, 701);
  EXPECT_EQ(c0.intrinsics.cx, 600);
  EXPECT_EQ(c0.intrinsics.cy, 180.25);
  EXPECT_EQ(c0.intrinsics.width, 1226);
  EXPECT_EQ(c0.intrinsics.height, 370);
  EXPECT_EQ(c0.Q, Eigen::Matrix3d::Identity());
  const RigCamera& c1 = pair.rig.cameras[1];
  EXPECT_EQ(c1.s, Eigen::Vector3d(0.5, -0.1, 2));
  // w x y z = 0.6 0.8 0 0: about X with cos a = 0.36 - 0.64, sin a = 2 * 0.6 * 0.8.
  Eigen::Matrix3d Q;
  Q << 1, 0, 0, 0, -0.28, -0.96, 0, 0.96, -0.28;
  EXPECT_TRUE(c1.Q.isApprox(Q, 1e-15)) << c1.Q;
  EXPECT_EQ(pair.time1, 1.5);
  EXPECT_EQ(pair.time2, 1.625);
  ASSERT_TRUE(pair.truth.has_value());
  // 0.8 0 -0.6 0: about Y with cos a = 0.28, sin a = -0.96.
  Eigen::Matrix3d R;
  R << 0.28, 0, -0.96, 0, 1, 0, 0.96, 0, 0.28;
  EXPECT_TRUE(pair.truth->R.isApprox(R, 1e-15)) << pair.truth->R;
  EXPECT_EQ(pair.truth->t, Eigen::Vector3d(0.25, -0.5, 1.25));
  const MotionPrior& prior = pair.prior;
  EXPECT_EQ(prior.gravity1, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(prior.gravity2, Eigen::Vector3d(0.6, 0.8, 0));
  EXPECT_DOUBLE_EQ(prior.gravity_sigma.value(), 0.5 * kPi / 180);
  EXPECT_EQ(prior.axis, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_DOUBLE_EQ(prior.axis_sigma.value(), 0.25 * kPi / 180);
  EXPECT_EQ(prior.normal, Eigen::Vector3d(0, -1, 0));
  EXPECT_DOUBLE_EQ(prior.normal_sigma.value(), 2 * kPi / 180);
  EXPECT_EQ(prior.distance, 1.5);
  EXPECT_EQ(prior.distance_sigma, 0.125);
  EXPECT_EQ(pair.noise_px, 0.75);
  ASSERT_EQ(pair.matches.size(), 3u);
  EXPECT_EQ(pair.matches[1].camera1, 0);
  EXPECT_EQ(pair.matches[1].pixel1, Eigen::Vector2d(-4.5, 99));
  EXPECT_EQ(pair.matches[1].camera2, 1);
  EXPECT_EQ(pair.matches[1].pixel2, Eigen::Vector2d(-0.25, 98.5));
  EXPECT_EQ(pair.matches[1].score, 0);
  EXPECT_EQ(pair.matches[2].pixel1, Eigen::Vector2d(100, 0.25));
  EXPECT_EQ(pair.matches[2].score, -1);
}

TEST(MatchFile, OptionalLinesMayBeAbsent) {
  const FramePair pair = MustParse(
      "format rigmatch 1\ncamera 0 pinhole 1 1 0 0 1 1 1 0 0 0 0 0 0\ngravity1 1 0 0\n"
      "axis_sigma_deg 3\nmatches 0");
  EXPECT_TRUE(pair.matches.empty());
  EXPECT_FALSE(pair.time1 || pair.time2 || pair.truth || pair.noise_px);
  EXPECT_TRUE(pair.prior.gravity1 && pair.prior.axis_sigma);
  EXPECT_FALSE(pair.prior.gravity2 || pair.prior.gravity_sigma || pair.prior.axis);
  EXPECT_FALSE(pair.prior.normal || pair.prior.normal_sigma || pair.prior.distance);
  EXPECT_EQ(pair.sequence, "");
}

TEST(MatchFile, LooksOfTheTextDoNotMatter) {
  const FramePair expected = MustParse(kValid);
  const std::string valid(kValid);
  const auto reordered = [&] {
    std::istringstream in{valid.substr(0, valid.find("\nmatches") + 1)};
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line + "\n");
    std::string out;
    for (size_t k = lines.size(); k-- > 0;) out += lines[k];
    return out + valid.substr(valid.find("\nmatches") + 1);
  };
  const struct {
    const char* what;
    std::string text;
  } cases[] = {
      {"CRLF", ReplaceAll(valid, "\n", "\r\n")},
      {"tabs", ReplaceAll(valid, " ", "\t")},
      {"blanks at both ends of a line", ReplaceAll(valid, "\n", " \t\n  ")},
      {"byte order mark", "\xef\xbb\xbf" + valid},
      {"no line break at the end", valid.substr(0, valid.size() - 1)},
      {"comments and blank lines among the rows", ReplaceAll(valid, "\n", "\n  # x y\n\n")},
      {"plus signs", Replace(Replace(valid, " 34.25", " +34.25"), "noise_px ", "noise_px +")},
      {"header lines backwards", reordered()},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.what);
    ExpectSame(MustParse(c.text), expected);
  }
}

TEST(MatchFile, NearlyUnitVectorsAreNormalized) {
  std::string text = Replace(kValid, "gravity2 0.6 0.8 0", "gravity2 0.6005 0.8 0");
  text = Replace(text, "truth 0.8 0 -0.6 0", "truth 0.8007 0 -0.6 0");
  const FramePair pair = MustParse(text);
  EXPECT_NEAR(pair.prior.gravity2->norm(), 1.0, 1e-15);
  EXPECT_NEAR(pair.prior.gravity2->x() / pair.prior.gravity2->y(), 0.6005 / 0.8, 1e-15);
  EXPECT_TRUE((pair.truth->R.transpose() * pair.truth->R).isIdentity(1e-15));
}

TEST(MatchFile, NearlyAllDoublesSurviveWritingAndReading) {
  double worst_rotation = 0, worst_sigma = 0;
  for (uint64_t seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    FramePair pair = RandomPair(seed);
    const FramePair read = MustParse(FormatMatches(pair));
    // A sigma that never was a number of degrees may move by one unit in the last place.
    for (auto sigma :
         {&MotionPrior::gravity_sigma, &MotionPrior::axis_sigma, &MotionPrior::normal_sigma}) {
      std::optional<double>& original = pair.prior.*sigma;
      ASSERT_TRUE((read.prior.*sigma).has_value());
      const double now = *(read.prior.*sigma);
      worst_sigma = std::max(worst_sigma, std::abs(now / *original - 1));
      original = now;
    }
    worst_rotation =
        std::max(worst_rotation, (pair.truth->R - read.truth->R).cwiseAbs().maxCoeff());
    ExpectSame(read, pair);
    // From a file to a file nothing moves.
    ExpectSame(MustParse(FormatMatches(read)), read);
  }
  EXPECT_LT(worst_sigma, 2.3e-16);
  EXPECT_LT(worst_rotation, 1.5e-15);
}

TEST(MatchFile, ExtremeDoublesSurvive) {
  FramePair pair = MustParse(kValid);
  using Limits = std::numeric_limits<double>;
  Match& m = pair.matches[0];
  m.pixel1 = {Limits::max(), Limits::lowest()};
  m.pixel2 = {Limits::denorm_min(), -0.0};
  m.score = Limits::min();
  const FramePair read = MustParse(FormatMatches(pair));
  ExpectSame(read, pair);
  EXPECT_TRUE(std::signbit(read.matches[0].pixel2.y()));
}

TEST(MatchFile, WritesNumbersAsPeopleDo) {
  // Sorted as the writer sorts, this text must come back byte for byte: degrees that people
  // write (0.1, 0.7) are no other degrees after the way through radians.
  for (const char* degrees : {"0.1", "0.3", "0.7", "10", "100", "0.95", "1", "1.1", "1.9", "3.7",
                              "5", "15.1", "17.3", "29.3", "0.001", "1e-09"}) {
    SCOPED_TRACE(degrees);
    std::string text = std::string("format rigmatch 1\n") +
                       "camera 0 pinhole 400 400 320 240 640 480 1 0 0 0 -0.5 0 0\n" +
                       "time 0.1 0.2\ntruth 1 0 0 0 0 0 1\ngravity1 0 1 0\ngravity2 0 1 0\n" +
                       "gravity_sigma_deg " + degrees + "\naxis 0 1 0\naxis_sigma_deg " + degrees +
                       "\nnormal 0 1 0\nnormal_sigma_deg " + degrees +
                       "\ndistance 1 0.1\nnoise_px 0.5\nsequence a\nmatches 1\n" +
                       "0 0.1 0.2 0 0.3 1e+22 0.7\n";
    EXPECT_EQ(FormatMatches(MustParse(text)), text);
  }
}

struct Broken {
  const char* what;
  std::string from;  // replaced in kValid by
  std::string to;
  int line;
  const char* phrase;  // of the message
};

void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.what; }

class BrokenMatchFile : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenMatchFile, IsRefused) {
  const Broken& c = GetParam();
  const std::string text = Replace(kValid, c.from, c.to);
  for (const std::string& variant : {text, ReplaceAll(text, "\n", "\r\n")}) {
    FramePair pair;
    pair.name = "untouched";
    pair.noise_px = 7;
    std::string error;
    ASSERT_FALSE(ParseMatches(variant, "x.matches", &pair, &error));
    EXPECT_EQ(error.rfind("x.matches:" + std::to_string(c.line) + ": ", 0), 0u) << error;
    EXPECT_NE(error.find(c.phrase), std::string::npos) << error;
    EXPECT_NE(error.find("expected"), std::string::npos) << error;
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
    EXPECT_EQ(pair.name, "untouched");
    EXPECT_EQ(pair.noise_px, 7);
    EXPECT_TRUE(pair.matches.empty() && pair.rig.cameras.empty());
  }
}

const char kRow[] = "0 34.25 103.5 0 11.75 101 0.5";
const char kCamera1[] = "camera 1 pinhole 710 711 610 190 1240 376 0.6 0.8 0 0 0.5 -0.1 2";
const char kColumns[] = "expected 7 (I U V J U2 V2 SCORE)";

INSTANTIATE_TEST_SUITE_P(
    Header, BrokenMatchFile,
    ::testing::ValuesIn(std::vector<Broken>{
        {"no format line", "format rigmatch 1\n", "", 17, "no 'format' line before 'matches'"},
        {"no format line, comments only", std::string(kValid), "# nothing\n", 1, "without a 'form"},
        {"other format", "rigmatch 1", "colmap 1", 2, "format 'colmap' version '1'"},
        {"version 2", "rigmatch 1", "rigmatch 2", 2, "'format rigmatch 1', the version that is"},
        {"version 1.0", "rigmatch 1", "rigmatch 1.0", 2, "version '1.0'"},
        {"format short", "rigmatch 1", "rigmatch", 2, "2 columns, expected 3 (format rigmatch 1)"},
        {"unknown keyword", "time 1.5", "times 1.5", 5, "unknown keyword 'times'"},
        {"keyword in capitals", "time 1.5", "Time 1.5", 5, "expected one of format, camera, time"},
        {"format twice", "time 1.5 1.625", "format rigmatch 1", 5,
         "second time, expected once (line 2"},
        {"time twice", "gravity1 0 1 0", "time 1 2", 7, "'time' for the second time"},
        {"truth twice", "time 1.5 1.625", "truth 1 0 0 0 0 0 0", 6, "once (line 5)"},
        {"gravity1 twice", "gravity2 0.6 0.8 0", "gravity1 0 1 0", 8, "'gravity1' for the second"},
        {"noise_px twice", "sequence loop-06", "noise_px 1", 16, "'noise_px' for the second"},
        {"sequence twice", "noise_px 0.75", "sequence a", 16, "'sequence' for the second"},
        {"camera twice", "camera 1", "camera 0", 4,
         "camera 0 for the second time, expected once (line 3)"},
        {"camera gap", "camera 1", "camera 2", 4, "camera 2 without a camera 1"},
        {"camera from 1", "camera 0", "camera 2", 4, "camera 1 without a camera 0"},
        {"camera negative", "camera 1", "camera -1", 4, "K is '-1', expected an integer from 0"},
        {"camera absurd", "camera 1", "camera 2147483647", 4, "without a camera 1"},
        {"camera overflow", "camera 1", "camera 4294967296", 4, "K is '4294967296'"},
        {"camera not a number", "camera 1", "camera left", 4, "K is 'left'"},
        {"camera model", "0 pinhole", "0 fisheye", 3, "camera model 'fisheye', expected 'pinhole'"},
        {"camera short", " 0.5 -0.1 2", " 0.5 -0.1", 4,
         "15 columns, expected 16 (camera K pinhole FX"},
        {"camera long", " 0.5 -0.1 2", " 0.5 -0.1 2 3 4", 4, "18 columns, expected 16"},
        {"FX zero", "700.5 701", "0 701", 3, "FX is '0', expected a positive number"},
        {"FY negative", "700.5 701", "700.5 -701", 3, "FY is '-701', expected a positive number"},
        {"FX nan", "700.5 701", "nan 701", 3, "FX is 'nan', expected a finite number"},
        {"CX infinite", "701 600", "701 inf", 3, "CX is 'inf'"},
        {"CY not a number", "180.25", "180,25", 3, "CY is '180,25'"},
        {"WIDTH zero", "1226 370", "0 370", 3, "WIDTH is '0', expected an integer from 1"},
        {"HEIGHT negative", "1226 370", "1226 -370", 3, "HEIGHT is '-370'"},
        {"HEIGHT not whole", "1226 370", "1226 370.5", 3, "HEIGHT is '370.5'"},
        {"camera quaternion", "0.6 0.8 0 0", "0.6 0.81 0 0", 4, "quaternion has norm 1.008"},
        {"camera quaternion zero", "0.6 0.8 0 0", "0 0 0 0", 4,
         "has norm 0, expected 1 within 0.001"},
        {"camera position", "0.5 -0.1 2", "0.5 -0.1 1e999", 4, "SZ is '1e999'"},
        {"quaternion overflow", "0.6 0.8 0 0", "1e200 0 0 0", 4, "quaternion has norm"},
        {"no camera",
         "camera 0 pinhole 700.5 701 600 180.25 1226 370 1 0 0 0 0 0 0\n" + std::string(kCamera1) +
             "\n",
         "", 16, "no 'camera' line before 'matches'"},
        {"time short", "1.5 1.625", "1.5", 5, "2 columns, expected 3 (time T1 T2)"},
        {"time nan", "1.5 1.625", "1.5 -nan", 5, "T2 is '-nan'"},
        {"time infinity", "1.5 1.625", "infinity 1.5", 5, "T1 is 'infinity'"},
        {"truth short", "0.25 -0.5 1.25", "0.25 -0.5", 6, "7 columns, expected 8 (truth QW"},
        {"truth quaternion", "0.8 0 -0.6 0", "0.8 0 -0.6 0.1", 6, "quaternion has norm 1.00499"},
        {"truth translation", "0.25 -0.5 1.25", "0.25 x 1.25", 6, "TY is 'x'"},
        {"gravity1 zero", "gravity1 0 1 0", "gravity1 0 0 0", 7, "direction has norm 0,"},
        {"gravity1 9.81", "gravity1 0 1 0", "gravity1 0 9.81 0", 7, "norm 9.81, expected 1 within"},
        {"gravity2 off by 0.0011", "gravity2 0.6 0.8 0", "gravity2 0.6 0.801376 0", 8,
         "direction has norm 1.0011"},
        {"gravity2 long", "gravity2 0.6 0.8 0", "gravity2 0.6 0.8 0 0", 8,
         "5 columns, expected 4 (gravity2 GX GY"},
        {"gravity sigma zero", "deg 0.5", "deg 0", 9, "S is '0', expected a positive number"},
        {"gravity sigma negative", "deg 0.5", "deg -0.5", 9, "S is '-0.5', expected a positive"},
        {"gravity sigma nan", "deg 0.5", "deg nan", 9, "S is 'nan', expected a finite"},
        {"gravity sigma vanishes", "deg 0.5", "deg 4.9e-324", 9, "expected a positive number"},
        {"axis norm", "axis 0 0.6 0.8", "axis 0 0.6 0.7", 10, "direction has norm 0.921954"},
        {"axis nan", "axis 0 0.6 0.8", "axis nan 0.6 0.8", 10, "NX is 'nan'"},
        {"axis sigma zero", "deg 0.25", "deg 0.0", 11, "S is '0.0'"},
        {"normal norm", "normal 0 -1 0", "normal 0 -2 0", 12, "direction has norm 2,"},
        {"normal sigma", "deg 2", "deg", 13, "1 column, expected 2 (normal_sigma_deg S)"},
        {"distance negative", "1.5 0.125", "-1.5 0.125", 14, "D is '-1.5', expected a number >= 0"},
        {"distance sigma zero", "1.5 0.125", "1.5 0", 14, "SIGMA is '0', expected a positive"},
        {"distance sigma missing", "1.5 0.125", "1.5", 14,
         "2 columns, expected 3 (distance D SIGMA)"},
        {"noise zero", "noise_px 0.75", "noise_px 0", 15, "S is '0', expected a positive"},
        {"noise unit", "noise_px 0.75", "noise_px 0.75px", 15, "S is '0.75px'"},
        {"sequence empty", "sequence loop-06", "sequence", 16,
         "1 column, expected 2 (sequence NAME)"},
        {"sequence of two words", "loop-06", "loop 06", 16, "3 columns, expected 2"},
        {"sequence with control", "loop-06", "lo\x1bop", 16, "NAME is 'lo\\x1bop'"},
        {"sequence not UTF-8", "loop-06", "Z\xfcrich", 16,
         "NAME is 'Z\\xfcrich', expected a name in UTF"},
        {"sequence cut UTF-8", "loop-06", "Z\xc3", 16, "a name in UTF-8"},
        {"sequence surrogate", "loop-06", "\xed\xa0\x80", 16, "a name in UTF-8"}}));

INSTANTIATE_TEST_SUITE_P(
    Matches, BrokenMatchFile,
    ::testing::ValuesIn(std::vector<Broken>{
        {"no matches line", std::string(kValid.substr(kValid.find("matches 3"))), "", 17,
         "the file ends without a 'matches' line"},
        {"rows without a matches line", "matches 3\n", "", 18, "unknown keyword '0'"},
        {"matches before format", "format rigmatch 1", "matches 3", 2,
         "no 'format' line before 'matches'"},
        {"matches without N", "matches 3", "matches", 18, "1 column, expected 2 (matches N)"},
        {"matches negative", "matches 3", "matches -3", 18,
         "N is '-3', expected an integer from 0"},
        {"matches not whole", "matches 3", "matches 3.0", 18, "N is '3.0'"},
        {"matches overflow", "matches 3", "matches 99999999999999999999", 18, "N is '999999999"},
        {"matches absurd", "matches 3", "matches 2147483647", 21,
         "ends after 3 rows, expected 2147483647"},
        {"fewer rows", "matches 3", "matches 4", 21, "ends after 3 rows, expected 4"},
        {"more rows", "matches 3", "matches 2", 21, "more rows than 'matches 2' announces"},
        {"rubbish after the rows", "3 4 -1\n", "3 4 -1\nend\n", 22, "more rows than 'matches 3'"},
        {"none announced", "matches 3", "matches 0", 19, "more rows than 'matches 0'"},
        {"matches twice", "matches 3", "matches 3\nmatches 3", 19, "'matches' after 'matches'"},
        {"matches again at the end", "3 4 -1\n", "3 4 -1\nmatches 3\n", 22,
         "'matches' after 'matches'"},
        {"header among the rows", "0 -4.5", "noise_px 1\n0 -4.5", 20, "'noise_px' after 'matches'"},
        {"header after the rows", "3 4 -1\n", "3 4 -1\nnoise_px 1\n", 22,
         "'noise_px' after 'matches'"},
        {"row short", kRow, "0 34.25 103.5 0 11.75 101", 19, kColumns},
        {"row long", kRow, "0 34.25 103.5 0 11.75 101 0.5 1", 19, "8 columns, expected 7"},
        {"row of one column", kRow, "0", 19, "1 column, expected 7"},
        {"row with a comment", kRow, std::string(kRow) + " # good", 19, "9 columns, expected 7"},
        {"truncated last row", "3 4 -1\n", "3", 21, "5 columns, expected 7 (I U V J U2 V2 SCORE)"},
        {"row of a thousand columns", kRow, ReplaceAll(std::string(1000, '1'), "1", "1 "), 19,
         "1000 columns, expected 7"},
        {"U nan", "34.25", "nan", 19, "U is 'nan', expected a finite number"},
        {"V nan(1)", "103.5", "nan(1)", 19, "V is 'nan(1)'"},
        {"U2 infinite", "11.75", "-inf", 19, "U2 is '-inf'"},
        {"V2 too large", " 101 ", " 1e400 ", 19, "V2 is '1e400'"},
        {"SCORE nan", "101 0.5", "101 NaN", 19, "SCORE is 'NaN'"},
        {"SCORE infinite", "101 0.5", "101 INF", 19, "SCORE is 'INF'"},
        {"two signs", "34.25", "+-34.25", 19, "U is '+-34.25'"},
        {"hexadecimal", "34.25", "0x10", 19, "U is '0x10'"},
        {"decimal comma", "34.25", "34,25", 19, "U is '34,25'"},
        {"camera 1 not declared", kRow, "2 34.25 103.5 0 11.75 101 0.5", 19,
         "I is '2', expected a declared camera (0 to 1)"},
        {"camera 2 not declared", "0 11.75", "7 11.75", 19, "J is '7', expected a declared camera"},
        {"camera negative", "0 11.75", "-1 11.75", 19, "J is '-1', expected an integer from 0"},
        {"camera not whole", "0 11.75", "0.5 11.75", 19, "J is '0.5', expected an integer"},
        {"camera overflow", "0 11.75", "4294967296 11.75", 19, "J is '4294967296'"}}));

INSTANTIATE_TEST_SUITE_P(
    Rubbish, BrokenMatchFile,
    ::testing::ValuesIn(std::vector<Broken>{
        {"other text", std::string(kValid), "Dear reader,\n", 1, "'Dear', expected a match file"},
        {"a picture", std::string(kValid), "\x89PNG\r\n\x1a\n", 1,
         "'\\x89PNG', expected a match file"},
        {"NUL in a comment", "a comment", std::string("a\0comment", 9), 1, "a NUL byte"},
        {"NUL in a row", "103.5", std::string("103\0005", 5), 19, "a NUL byte, expected a match"},
        {"control characters", "103.5", "\x01\x07\x7f", 19, "V is '\\x01\\x07\\x7f'"},
        {"vertical tab", "34.25 103.5", "34.25\v103.5", 19, "6 columns, expected 7"},
        {"a very long word", "103.5", std::string(100000, '7') + "x", 19,
         "V is '777777777777777777777777777777...', expected"}}));

TEST(MatchFile, EmptyTextHasNoLine) {
  for (const std::string_view text : {"", "\xef\xbb\xbf"}) {
    FramePair pair;
    std::string error;
    EXPECT_FALSE(ParseMatches(text, "x.matches", &pair, &error));
    EXPECT_EQ(error,
              "x.matches: the file ends without a 'format' line, expected 'format rigmatch 1'");
  }
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ParseMatches(std::string_view(), "x.matches", &pair, &error));
}

TEST(MatchFile, Utf16IsToldApart) {
  std::string text = "\xff\xfe";
  for (const char c : kValid) text += {c, '\0'};
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ParseMatches(text, "x.matches", &pair, &error));
  EXPECT_NE(error.find("NUL byte"), std::string::npos) << error;
}

TEST(MatchFile, Utf8SequenceNames) {
  const FramePair pair =
      MustParse(Replace(kValid, "loop-06", "Z\xc3\xbcrich-\xe2\x82\xac-\xf0\x9f\x9a\x97"));
  EXPECT_EQ(pair.sequence, "Z\xc3\xbcrich-\xe2\x82\xac-\xf0\x9f\x9a\x97");
}

TEST(MatchFile, PathDoesNotBreakTheMessage) {
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ParseMatches("rubbish", "a\nb\x1b.matches", &pair, &error));
  EXPECT_TRUE(IsOnePrintableLine(error)) << error;
  EXPECT_FALSE(ReadMatchFile("/nowhere/a\nb", &pair, &error));
  EXPECT_EQ(error, "/nowhere/a\\x0ab: cannot be opened: No such file or directory");
}

// Deterministic: a failure names its round. Cuts, copies and swaps lines, changes, inserts and
// removes bytes, and puts words in where they do not belong.
TEST(MatchFile, MutatedTextsNeverCrash) {
  const std::vector<std::string> words = {
      "nan",     "inf",      "-1",          "0",  "1e999", "2147483648",
      "-0",      "+",        "#",           "\n", "\r\n",  "\t",
      "matches", "camera 2", "format",      "1",  "1.",    std::string(1, '\0'),
      " ",       "\xff",     "\xef\xbb\xbf"};
  constexpr int kRounds = 20000;
  int num_parsed = 0;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE(round);
    Random random = Random::Stream(1, round);
    std::string text(kValid);
    for (int n = 1 + random.Index(4); n > 0; --n) {
      const size_t at = random.Index(static_cast<int>(text.size()) + 1);
      const size_t line_begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
      const size_t line_end = std::min(text.find('\n', at), text.size());
      const std::string line = text.substr(line_begin, line_end - line_begin);
      switch (random.Index(8)) {
        case 0:
          if (at < text.size()) text[at] = static_cast<char>(random.Index(256));
          break;
        case 1:
          text.erase(at, 1 + random.Index(3));
          break;
        case 2:
          text.insert(at, 1, static_cast<char>(random.Index(256)));
          break;
        case 3:
          text.insert(at, words[random.Index(static_cast<int>(words.size()))]);
          break;
        case 4:
          text.erase(line_begin, line.size() + 1);
          break;
        case 5:
          text.insert(line_begin, line + "\n");
          break;
        case 6:  // a line moves
          text.erase(line_begin, line.size() + 1);
          text.insert(std::min(text.find('\n', text.size() / 2), text.size()), "\n" + line);
          break;
        default:
          if (random.Index(4) == 0) text.resize(at);
          if (at < text.size() && text[at] >= '0' && text[at] <= '9') {
            text[at] = static_cast<char>('0' + random.Index(10));
          }
          break;
      }
    }
    // On the heap and of its exact size, so that AddressSanitizer sees a read past the end.
    const std::vector<char> exact(text.begin(), text.end());
    FramePair pair;
    std::string error;
    if (ParseMatches({exact.data(), exact.size()}, "x", &pair, &error)) {
      ++num_parsed;
      ASSERT_TRUE(pair.IsValid(&error)) << error;
      FramePair again;
      ASSERT_TRUE(ParseMatches(FormatMatches(pair), "x", &again, &error)) << error;
    } else {
      ASSERT_EQ(error.rfind("x:", 0), 0u) << error;
      ASSERT_TRUE(IsOnePrintableLine(error)) << error;
      ASSERT_LT(error.size(), 300u) << error;
    }
  }
  // Both outcomes are met often, or the mutations test nothing.
  EXPECT_GT(num_parsed, kRounds / 20);
  EXPECT_LT(num_parsed, kRounds / 2);
}

// Cut anywhere, a file is refused, except inside its very last number.
TEST(MatchFile, TruncationIsSeen) {
  for (size_t size = 0; size < kValid.size() - 2; ++size) {
    FramePair pair;
    std::string error;
    EXPECT_FALSE(ParseMatches(kValid.substr(0, size), "x", &pair, &error)) << size;
  }
}

TEST(MatchFile, WritesAndReadsAFile) {
  const TempDir dir;
  const std::string path = dir / "a.matches";
  FramePair pair = MustParse(kValid), read;
  std::string error;
  ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  ASSERT_TRUE(ReadMatchFile(path, &read, &error)) << error;
  EXPECT_EQ(read.name, path);
  ExpectSame(read, pair);
  EXPECT_EQ(ReadText(path), FormatMatches(pair));

  // A second write takes the place of the first and leaves nothing else behind.
  pair.noise_px.reset();
  ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  EXPECT_EQ(ReadText(path), FormatMatches(pair));
  EXPECT_EQ(dir.Names(), std::vector<std::string>{"a.matches"});
}

TEST(MatchFile, LargeFileSurvives) {
  const TempDir dir;
  FramePair pair = RandomPair(1), read;
  while (pair.matches.size() < 100000) {
    const std::vector<Match> copy = pair.matches;
    pair.matches.insert(pair.matches.end(), copy.begin(), copy.end());
  }
  pair.prior = {};
  std::string error;
  ASSERT_TRUE(WriteMatchFile(dir / "a.matches", pair, &error)) << error;
  ASSERT_TRUE(ReadMatchFile(dir / "a.matches", &read, &error)) << error;
  ExpectSame(read, pair);
}

TEST(MatchFile, ReadsWhatHasNoSize) {
  const TempDir dir;
  WriteText(dir / "a.matches", kValid);
  // A pipe, longer than the first buffer.
  std::string text(kValid);
  text.insert(0, "#" + std::string(300000, 'x') + "\n");
  WriteText(dir / "long", text);
  std::FILE* const pipe = popen(("cat '" + (dir / "long") + "'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  FramePair pair;
  std::string error;
  EXPECT_TRUE(ReadMatchFile("/dev/fd/" + std::to_string(fileno(pipe)), &pair, &error)) << error;
  pclose(pipe);
  ExpectSame(pair, MustParse(kValid));
}

TEST(MatchFile, UnreadableFilesAreNamed) {
  const TempDir dir;
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ReadMatchFile(dir / "none.matches", &pair, &error));
  EXPECT_EQ(error, dir / "none.matches: cannot be opened: No such file or directory");
  EXPECT_FALSE(ReadMatchFile(dir.path(), &pair, &error));
  EXPECT_EQ(error, dir.path() + ": cannot be read: Is a directory");
  WriteText(dir / "bad.matches", "format rigmatch 1\nhello\n");
  EXPECT_FALSE(ReadMatchFile(dir / "bad.matches", &pair, &error));
  EXPECT_EQ(error.rfind(dir / "bad.matches:2: unknown keyword 'hello'", 0), 0u) << error;
}

TEST(MatchFile, FailedWritesLeaveTheOldFile) {
  const TempDir dir;
  const std::string path = dir / "a.matches";
  const FramePair pair = MustParse(kValid);
  std::string error;
  ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  const std::string old = ReadText(path);

  EXPECT_FALSE(WriteMatchFile(dir / "none/a.matches", pair, &error));
  EXPECT_NE(error.find("none/a.matches: cannot be written: "), std::string::npos) << error;
  EXPECT_NE(error.find("/none does not exist"), std::string::npos) << error;
  EXPECT_EQ(error.find("temporary"), std::string::npos) << error;
  fs::create_directory(dir / "folder");
  EXPECT_FALSE(WriteMatchFile(dir / "folder", pair, &error));
  EXPECT_NE(error.find("Is a directory"), std::string::npos) << error;
  fs::remove(dir / "folder");

  // A device that takes 300 bytes stands for a full disk: a short text fails when the buffer is
  // flushed at closing, a long one while it is written.
  FramePair large = pair;
  large.matches.resize(100000);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit, small;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  small = limit;
  small.rlim_cur = 300;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string short_error, long_error;
  const bool short_written = WriteMatchFile(path, pair, &short_error);
  const bool long_written = WriteMatchFile(path, large, &long_error);
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_GT(old.size(), 300u);
  EXPECT_FALSE(short_written);
  EXPECT_FALSE(long_written);
  for (const std::string& message : {short_error, long_error}) {
    EXPECT_EQ(message.rfind(path + ": cannot be written: ", 0), 0u) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  }
  EXPECT_EQ(ReadText(path), old);
  EXPECT_EQ(dir.Names(), std::vector<std::string>{"a.matches"});
}

TEST(MatchFile, WhatCannotBeReadBackIsNotWritten) {
  const TempDir dir;
  const std::string path = dir / "a.matches";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* phrase;
    void (*spoil)(FramePair*, double);
  } cases[] = {
      {"V2 is 'nan'", [](FramePair* p, double x) { p->matches[1].pixel2.y() = x; }},
      {"SCORE is 'nan'", [](FramePair* p, double x) { p->matches[1].score = x; }},
      {"declared camera", [](FramePair* p, double) { p->matches[1].camera1 = 2; }},
      {"WIDTH is '0'", [](FramePair* p, double) { p->rig.cameras[1].intrinsics.width = 0; }},
      {"QW is 'nan'", [](FramePair* p, double x) { p->truth->R(0, 0) = x; }},
      {"direction has norm 2", [](FramePair* p, double) { *p->prior.axis *= 2; }},
      {"S is", [](FramePair* p, double) { p->prior.axis_sigma = 0; }},
      {"S is", [](FramePair* p, double x) { p->prior.axis_sigma = x; }},
      {"SIGMA is '0'", [](FramePair* p, double) { p->prior.distance_sigma = 0; }},
      {"no 'camera'", [](FramePair* p, double) { p->rig.cameras.clear(); }},
      {"one time", [](FramePair* p, double) { p->time2.reset(); }},
      {"T1 is 'nan'", [](FramePair* p, double x) { p->time1 = x; }},
      {"sequence", [](FramePair* p, double) { p->sequence = "a b"; }},
      {"without blanks", [](FramePair* p, double) { p->sequence = "a\n# b"; }},
      {"1 column", [](FramePair* p, double) { p->sequence = " "; }},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.phrase);
    FramePair pair = MustParse(kValid);
    c.spoil(&pair, nan);
    std::string error;
    EXPECT_FALSE(WriteMatchFile(path, pair, &error));
    EXPECT_EQ(error.rfind(path + ": not written, ", 0), 0u) << error;
    EXPECT_NE(error.find(c.phrase), std::string::npos) << error;
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
  }
  EXPECT_TRUE(dir.Names().empty());
}

TEST(ListMatchFiles, FilesAndDirectoriesInOrder) {
  const TempDir dir;
  fs::create_directories(dir / "d/below.matches");
  fs::create_directories(dir / "empty");
  for (const char* name :
       {"d/b.matches", "d/B.matches", "d/a10.matches", "d/a9.matches", "d/\xc3\xa4.matches",
        "d/a.txt", "d/amatches", "d/a.matches.tmp0", "d/below.matches/x.matches", "other.txt"}) {
    WriteText(dir / name, "");
  }
  const std::vector<std::string> in_d = {dir / "d/B.matches", dir / "d/a10.matches",
                                         dir / "d/a9.matches", dir / "d/b.matches",
                                         dir / "d/\xc3\xa4.matches"};
  std::vector<std::string> errors;
  EXPECT_EQ(ListMatchFiles(dir / "d", &errors), in_d);
  EXPECT_EQ(ListMatchFiles(dir / "d/", &errors), in_d);
  EXPECT_TRUE(errors.empty());

  std::vector<std::string> expected = {dir / "other.txt"};
  expected.insert(expected.end(), in_d.begin(), in_d.end());
  expected.push_back(dir / "d/b.matches");
  const std::string list = (dir / "other.txt") + "," + (dir / "none") + "," + (dir / "d") + ",," +
                           (dir / "empty") + "," + (dir / "d/b.matches");
  EXPECT_EQ(ListMatchFiles(list, &errors), expected);
  EXPECT_EQ(errors,
            (std::vector<std::string>{dir / "none: cannot be opened: No such file or directory",
                                      dir / "empty: no .matches files in this directory"}));
}

TEST(ListMatchFiles, NothingGivesNothing) {
  std::vector<std::string> errors;
  EXPECT_TRUE(ListMatchFiles("", &errors).empty());
  EXPECT_TRUE(ListMatchFiles(",", &errors).empty());
  EXPECT_TRUE(errors.empty());
}

TEST(MatchFile, RealDataReads) {
  const char* const root = std::getenv("RIGEL_REAL_DATA");
  if (root == nullptr || *root == '\0') GTEST_SKIP() << "RIGEL_REAL_DATA is not set";
  int num_files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".matches") continue;
    const std::string path = entry.path().string();
    SCOPED_TRACE(path);
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    EXPECT_TRUE(pair.IsValid(&error)) << error;
    EXPECT_GT(pair.matches.size(), 100u);
    EXPECT_TRUE(pair.truth.has_value());
    ExpectSame(MustParse(FormatMatches(pair)), pair);
    ++num_files;
  }
  EXPECT_GT(num_files, 0) << "no .matches file below " << root;
}

}  // namespace
}  // namespace rigel
