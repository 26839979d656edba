// KITTI's layout: what is read, where the cameras are, what breaks it.
#include "rigel/problems/images/kitti_sequence.h"

#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/core/pinhole.h"
#include "rigel/test/problems/images/plane_scene.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kCalibration[] =
    "P0: 7.070912e+02 0 6.018873e+02 0 0 7.070912e+02 1.831104e+02 0 0 0 1 0\n"
    "P1: 7.070912e+02 0 6.018873e+02 -3.798145e+02 0 7.070912e+02 1.831104e+02 0 0 0 1 0\n"
    "P2: 7.070912e+02 0 6.018873e+02 4.688783e+01 0 7.070912e+02 1.831104e+02 1.178601e-01 "
    "0 0 1 6.203223e-03\n"
    "P3: 7.070912e+02 0 6.018873e+02 -3.334597e+02 0 7.070912e+02 1.831104e+02 1.930130e+00 "
    "0 0 1 3.318498e-03\n";

class KittiSequence : public testing::Test {
 protected:
  void SetUp() override {
    root_ = testing::TempDir() + "/rigel_kitti_XXXXXX";
    ASSERT_NE(mkdtemp(root_.data()), nullptr);
    Write("sequences/06/calib.txt", kCalibration);
    for (const char* image : {"image_0/000000.png", "image_0/000003.png", "image_0/000002.png",
                              "image_0/cover.png", "image_1/000001.png", "image_1/7.png"}) {
      Write(std::string("sequences/06/") + image, "");
    }
  }
  void TearDown() override { fs::remove_all(root_); }

  void Write(const std::string& name, const std::string& text) {
    WriteFile(root_ + "/" + name, text);
  }
  void Remove(const std::string& name) { fs::remove_all(root_ + "/" + name); }

  ImageSequence Read() {
    ImageSequence sequence;
    std::string error;
    EXPECT_TRUE(ReadKittiSequence(root_, "06", &sequence, &error)) << error;
    return sequence;
  }
  std::string Error() {
    ImageSequence sequence;
    std::string error;
    EXPECT_FALSE(ReadKittiSequence(root_, "06", &sequence, &error));
    EXPECT_THAT(error, testing::StartsWith(root_));
    EXPECT_THAT(error, testing::Not(HasSubstr("\n")));
    return error;
  }

  std::string root_;
};

TEST_F(KittiSequence, GreyCamerasAndAllFramesUpToTheLastImage) {
  const ImageSequence sequence = Read();
  EXPECT_EQ(sequence.name, "06");
  EXPECT_THAT(sequence.notes, IsEmpty());
  EXPECT_EQ(sequence.world_down, Eigen::Vector3d::UnitY());
  ASSERT_EQ(sequence.cameras.size(), 2u);
  for (const ImageCamera& camera : sequence.cameras) {
    EXPECT_FALSE(camera.lens.has_value());
    EXPECT_TRUE(camera.camera.Q.isIdentity(0));
    const Camera& c = camera.camera.intrinsics;
    EXPECT_EQ(c.fx(), 707.0912);
    EXPECT_EQ(c.fy(), 707.0912);
    EXPECT_EQ(c.cx(), 601.8873);
    EXPECT_EQ(c.cy(), 183.1104);
  }
  EXPECT_EQ(sequence.cameras[0].camera.s, Eigen::Vector3d::Zero());
  // P = K [I | t]: the right camera is at -t.
  EXPECT_NEAR((sequence.cameras[1].camera.s - Eigen::Vector3d(379.8145 / 707.0912, 0, 0)).norm(), 0,
              1e-12);
  ASSERT_EQ(sequence.frames.size(), 4u);
  EXPECT_THAT(sequence.frames[2].images,
              testing::ElementsAre(root_ + "/sequences/06/image_0/000002.png",
                                   root_ + "/sequences/06/image_1/000002.png"));
  EXPECT_FALSE(sequence.frames[0].time || sequence.frames[0].world_from_body);
}

