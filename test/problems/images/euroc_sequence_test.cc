// EuRoC's layout: what is read, how images become frames, what breaks it.
#include "rigel/problems/images/euroc_sequence.h"

#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/metrics.h"
#include "rigel/test/problems/images/plane_scene.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const PlaneScene& Scene() {
  static const auto* const scene = new PlaneScene();
  return *scene;
}

// `text` with the first `from` replaced.
std::string With(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class EurocSequence : public testing::Test {
 protected:
  void SetUp() override {
    root_ = testing::TempDir() + "/rigel_euroc_XXXXXX";
    ASSERT_NE(mkdtemp(root_.data()), nullptr);
    for (int k = 0; k < 2; ++k) {
      const std::string camera = "mav0/cam" + std::to_string(k);
      Write(camera + "/sensor.yaml", SensorYaml(Scene().cameras()[k]));
      Write(camera + "/data.csv", "#timestamp [ns],filename\n100,100.png\n200, a.png\n");
    }
  }
  void TearDown() override { fs::remove_all(root_); }

  void Write(const std::string& name, const std::string& text) {
    WriteFile(root_ + "/" + name, text);
  }
  ImageSequence Read(const std::string& below = "") {
    ImageSequence sequence;
    std::string error;
    EXPECT_TRUE(ReadEurocSequence(root_ + below, options_, &sequence, &error)) << error;
    return sequence;
  }
  std::string Error() {
    ImageSequence sequence;
    std::string error;
    EXPECT_FALSE(ReadEurocSequence(root_, options_, &sequence, &error));
    EXPECT_THAT(error, testing::StartsWith(root_));
    EXPECT_THAT(error, testing::Not(HasSubstr("\n")));
    return error;
  }

  std::string root_;
  EurocOptions options_;
};

TEST_F(EurocSequence, CamerasAreAsTheirSensorsSay) {
  for (const char* below : {"", "/mav0", "/mav0/"}) {
    const ImageSequence sequence = Read(below);
    EXPECT_EQ(sequence.name, fs::path(root_).filename().string());
    EXPECT_THAT(sequence.notes, IsEmpty());
    EXPECT_EQ(sequence.world_down, Eigen::Vector3d(0, 0, -1));
    ASSERT_EQ(sequence.cameras.size(), 2u);
    for (int k = 0; k < 2; ++k) {
      const ImageCamera& expected = Scene().cameras()[k];
      const ImageCamera& camera = sequence.cameras[k];
      EXPECT_NEAR((camera.camera.Q - expected.camera.Q).norm(), 0, 1e-12);
      EXPECT_EQ(camera.camera.s, expected.camera.s);
      EXPECT_EQ(camera.camera.intrinsics.fx(), expected.camera.intrinsics.fx());
      EXPECT_EQ(camera.camera.intrinsics.fy(), expected.camera.intrinsics.fy());
      EXPECT_EQ(camera.camera.intrinsics.cx(), expected.camera.intrinsics.cx());
      EXPECT_EQ(camera.camera.intrinsics.cy(), expected.camera.intrinsics.cy());
      EXPECT_EQ(camera.camera.intrinsics.width, 376);
      EXPECT_EQ(camera.camera.intrinsics.height, 240);
      ASSERT_TRUE(camera.lens.has_value());
      EXPECT_TRUE(SameLens(*camera.lens, *expected.lens));
    }
    ASSERT_EQ(sequence.frames.size(), 2u);
    EXPECT_THAT(sequence.frames[1].images[0], testing::EndsWith("mav0/cam0/data/a.png"));
    EXPECT_THAT(sequence.frames[1].images[1], testing::EndsWith("mav0/cam1/data/a.png"));
    EXPECT_DOUBLE_EQ(*sequence.frames[1].time, 200e-9);
    EXPECT_FALSE(sequence.frames[1].world_from_body.has_value());
  }
}

TEST_F(EurocSequence, FramesAreTheTimesThatBothCamerasHave) {
  Write("mav0/cam0/data.csv", "300,c.png\n100,a.png\n200,b.png\n400,d.png\n");
  Write("mav0/cam1/data.csv", "100,A.png\n300,C.png\n350,X.png\n");
  const ImageSequence sequence = Read();
  ASSERT_EQ(sequence.frames.size(), 2u);
  EXPECT_THAT(sequence.frames[0].images[0], testing::EndsWith("cam0/data/a.png"));
  EXPECT_THAT(sequence.frames[1].images[0], testing::EndsWith("cam0/data/c.png"));
  EXPECT_THAT(sequence.frames[1].images[1], testing::EndsWith("cam1/data/C.png"));
  EXPECT_THAT(
      sequence.notes,
      ElementsAre(HasSubstr("cam0/data.csv: 2 of 4 images are left out: no image of cam1"),
                  HasSubstr("cam1/data.csv: 1 of 3 images are left out: no image of cam0")));
}

// Recorded cameras are triggered some microseconds apart.
TEST_F(EurocSequence, StampsOfOneFrameMayDifferByTheTolerance) {
  Write("mav0/cam0/data.csv", "50000000,a.png\n100000000,b.png\n150000000,c.png\n");
  Write("mav0/cam1/data.csv", "50007000,A.png\n99988000,B.png\n156000000,C.png\n");
  const ImageSequence sequence = Read();
  ASSERT_EQ(sequence.frames.size(), 2u);
  EXPECT_THAT(sequence.frames[1].images[0], testing::EndsWith("cam0/data/b.png"));
  EXPECT_THAT(sequence.frames[1].images[1], testing::EndsWith("cam1/data/B.png"));
  EXPECT_EQ(sequence.frames[1].time, 0.1) << "of cam0";
  EXPECT_THAT(sequence.settings, ElementsAre("sync_tolerance_ms default"));
  EXPECT_THAT(sequence.notes,
              ElementsAre(HasSubstr("cam0 and cam1 differ by up to 0.012 ms, within 5 ms, a tenth"),
                          HasSubstr("cam0/data.csv: 1 of 3 images"),
                          HasSubstr("cam1/data.csv: 1 of 3 images")));
  options_.sync_tolerance_ms = 6;
  EXPECT_EQ(Read().frames.size(), 3u);
  EXPECT_THAT(Read().settings, ElementsAre("sync_tolerance_ms 6"));
  options_.sync_tolerance_ms = 0.008;
  EXPECT_EQ(Read().frames.size(), 1u);
  options_.sync_tolerance_ms = 0;
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("no image of cam1 is of the time of one of cam0, within 0 ms"),
                    HasSubstr("the nearest are 0.007 ms apart")));
}

