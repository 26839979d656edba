// Trajectories as motions, and the frames of what comes out.
#include "rigel/problems/scenes/driven_motion.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/metrics.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"

namespace rigel {
namespace {

using testing::HasSubstr;

constexpr char kIdentity[] = "1 0 0 0 0 1 0 0 0 0 1 0\n";

class DrivenMotions : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "/rigel_driven_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  void Write(const std::string& name, const std::string& text) {
    std::ofstream(directory_ + "/" + name, std::ios::binary) << text;
  }

  std::string directory_;
};

TEST_F(DrivenMotions, MotionsAreBetweenNeighboursOfOneFile) {
  std::string drive;
  for (int k = 0; k < 5; ++k) {
    drive += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
  }
  Write("01.txt", std::string(kIdentity) + kIdentity);
  Write("00.txt", drive);
  Write("notes.md", "no poses");
  std::vector<DrivenMotion> motions;
  std::string error;
  ASSERT_TRUE(ReadDrivenMotions(directory_, 1, &motions, &error)) << error;
  ASSERT_EQ(motions.size(), 5u);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(motions[k].sequence, "00");
    // The body moves along +z, so a point ahead comes nearer.
    EXPECT_NEAR((motions[k].body2_from_body1().t - Eigen::Vector3d(0, 0, -1)).norm(), 0, 1e-12);
  }
  EXPECT_EQ(motions[4].sequence, "01");
  EXPECT_EQ(motions[4].body2_from_body1().t.norm(), 0.0);

  ASSERT_TRUE(ReadDrivenMotions(directory_ + "/01.txt", 1, &motions, &error)) << error;
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].sequence, "01");

  ASSERT_TRUE(ReadDrivenMotions(directory_, 2, &motions, &error)) << error;
  ASSERT_EQ(motions.size(), 3u);
  EXPECT_EQ(motions[1].world_from_body1.t.z(), motions[0].world_from_body1.t.z() + 2.0);
  EXPECT_NEAR(motions[1].body2_from_body1().t.z(), -1.0, 1e-12);
  EXPECT_EQ(motions[2].sequence, "01");

  Write("02.txt", "1 2 3\n");
  EXPECT_FALSE(ReadDrivenMotions(directory_, 1, &motions, &error));
  EXPECT_THAT(error, HasSubstr("02.txt:1: 3 numbers"));
  EXPECT_FALSE(ReadDrivenMotions(directory_ + "/none", 1, &motions, &error));
  EXPECT_THAT(error, HasSubstr("none: cannot be listed"));
  std::filesystem::create_directory(directory_ + "/empty");
  EXPECT_FALSE(ReadDrivenMotions(directory_ + "/empty", 1, &motions, &error));
  EXPECT_THAT(error, HasSubstr("empty: no pose files"));
}

TEST_F(DrivenMotions, PairHasTheMotionAndExactPriors) {
  DrivenMotion motion;
  motion.sequence = "07";
  motion.world_from_body1 = {ExpSO3({0.02, 0.5, -0.01}), {3, 1, 2}};
  motion.world_from_body2 = {ExpSO3({0.03, 0.55, -0.02}), {3.5, 1, 3}};
  FramePair pair;
  std::string error;
  ASSERT_TRUE(MakeDrivenPair(SceneOptions(), 4, motion, &pair, &error)) << error;
  EXPECT_EQ(pair.sequence, "07");
  // One world point, seen from both bodies.
  const Eigen::Vector3d world(1, -2, 8);
  EXPECT_NEAR((*pair.truth * (motion.world_from_body1.Inverse() * world) -
               motion.world_from_body2.Inverse() * world)
                  .norm(),
              0, 1e-12);
  ASSERT_TRUE(pair.prior.gravity1 && pair.prior.gravity2 && pair.prior.axis);
  EXPECT_NEAR((motion.world_from_body1.R * *pair.prior.gravity1 - Eigen::Vector3d::UnitY()).norm(),
              0, 1e-12);
  EXPECT_NEAR((pair.truth->R * *pair.prior.gravity1 - *pair.prior.gravity2).norm(), 0, 1e-12);
  EXPECT_NEAR((pair.truth->R * *pair.prior.axis - *pair.prior.axis).norm(), 0, 1e-12);
  EXPECT_FALSE(pair.prior.normal.has_value());
  EXPECT_EQ(pair.matches.size(), 200u);

  motion.world_from_body2 = motion.world_from_body1;  // standing still
  ASSERT_TRUE(MakeDrivenPair(SceneOptions(), 4, motion, &pair, &error)) << error;
  EXPECT_LT(pair.truth->t.norm(), 1e-12);
  EXPECT_NEAR((*pair.prior.axis - Eigen::Vector3d::UnitY()).norm(), 0, 1e-12);
}

// The recorded trajectories, which are no part of the project: skipped where the environment
// variable RIGEL_REAL_DATA does not name them.
TEST(KittiOdometry, MotionsAreTheTruthOfTheMatchFiles) {
  const char* folder = std::getenv("RIGEL_REAL_DATA");
  if (folder == nullptr || *folder == '\0') {
    GTEST_SKIP() << "RIGEL_REAL_DATA is not set: no recorded poses to test with";
  }
  std::vector<DrivenMotion> motions;
  std::string error;
  ASSERT_TRUE(ReadDrivenMotions(std::string(folder) + "/kitti_odometry/poses", 1, &motions, &error))
      << error;
  EXPECT_EQ(motions.size(), 23190u);
  std::vector<DrivenMotion> drive;
  for (const DrivenMotion& motion : motions) {
    if (motion.sequence == "06") drive.push_back(motion);
  }
  std::vector<std::string> errors;
  const std::vector<std::string> paths =
      ListMatchFiles(std::string(folder) + "/kitti_stereo_06", &errors);
  ASSERT_EQ(paths.size(), 50u);
  for (size_t k = 0; k < paths.size(); ++k) {
    FramePair pair;
    ASSERT_TRUE(ReadMatchFile(paths[k], &pair, &error)) << error;
    const Pose motion = drive[k].body2_from_body1();
    EXPECT_LT(RotationError(pair.truth->R, motion.R), 1e-6);
    EXPECT_LT((pair.truth->t - motion.t).norm(), 1e-5);
    // The files' gravity is the same approximation.
    EXPECT_LT((*pair.prior.gravity1 - drive[k].world_from_body1.R.row(1).transpose()).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace rigel