// A point projects through P as through the camera's place and K.
TEST_F(KittiSequence, ColourCamerasAreWhereTheirProjectionsSay) {
  fs::rename(root_ + "/sequences/06/image_0", root_ + "/sequences/06/image_2");
  fs::rename(root_ + "/sequences/06/image_1", root_ + "/sequences/06/image_3");
  const ImageSequence sequence = Read();
  EXPECT_THAT(sequence.frames[0].images[1], testing::EndsWith("image_3/000000.png"));
  Eigen::Matrix<double, 3, 4> P2, P3;
  P2 << 707.0912, 0, 601.8873, 46.88783, 0, 707.0912, 183.1104, 0.1178601, 0, 0, 1, 0.006203223;
  P3 << 707.0912, 0, 601.8873, -333.4597, 0, 707.0912, 183.1104, 1.930130, 0, 0, 1, 0.003318498;
  const Eigen::Vector3d X(1.5, -0.5, 7);
  const Eigen::Vector2d expected[] = {(P2 * X.homogeneous()).hnormalized(),
                                      (P3 * X.homogeneous()).hnormalized()};
  for (int k = 0; k < 2; ++k) {
    const RigCamera& camera = sequence.cameras[k].camera;
    const Eigen::Vector2d pixel =
        ProjectPinhole(camera.intrinsics, camera.Q.transpose() * (X - camera.s));
    EXPECT_NEAR((pixel - expected[k]).norm(), 0, 1e-9);
  }
}

TEST_F(KittiSequence, TimesAndPosesOfTheirLines) {
  Write("sequences/06/times.txt", "0.0\n1.036200e-01\r\n2.072400e-01\n");
  Write("poses/06.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.5 0 1 0 0 0 0 1 2\n");
  const ImageSequence sequence = Read();
  EXPECT_EQ(sequence.frames[1].time, 0.10362);
  EXPECT_FALSE(sequence.frames[3].time.has_value());
  ASSERT_TRUE(sequence.frames[1].world_from_body.has_value());
  EXPECT_EQ(sequence.frames[1].world_from_body->t, Eigen::Vector3d(0.5, 0, 2));
  EXPECT_FALSE(sequence.frames[2].world_from_body.has_value());
  EXPECT_THAT(sequence.notes, testing::ElementsAre(HasSubstr("times.txt: 3 lines for 4 frames"),
                                                   HasSubstr("06.txt: 2 lines for 4 frames")));
}

TEST_F(KittiSequence, NumbersThatAreLeftOutCostNothing) {
  Write("sequences/06/image_1/9999999.png", "");
  Write("sequences/06/image_1/10000000.png", "");
  Write("sequences/06/times.txt", "0\n1\n2\n3\n4\n");
  const ImageSequence sequence = Read();
  EXPECT_EQ(sequence.frames.size(), 10000001u);
  EXPECT_THAT(sequence.frames.numbers(), testing::ElementsAre(0, 1, 2, 3, 9999999, 10000000));
  EXPECT_EQ(sequence.frames.Find(4), nullptr);
  EXPECT_EQ(sequence.image_path(4, 1), root_ + "/sequences/06/image_1/000004.png");
  EXPECT_EQ(sequence.frames[3].time, 3.0);
  EXPECT_THAT(sequence.frames[9999999].images[0], testing::EndsWith("image_0/9999999.png"));
  for (const char* image : {"2147483647.png", "10000001.png", "9999999999999.png"}) {
    Write("sequences/06/image_1/" + std::string(image), "");
    EXPECT_THAT(Error(),
                HasSubstr(image + std::string(": expected an image number up to 10000000")));
    Remove("sequences/06/image_1/" + std::string(image));
  }
}

// A line that is skipped would give each later frame the time, or the truth, of its successor.
TEST_F(KittiSequence, BlankLinesAndCommentsShiftNoFrame) {
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  Write("sequences/06/times.txt", "0.0\n\n0.2\n0.3\n");
  EXPECT_THAT(Error(), HasSubstr("times.txt:2: a blank line, expected that of frame 1"));
  Write("sequences/06/times.txt", "# seconds\n0.0\n0.1\n");
  EXPECT_THAT(Error(), HasSubstr("times.txt:1: a comment"));
  Write("sequences/06/times.txt", "0.0\n0.1\n0.2\n0.3\n\n");
  Write("poses/06.txt", pose + pose + " \t\n" + pose);
  EXPECT_THAT(Error(), HasSubstr("06.txt:3: a blank line, expected that of frame 2"));
  Write("poses/06.txt", pose + "#" + pose);
  EXPECT_THAT(Error(), HasSubstr("06.txt:2: a comment"));
  Write("poses/06.txt", pose + pose + pose + pose + "\r\n");
  EXPECT_EQ(Read().frames[3].time, 0.3);
}