TEST_F(EurocSequence, PartnersAreEachOthersNearest) {
  // With a tolerance of more than the interval each would have several partners.
  options_.sync_tolerance_ms = 1e9;
  Write("mav0/cam0/data.csv", "100,a.png\n200,b.png\n300,c.png\n");
  Write("mav0/cam1/data.csv", "110,A.png\n190,B.png\n209,X.png\n390,C.png\n");
  const ImageSequence sequence = Read();
  ASSERT_EQ(sequence.frames.size(), 3u);
  EXPECT_THAT(sequence.frames[0].images[1], testing::EndsWith("A.png"));
  EXPECT_THAT(sequence.frames[1].images[1], testing::EndsWith("X.png"));
  EXPECT_THAT(sequence.frames[2].images[1], testing::EndsWith("C.png"));
}

TEST_F(EurocSequence, ByteOrderMarksAreSkipped) {
  const std::string mark = "\xef\xbb\xbf";
  for (const char* camera : {"cam0", "cam1"}) {
    Write(std::string("mav0/") + camera + "/data.csv", mark + "100,100.png\n200,a.png\n");
    Write(std::string("mav0/") + camera + "/sensor.yaml", mark + SensorYaml(Scene().cameras()[0]));
  }
  Write("mav0/state_groundtruth_estimate0/data.csv",
        mark + "100,1,2,3,1,0,0,0\n200,1,2,3,1,0,0,0\n");
  const ImageSequence sequence = Read();
  ASSERT_EQ(sequence.frames.size(), 2u);
  EXPECT_TRUE(sequence.frames[0].world_from_body.has_value());
  Write("mav0/cam0/data.csv",
        "\xff\xfe"
        "1\n");
  EXPECT_THAT(Error(), HasSubstr("cam0/data.csv: UTF-16, by its byte order mark"));
}

