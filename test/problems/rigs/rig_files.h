// What the tests of calibration formats share: a folder with files, and reading them.
#ifndef RIGEL_TEST_PROBLEMS_RIGS_RIG_FILES_H_
#define RIGEL_TEST_PROBLEMS_RIGS_RIG_FILES_H_

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/rigs/rig_formats.h"

namespace rigel {

// `text` with the first `from` replaced.
inline std::string With(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class RigFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = testing::TempDir() + "/rigel_rigs_XXXXXX";
    ASSERT_NE(mkdtemp(root_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  std::string Path(const std::string& name) const { return root_ + "/" + name; }

  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(Path(name)).parent_path());
    std::ofstream(Path(name), std::ios::binary) << text;
  }

  // Reads a file of the format, which must also be told from what is in it. Written as a rig file
  // it must be the same rig.
  Calibration Read(const std::string& name, const std::string& format) const {
    Calibration calibration;
    std::string error, told;
    EXPECT_TRUE(DetectRigFormat(Path(name), &told, &error)) << error;
    EXPECT_EQ(told, detected_.empty() ? format : detected_);
    EXPECT_TRUE(ReadRigCalibration(Path(name), format, options_, &calibration, &error)) << error;
    RigFile again;
    EXPECT_TRUE(ParseRigFile(RigFileText(calibration.rig), "again", &again, &error)) << error;
    ExpectSame(calibration.rig, again);
    return calibration;
  }

  // The message where the file cannot be read: one line that begins with a path below the folder.
  std::string Error(const std::string& name, const std::string& format) const {
    Calibration calibration;
    std::string error;
    EXPECT_FALSE(ReadRigCalibration(Path(name), format, options_, &calibration, &error));
    EXPECT_THAT(error, testing::StartsWith(root_));
    EXPECT_THAT(error, testing::Not(testing::HasSubstr("\n")));
    EXPECT_TRUE(calibration.rig.rig.cameras.empty());
    return error;
  }

  static void ExpectSame(const RigFile& a, const RigFile& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.down, b.down);
    EXPECT_EQ(a.forward, b.forward);
    EXPECT_EQ(a.ground_m, b.ground_m);
    EXPECT_EQ(a.camera_names, b.camera_names);
    EXPECT_EQ(a.camera_images, b.camera_images);
    ASSERT_EQ(a.rig.size(), b.rig.size());
    for (int k = 0; k < a.rig.size(); ++k) {
      const RigCamera &one = a.rig.cameras[k], &other = b.rig.cameras[k];
      EXPECT_TRUE(SameLens(one.intrinsics, other.intrinsics));
      EXPECT_EQ(one.intrinsics.width, other.intrinsics.width);
      EXPECT_EQ(one.intrinsics.height, other.intrinsics.height);
      EXPECT_LT((one.Q - other.Q).norm(), 1e-15);
      EXPECT_EQ(one.s, other.s);
      EXPECT_EQ(one.time_offset, other.time_offset);
    }
  }

  static void ExpectPose(const RigCamera& camera, const Eigen::Matrix3d& Q,
                         const Eigen::Vector3d& s) {
    EXPECT_LT((camera.Q - Q).norm(), 1e-12) << camera.Q;
    EXPECT_LT((camera.s - s).norm(), 1e-12) << camera.s.transpose();
  }

  static void ExpectLens(const RigCamera& camera, const Camera& lens) {
    EXPECT_STREQ(CameraModelName(camera.intrinsics.model), CameraModelName(lens.model));
    for (int k = 0; k < NumCameraParameters(lens.model); ++k) {
      EXPECT_NEAR(camera.intrinsics.parameters[k], lens.parameters[k], 1e-12) << k;
    }
    EXPECT_EQ(camera.intrinsics.width, lens.width);
    EXPECT_EQ(camera.intrinsics.height, lens.height);
  }

  CalibrationOptions options_;
  std::string detected_;  // what the file looks like, if it is another format

 private:
  std::string root_;
};

// A turn about z of 3-4-5, which files can state exactly.
inline Eigen::Matrix3d TurnZ() {
  Eigen::Matrix3d R;
  R << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  return R;
}

// A file, what is changed in it, and what its message says.
struct BrokenCase {
  std::string from, to, phrase;
};

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_RIGS_RIG_FILES_H_