TEST_F(KittiSequence, ByteOrderMarksAreSkipped) {
  const std::string mark = "\xef\xbb\xbf";
  Write("sequences/06/calib.txt", mark + kCalibration);
  Write("sequences/06/times.txt", mark + "0.5\n0.6\n0.7\n0.8\n");
  Write("poses/06.txt", mark + "1 0 0 0 0 1 0 0 0 0 1 7\n");
  const ImageSequence sequence = Read();
  EXPECT_EQ(sequence.frames[0].time, 0.5);
  EXPECT_EQ(sequence.frames[0].world_from_body->t.z(), 7);
  Write("sequences/06/calib.txt",
        "\xfe\xff"
        "P0");
  EXPECT_THAT(Error(), HasSubstr("calib.txt: UTF-16, by its byte order mark, expected UTF-8 text"));
}

TEST_F(KittiSequence, OtherCamerasAreTold) {
  Write("sequences/06/image_2/000000.png", "");
  Write("sequences/06/image_3/000000.png", "");
  EXPECT_THAT(Read().notes, testing::ElementsAre(HasSubstr(
                                "06: not used: image_2, image_3; the rig is image_0 and image_1")));
}

TEST_F(KittiSequence, WhatIsMissingIsNamed) {
  Remove("sequences/06/image_1");
  EXPECT_THAT(Error(), HasSubstr("expected image_0 and image_1 in it, or image_2 and image_3"));
  Write("sequences/06/image_1/other.png", "");
  Remove("sequences/06/image_0");
  fs::create_directory(root_ + "/sequences/06/image_0");
  EXPECT_THAT(Error(), HasSubstr("image_0: no images (000000.png, ...)"));
  Remove("sequences/06/calib.txt");
  EXPECT_THAT(Error(), HasSubstr("calib.txt: cannot be opened: No such file"));
  Remove("sequences");
  EXPECT_THAT(Error(), HasSubstr("sequences/06: no such directory"));
}

TEST_F(KittiSequence, BrokenFilesAreToldWithTheirLines) {
  const std::pair<std::string, const char*> calibrations[] = {
      {"", "calib.txt: no line 'P0:'"},
      {"P0: 1 0 0 0 0 1 0 0 0 0 1 0\n",
       "calib.txt: no line 'P1:', expected P1: and the 12 numbers"},
      {"\nP0: 1 0 0 0 0 1 0 0 0 0 1\n", "calib.txt:2: P0: 11 numbers, expected 12"},
      {"P0: 1 0 0 0 0 1 0 0 0 0 1 0 0\n", "calib.txt:1: P0: 13 numbers, expected 12"},
      {"P0: 1 0 0 0 0 1 0 x7 0 0 1 0\n", "calib.txt:1: P0: number 8 is 'x7'"},
      {"P0: 1 0 0 0 0 1 0 nan 0 0 1 0\n", "calib.txt:1: P0: number 8 is 'nan'"},
      {"P0: 0 0 0 0 0 1 0 0 0 0 1 0\n", "calib.txt:1: P0: expected the projection of a rectified"},
      {"P0: 1 0.1 0 0 0 1 0 0 0 0 1 0\n", "calib.txt:1: P0: expected the projection"},
      {"P0: 1 0 0 0 0 1 0 0 0 0 2 0\n", "calib.txt:1: P0: expected the projection"},
  };
  for (const auto& [text, what] : calibrations) {
    Write("sequences/06/calib.txt", text);
    EXPECT_THAT(Error(), HasSubstr(what));
  }
  Write("sequences/06/calib.txt", kCalibration);
  Write("sequences/06/times.txt", "0\n0.1 0.2\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("times.txt:2: '0.1 0.2'"), HasSubstr("seconds")));
  Remove("sequences/06/times.txt");
  Write("poses/06.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0\n");
  EXPECT_THAT(Error(), HasSubstr("poses/06.txt:2: 2 numbers, expected 12"));
}

}  // namespace
}  // namespace rigel