TEST_F(EurocSequence, OtherCamerasAreTold) {
  Write("mav0/cam2/data.csv", "");
  Write("mav0/cam3/data.csv", "");
  EXPECT_THAT(Read().notes, ElementsAre(HasSubstr("mav0/cam2: not used; the rig is cam0 and cam1"),
                                        HasSubstr("mav0/cam3: not used")));
}

TEST_F(EurocSequence, ImagesLieInTheirFolder) {
  for (const char* name : {"../a.png", "/etc/passwd", "x/../../../a.png"}) {
    Write("mav0/cam1/data.csv", std::string("100,100.png\n200,") + name + "\n");
    EXPECT_THAT(Error(), AllOf(HasSubstr("cam1/data.csv:2: '" + std::string(name) + "'"),
                               HasSubstr("leads out of the folder")));
  }
  Write("mav0/cam1/data.csv", "100,left/a..b.png\n");
  EXPECT_THAT(Read().frames[0].images[1], testing::EndsWith("cam1/data/left/a..b.png"));
}

TEST_F(EurocSequence, TruthIsInterpolatedWithinItsGaps) {
  std::string images;
  for (const char* time : {"1000000000", "1002500000", "1070000000", "1095000000", "2000000000"}) {
    images += std::string(time) + ",x.png\n";
  }
  for (const char* camera : {"cam0", "cam1"}) {
    Write(std::string("mav0/") + camera + "/data.csv", images);
  }
  Write("mav0/state_groundtruth_estimate0/data.csv",
        "#timestamp, p, q, v, b\n"
        "1000000000,1,2,3,1,0,0,0,9,9,9\n"
        "1010000000,2,2,3,0.980066577841242,0,0,0.198669330795061,9,9,9\n"
        "1090000000,0,0,0,1,0,0,0,9,9,9\n"
        "1095000000,5,0,0,-1,0,0,0,9,9,9\n");
  const ImageSequence sequence = Read();
  ASSERT_EQ(sequence.frames.size(), 5u);
  ASSERT_TRUE(sequence.frames[0].world_from_body && sequence.frames[1].world_from_body);
  EXPECT_EQ(sequence.frames[0].world_from_body->t, Eigen::Vector3d(1, 2, 3));
  // A quarter of the way; the second pose is turned by 0.4 rad about z.
  EXPECT_NEAR((sequence.frames[1].world_from_body->t - Eigen::Vector3d(1.25, 2, 3)).norm(), 0,
              1e-12);
  EXPECT_NEAR((LogSO3(sequence.frames[1].world_from_body->R) - Eigen::Vector3d(0, 0, 0.1)).norm(),
              0, 1e-9);
  EXPECT_FALSE(sequence.frames[2].world_from_body.has_value()) << "80 ms without truth";
  ASSERT_TRUE(sequence.frames[3].world_from_body.has_value());
  EXPECT_EQ(sequence.frames[3].world_from_body->t, Eigen::Vector3d(5, 0, 0));
  EXPECT_FALSE(sequence.frames[4].world_from_body.has_value());
  EXPECT_THAT(sequence.notes, ElementsAre(HasSubstr("2 of 5 frames lie outside it or in a gap")));
}

// Pixels of other lenses are not moved to those of a pinhole, which would cut the image.
TEST_F(EurocSequence, OtherLensesKeepTheirPixels) {
  const std::string radtan = SensorYaml(Scene().cameras()[0]);
  Write("mav0/cam0/sensor.yaml", With(radtan, "radial-tangential", "equidistant"));
  const ImageSequence sequence = Read();
  EXPECT_EQ(sequence.cameras[0].camera.intrinsics.model, CameraModel::kOpencvFisheye);
  EXPECT_FALSE(sequence.cameras[0].lens.has_value());
  EXPECT_EQ(sequence.cameras[1].camera.intrinsics.model, CameraModel::kPinhole);
  EXPECT_TRUE(sequence.cameras[1].lens.has_value());
}

