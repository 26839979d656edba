// Texts of match files for the tests of their reader and writer: one of every field, random ones,
// and a directory to write them to.
#ifndef RIGEL_TEST_PROBLEMS_IO_MATCH_FILE_TEXT_H_
#define RIGEL_TEST_PROBLEMS_IO_MATCH_FILE_TEXT_H_

#include <algorithm>
#include <cmath>
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
#include "rigel/problems/io/match_file.h"
#include "rigel/test/core/random_vector.h"

namespace rigel {

namespace fs = std::filesystem;

// Each keyword once, a comment, a blank line. Tests of broken files name its lines by number.
inline constexpr std::string_view kValid =
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
inline std::string Replace(std::string_view text, std::string_view from, std::string_view to) {
  std::string out(text);
  const size_t at = out.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? out : out.replace(at, from.size(), to);
}

inline std::string ReplaceAll(std::string text, std::string_view from, std::string_view to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

inline bool IsOnePrintableLine(const std::string& message) {
  return !message.empty() && std::all_of(message.begin(), message.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
  });
}

inline FramePair MustParse(std::string_view text) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(ParseMatches(text, "x.matches", &pair, &error)) << error;
  EXPECT_TRUE(pair.IsValid(&error)) << error;
  return pair;
}

// Exact but for rotations, which pass through a quaternion.
inline void ExpectSame(const FramePair& a, const FramePair& b) {
  constexpr double kRotationTolerance = 2e-15;
  EXPECT_EQ(a.sequence, b.sequence);
  ASSERT_EQ(a.rig.size(), b.rig.size());
  for (int k = 0; k < a.rig.size(); ++k) {
    const RigCamera& ca = a.rig.cameras[k];
    const RigCamera& cb = b.rig.cameras[k];
    EXPECT_TRUE(SameLens(ca.intrinsics, cb.intrinsics));
    EXPECT_EQ(ca.intrinsics.width, cb.intrinsics.width);
    EXPECT_EQ(ca.intrinsics.height, cb.intrinsics.height);
    EXPECT_LT((ca.Q - cb.Q).cwiseAbs().maxCoeff(), kRotationTolerance);
    EXPECT_EQ(ca.s, cb.s);
    EXPECT_EQ(ca.rotation_sigma, cb.rotation_sigma);
    EXPECT_EQ(ca.position_sigma, cb.position_sigma);
    EXPECT_EQ(ca.focal_sigma, cb.focal_sigma);
    EXPECT_EQ(ca.time_offset, cb.time_offset);
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
  EXPECT_EQ(a.prior.forward, b.prior.forward);
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
  EXPECT_EQ(a.columns.landmark, b.columns.landmark);
  EXPECT_EQ(a.columns.sigma1, b.columns.sigma1);
  EXPECT_EQ(a.columns.sigma2, b.columns.sigma2);
  EXPECT_EQ(a.columns.depth1, b.columns.depth1);
  EXPECT_EQ(a.columns.depth_sigma, b.columns.depth_sigma);
  EXPECT_EQ(a.columns.affine, b.columns.affine);
  EXPECT_EQ(a.columns.affine_sigma, b.columns.affine_sigma);
  EXPECT_EQ(a.columns.inlier, b.columns.inlier);
  EXPECT_EQ(a.columns.exact, b.columns.exact);
}

// A pair with everything in it and numbers of full length, over many magnitudes.
inline FramePair RandomPair(uint64_t seed) {
  Random random(seed);
  const auto number = [&random] {
    const double magnitude = std::pow(10.0, random.Uniform(-12, 12));
    return magnitude * random.Normal();
  };
  const auto sigma = [&random] { return DegToRad(random.Uniform(1e-6, 30)); };
  const auto pose = [&random] {
    Pose p;
    p.R = ExpSO3(RandomVector3(0, kPi, &random));
    p.t = random.NormalVector3();
    return p;
  };
  FramePair pair;
  pair.name = "random";
  pair.sequence = "s" + std::to_string(seed);
  pair.rig.cameras.resize(1 + random.Index(12));
  for (RigCamera& camera : pair.rig.cameras) {
    camera.intrinsics = {CameraModel::kPinhole,
                         {random.Uniform(1, 1e4), random.Uniform(1, 1e4), number(), number()},
                         1 + random.Index(1 << 30),
                         1 + random.Index(1 << 30)};
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
  pair.prior.forward = random.UnitVector3();
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

inline void WriteText(const std::string& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string ReadText(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_IO_MATCH_FILE_TEXT_H_
