// The reader of match files: every field, however the text looks and wherever it comes from.
#include "rigel/problems/io/match_file.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/core/camera_cases.h"
#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

TEST(MatchFile, ReadsEveryField) {
  const FramePair pair = MustParse(kValid);
  EXPECT_EQ(pair.name, "x.matches");
  EXPECT_EQ(pair.sequence, "loop-06");
  ASSERT_EQ(pair.rig.size(), 2);
  const RigCamera& c0 = pair.rig.cameras[0];
  EXPECT_EQ(c0.intrinsics.fx(), 700.5);
  EXPECT_EQ(c0.intrinsics.fy(), 701);
  EXPECT_EQ(c0.intrinsics.cx(), 600);
  EXPECT_EQ(c0.intrinsics.cy(), 180.25);
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

TEST(MatchFile, ReadsWhereTheFrontIs) {
  const std::string text =
      Replace(kValid, "normal_sigma_deg 2\n", "normal_sigma_deg 2\nforward 0.8 0 -0.6\n");
  EXPECT_EQ(MustParse(text).prior.forward, Eigen::Vector3d(0.8, 0, -0.6));
  EXPECT_NE(FormatMatches(MustParse(text)).find("\nforward 0.8 0 -0.6\n"), std::string::npos);
  // Files are as old as the format.
  EXPECT_FALSE(MustParse(kValid).prior.forward);
  EXPECT_EQ(FormatMatches(MustParse(kValid)).find("forward"), std::string::npos);
}

TEST(MatchFile, ReadsErrorsAndTimesOfCameras) {
  const std::string text =
      Replace(kValid, "camera 1", "camera_sigma 1 0.5 0.02\ncamera_time 1 -0.045\ncamera 1");
  const FramePair pair = MustParse(
      Replace(text, "noise_px", "camera_sigma 0 1 0.01 0.001\ncamera_time 0 0\nnoise_px"));
  const RigCamera& c0 = pair.rig.cameras[0];
  EXPECT_DOUBLE_EQ(c0.rotation_sigma, kPi / 180);
  EXPECT_EQ(c0.position_sigma, 0.01);
  EXPECT_EQ(c0.focal_sigma, 0.001);
  EXPECT_EQ(c0.time_offset, 0);
  const RigCamera& c1 = pair.rig.cameras[1];
  EXPECT_DOUBLE_EQ(c1.rotation_sigma, 0.5 * kPi / 180);
  EXPECT_EQ(c1.position_sigma, 0.02);
  EXPECT_EQ(c1.focal_sigma, 0);
  EXPECT_EQ(c1.time_offset, -0.045);
  const std::string written = FormatMatches(pair);
  EXPECT_NE(written.find("\ncamera_sigma 0 1 0.01 0.001\ncamera_sigma 1 0.5 0.02\n"
                         "camera_time 1 -0.045\n"),
            std::string::npos);
  ExpectSame(MustParse(written), pair);
}

TEST(MatchFile, ReadsAndWritesEachCameraModel) {
  for (const CameraCase& camera_case : CameraCases()) {
    SCOPED_TRACE(camera_case.name);
    FramePair pair = MustParse(kValid);
    pair.rig.cameras[1].intrinsics = camera_case.camera;
    const std::string text = FormatMatches(pair);
    EXPECT_NE(text.find(std::string("\ncamera 1 ") + CameraModelName(camera_case.camera.model)),
              std::string::npos);
    ExpectSame(MustParse(text), pair);
  }
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
    // Of those recorded standing on a stick there is none.
    EXPECT_EQ(pair.truth.has_value(), path.find("/hilti_") == std::string::npos);
    ExpectSame(MustParse(FormatMatches(pair)), pair);
    ++num_files;
  }
  EXPECT_GT(num_files, 0) << "no .matches file below " << root;
}

}  // namespace
}  // namespace rigel