TEST_F(EurocSequence, BrokenSensorsAreTold) {
  const std::string good = SensorYaml(Scene().cameras()[0]);
  const std::pair<std::string, const char*> broken[] = {
      {With(good, "T_BS", "T_SB"), "the key T_BS is missing"},
      {With(good, "intrinsics", "intrinsic"), "the key intrinsics is missing"},
      {With(good, "resolution", "size"), "the key resolution is missing"},
      {With(good, "distortion_coefficients", "d"), "the key distortion_coefficients is missing"},
      {With(good, "distortion_model", "model"), "the key distortion_model is missing"},
      {With(good, "camera_model", "model"), "the key camera_model is missing"},
      {With(good, "radial-tangential", "spline"), "sensor.yaml:15: camera_model 'pinhole' with"},
      {With(good, "[229, ", "["), "sensor.yaml:16: intrinsics has 3 numbers, expected 4"},
      {With(good, "[229, ", "[x, "), "sensor.yaml:16: intrinsics has 'x', expected finite"},
      {With(good, "[229, ", "[-229, "), "sensor.yaml:16: opencv: fx is -229"},
      {With(good, "[376, 240]", "[376, 0.5]"), "sensor.yaml:14: resolution"},
      {With(good, "1.0]", "2.0]"), "T_BS: the last row is not 0 0 0 1"},
      {"", "sensor.yaml: not a list of keys and values"},
      {std::string("\0\1\2", 3), "sensor.yaml"},
  };
  for (const auto& [text, what] : broken) {
    Write("mav0/cam0/sensor.yaml", text);
    EXPECT_THAT(Error(), HasSubstr(what)) << text;
  }
  fs::remove(root_ + "/mav0/cam0/sensor.yaml");
  EXPECT_THAT(Error(), HasSubstr("cam0/sensor.yaml: cannot be opened"));
}

TEST_F(EurocSequence, BrokenListsAreToldWithTheirLines) {
  const std::pair<std::string, const char*> broken[] = {
      {"100\n", "cam1/data.csv:1: '100', expected a time stamp in nanoseconds, a comma"},
      {"#\n100,a.png\nx,b.png\n", "cam1/data.csv:3: 'x,b.png'"},
      {"1.5,a.png\n", "cam1/data.csv:1: '1.5,a.png'"},
      {"-1,a.png\n", "cam1/data.csv:1: '-1,a.png'"},
      {"1,\n", "cam1/data.csv:1: '1,'"},
      {"100,a.png\n100,b.png\n", "cam1/data.csv:2: the time stamp 100 occurs twice"},
      {"#timestamp [ns],filename\n", "cam1/data.csv: there is no image in it"},
  };
  for (const auto& [text, what] : broken) {
    Write("mav0/cam1/data.csv", text);
    EXPECT_THAT(Error(), HasSubstr(what)) << text;
  }
  fs::remove(root_ + "/mav0/cam1/data.csv");
  EXPECT_THAT(Error(), HasSubstr("cam1/data.csv: cannot be opened"));
}

TEST_F(EurocSequence, BrokenTruthIsToldWithItsLine) {
  const std::pair<std::string, const char*> broken[] = {
      {"#\n1,2,3\n", "state_groundtruth_estimate0/data.csv:2: 3 columns, expected at least 8"},
      {"x,0,0,0,1,0,0,0\n", "data.csv:1: 'x', expected a time stamp"},
      {"1,0,0,zero,1,0,0,0\n", "data.csv:1: column 4 is 'zero', expected a finite number"},
      {"1,0,0,0,1,1,0,0\n", "data.csv:1: the quaternion is not of unit length"},
  };
  for (const auto& [text, what] : broken) {
    Write("mav0/state_groundtruth_estimate0/data.csv", text);
    EXPECT_THAT(Error(), HasSubstr(what)) << text;
  }
}

TEST_F(EurocSequence, WrongRootIsTold) {
  fs::remove_all(root_ + "/mav0/cam1");
  EXPECT_THAT(Error(), HasSubstr("expected EuRoC's folder mav0 with cam0 and cam1"));
  fs::remove_all(root_);
  EXPECT_THAT(Error(), HasSubstr("expected EuRoC's folder mav0 with cam0 and cam1"));
}

}  // namespace
}  // namespace rigel
