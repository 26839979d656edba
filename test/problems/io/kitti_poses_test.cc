// The format, and what breaks it.
#include "rigel/problems/io/kitti_poses.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr char kIdentity[] = "1 0 0 0 0 1 0 0 0 0 1 0\n";

class KittiPoses : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "/rigel_poses_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string Write(const std::string& name, const std::string& text) {
    const std::string path = directory_ + "/" + name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  std::string directory_;
};

TEST_F(KittiPoses, ReadsRowsOfTheMatrix) {
  std::vector<Pose> poses;
  std::string error;
  // Turned by 90 degrees about Y, blanks of all kinds, no line break at the end.
  ASSERT_TRUE(ReadKittiPoses(
      Write("a.txt", std::string(kIdentity) + "  0\t0 1.000000e+00 +4 0 1 0 -5 -1 0 0 6.5"), &poses,
      &error))
      << error;
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_TRUE(poses[0].R.isIdentity());
  EXPECT_NEAR((poses[1].R - RotationY(kPi / 2)).norm(), 0.0, 1e-12);
  EXPECT_EQ(poses[1].t, Eigen::Vector3d(4, -5, 6.5));
}

TEST_F(KittiPoses, RoundedRotationsAreMadeOrthonormal) {
  std::vector<Pose> poses;
  std::string error;
  ASSERT_TRUE(
      ReadKittiPoses(Write("a.txt", "1.0002 0 0 0 0 1 0 0 0 0.0001 1 0\n"), &poses, &error));
  EXPECT_NEAR((poses[0].R.transpose() * poses[0].R - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);
}

TEST_F(KittiPoses, WhatIsBrokenIsToldWithFileAndLine) {
  const std::pair<const char*, const char*> broken[] = {
      {"1 0 0 0 0 1 0 0 0 0 1\n", "11 numbers, expected 12"},
      {"1 0 0 0 0 1 0 0 0 0 1 0 0\n", "13 numbers, expected 12"},
      {"1 0 0 x 0 1 0 0 0 0 1 0\n", "number 4 is 'x', expected a finite number"},
      {"1 0 0 nan 0 1 0 0 0 0 1 0\n", "number 4 is 'nan', expected a finite number"},
      {"1 0 0 1e999 0 1 0 0 0 0 1 0\n", "number 4 is '1e999', expected a finite number"},
      {"1 0 0 0,5 0 1 0 0 0 0 1 0\n", "number 4 is '0,5', expected a finite number"},
      {"1 0 0 + 0 1 0 0 0 0 1 0\n", "number 4 is '+', expected a finite number"},
      {"1.01 0 0 0 0 1 0 0 0 0 1 0\n", "not a rotation"},
      {"1 0 0 0 0 1 0 0 0 0 -1 0\n", "not a rotation"},
      {"0 0 0 0 0 0 0 0 0 0 0 0\n", "not a rotation"},
  };
  for (const auto& [line, what] : broken) {
    const std::string path = Write("a.txt", std::string(kIdentity) + kIdentity + line + kIdentity);
    std::vector<Pose> poses(7);
    std::string error;
    EXPECT_FALSE(ReadKittiPoses(path, &poses, &error)) << line;
    EXPECT_THAT(error, HasSubstr(path + ":3: "));
    EXPECT_THAT(error, HasSubstr(what));
    EXPECT_EQ(poses.size(), 7u);
  }
  std::vector<Pose> poses;
  std::string error;
  // A line that is skipped would give each later frame the pose of another.
  EXPECT_FALSE(
      ReadKittiPoses(Write("b.txt", std::string(kIdentity) + "\n" + kIdentity), &poses, &error));
  EXPECT_THAT(error, HasSubstr("b.txt:2: a blank line"));
  EXPECT_FALSE(ReadKittiPoses(Write("b.txt", "\n"), &poses, &error));
  EXPECT_THAT(error, EndsWith("b.txt: there is no pose in it"));
  EXPECT_FALSE(ReadKittiPoses(directory_ + "/none.txt", &poses, &error));
  EXPECT_THAT(error, HasSubstr("none.txt: cannot be opened"));
  EXPECT_FALSE(ReadKittiPoses(directory_, &poses, &error));
  EXPECT_THAT(error, HasSubstr("cannot be"));
}

}  // namespace
}  // namespace rigel
