// Rig files: both kinds of keys, what is left out, what is refused.
#include "rigel/problems/io/rig_file.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/core/camera_cases.h"
#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

using testing::HasSubstr;

constexpr char kRest[] =
    R"("width": 640, "height": 480, "q": [0.6, 0.8, 0, 0], "s": [0.5, -0.1, 2]})";

// A file of one camera with these keys and valid others.
std::string OneCamera(const std::string& keys) {
  return R"({"format": "rigel-rig 1", "cameras": [{"name": "front", )" + keys + ", " + kRest + "]}";
}

RigFile MustRead(const std::string& text) {
  RigFile rig;
  std::string error;
  EXPECT_TRUE(ParseRigFile(text, "rig.json", &rig, &error)) << error;
  EXPECT_TRUE(rig.rig.IsValid(&error)) << error;
  return rig;
}

TEST(RigFile, ReadsEveryField) {
  const RigFile file = MustRead(
      R"({"format": "rigel-rig 1", "name": "car", "ground_m": 0.4, "down": [0, 0, -1],
          "forward": [1, 0, 0], "cameras": [
          {"name": "front", "images": "a/{frame}.png", "model": "pinhole",
           "parameters": [700, 701, 320, 240], )" +
      std::string(kRest) + R"(, {"model": "opencv", "parameters": [1, 2, 3, 4, 0, 0, 0, 1e-3], )" +
      kRest + "]}");
  EXPECT_EQ(file.name, "car");
  EXPECT_EQ(file.ground_m, 0.4);
  EXPECT_EQ(file.down, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(file.forward, Eigen::Vector3d::UnitX());
  EXPECT_EQ(file.camera_names, (std::vector<std::string>{"front", "1"}));
  EXPECT_EQ(file.camera_images, (std::vector<std::string>{"a/{frame}.png", ""}));
  EXPECT_EQ(file.rig.cameras[1].intrinsics.parameters[7], 1e-3);
  ASSERT_EQ(file.rig.size(), 2);
  const RigCamera& camera = file.rig.cameras[0];
  EXPECT_EQ(camera.intrinsics.fx(), 700);
  EXPECT_EQ(camera.intrinsics.fy(), 701);
  EXPECT_EQ(camera.intrinsics.cx(), 320);
  EXPECT_EQ(camera.intrinsics.cy(), 240);
  EXPECT_EQ(camera.intrinsics.width, 640);
  EXPECT_EQ(camera.intrinsics.height, 480);
  EXPECT_EQ(camera.s, Eigen::Vector3d(0.5, -0.1, 2));
  // w x y z: about X with cos a = 0.36 - 0.64, sin a = 2 * 0.6 * 0.8.
  Eigen::Matrix3d Q;
  Q << 1, 0, 0, 0, -0.28, -0.96, 0, 0.96, -0.28;
  EXPECT_LT((camera.Q - Q).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(file.rig.cameras[1].intrinsics.cy(), 4);
}

TEST(RigFile, ReadsTheErrorAndTheTimeOfACamera) {
  const RigFile file = MustRead(
      OneCamera(R"("model": "pinhole", "parameters": [7, 8, 3, 4], "camera_sigma": [0.5, 0.02],
          "time_offset": -0.045)"));
  const RigCamera& camera = file.rig.cameras[0];
  EXPECT_DOUBLE_EQ(camera.rotation_sigma, DegToRad(0.5));
  EXPECT_EQ(camera.position_sigma, 0.02);
  EXPECT_EQ(camera.time_offset, -0.045);
}

TEST(RigFile, ReadsEachModel) {
  for (const CameraCase& camera_case : CameraCases()) {
    SCOPED_TRACE(camera_case.name);
    const Camera& camera = camera_case.camera;
    std::ostringstream keys;
    keys.precision(17);
    keys << "\"model\": \"" << CameraModelName(camera.model) << "\", \"parameters\": [";
    for (int k = 0; k < NumCameraParameters(camera.model); ++k) {
      keys << (k > 0 ? ", " : "") << camera.parameters[k];
    }
    const RigFile file = MustRead(OneCamera(keys.str() + "]"));
    ASSERT_EQ(file.rig.size(), 1);
    EXPECT_TRUE(SameLens(file.rig.cameras[0].intrinsics, camera));
  }
}

TEST(RigFile, ReadsOlderKeys) {
  using M = CameraModel;
  const struct {
    const char* keys;
    Camera camera;
  } cases[] = {
      {R"("model": "pinhole")", {M::kPinhole, {7, 8, 3, 4}}},
      {R"("model": "pinhole", "distortion": [])", {M::kPinhole, {7, 8, 3, 4}}},
      {R"("model": "radial k1 k2 k3", "distortion": [0.1, 0.2, 0.3])",
       {M::kFullOpencv, {7, 8, 3, 4, 0.1, 0.2, 0, 0, 0.3}}},
      {R"("model": "brown k1 k2 p1 p2 k3", "distortion": [1e-1, 2e-1, 3e-3, 4e-3, 5e-2])",
       {M::kFullOpencv, {7, 8, 3, 4, 0.1, 0.2, 0.003, 0.004, 0.05}}},
      {R"("model": "brown k1 k2 p1 p2 k3", "distortion": [0, 0, 0, 0, 0])",
       {M::kPinhole, {7, 8, 3, 4}}},
      {R"("model": "equidistant (kalibr) k1 k2 k3 k4", "distortion": [0.1, 0.2, 0.3, 0.4])",
       {M::kOpencvFisheye, {7, 8, 3, 4, 0.1, 0.2, 0.3, 0.4}}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.keys);
    const RigFile file =
        MustRead(OneCamera(std::string(R"("fx": 7, "fy": 8, "cx": 3, "cy": 4, )") + c.keys));
    EXPECT_TRUE(SameLens(file.rig.cameras[0].intrinsics, c.camera));
  }
}

TEST(RigFile, WhatIsWrittenReadsBackTheSame) {
  RigFile file = MustRead(
      R"({"format": "rigel-rig 1", "name": "car \\u2028", "ground_m": 0.4, "down": [0, 0, -1],
          "forward": [1, 0, 0], "cameras": [
          {"name": "front", "model": "pinhole", "parameters": [700.1, 701, 320, 240],
           "camera_sigma": [0.5, 0.02], "time_offset": -0.01, "images": "front/*.jpg", )" +
      std::string(kRest) + R"(, {"model": "opencv", "parameters": [1, 2, 3, 4, 0, 0, 0, 1e-3], )" +
      kRest + "]}");
  EXPECT_EQ(file.camera_images, (std::vector<std::string>{"front/*.jpg", ""}));
  for (const CameraCase& camera_case : CameraCases()) {
    RigCamera camera = file.rig.cameras[0];
    camera.intrinsics = camera_case.camera;
    camera.Q = Eigen::AngleAxisd(0.1 * file.rig.size(), Eigen::Vector3d(1, 2, 3).normalized())
                   .toRotationMatrix();
    file.rig.cameras.push_back(camera);
    file.camera_names.emplace_back(camera_case.name);
    file.camera_images.emplace_back();
  }
  const std::string text = RigFileText(file);
  const RigFile again = MustRead(text);
  EXPECT_EQ(again.name, file.name);
  EXPECT_EQ(again.ground_m, file.ground_m);
  EXPECT_EQ(again.down, file.down);
  EXPECT_EQ(again.forward, file.forward);
  EXPECT_EQ(again.camera_names, file.camera_names);
  EXPECT_EQ(again.camera_images, file.camera_images);
  ASSERT_EQ(again.rig.size(), file.rig.size());
  for (int k = 0; k < file.rig.size(); ++k) {
    const RigCamera &a = file.rig.cameras[k], &b = again.rig.cameras[k];
    EXPECT_TRUE(SameLens(a.intrinsics, b.intrinsics));
    EXPECT_EQ(a.intrinsics.width, b.intrinsics.width);
    EXPECT_EQ(a.intrinsics.height, b.intrinsics.height);
    EXPECT_LT((a.Q - b.Q).norm(), 1e-15);
    EXPECT_EQ(a.s, b.s);
    EXPECT_DOUBLE_EQ(a.rotation_sigma, b.rotation_sigma);
    EXPECT_EQ(a.position_sigma, b.position_sigma);
    EXPECT_EQ(a.time_offset, b.time_offset);
  }
  // Names may be of no encoding, and missing.
  RigFile bare;
  bare.rig = file.rig;
  bare.name = "car\xff";
  bare.camera_names = {"left\x1b"};
  EXPECT_EQ(MustRead(RigFileText(bare)).camera_names[1], "1");
}

TEST(RigFile, BrokenOnesAreRefused) {
  const std::string good = OneCamera(R"("model": "pinhole", "parameters": [7, 8, 3, 4])");
  const struct {
    std::string from, to;
    const char* phrase;
  } cases[] = {
      {good, "", "parse error"},
      {good, "{", "parse error"},
      {good, "[]", "an array, expected an object with 'cameras'"},
      {good, "{}", "no 'cameras', expected an array"},
      {good, R"({"cameras": []})", "expected an array of at least one camera"},
      {good, R"({"cameras": [3]})", "camera 0: '3', expected an object"},
      {"rigel-rig 1", "rigel-rig 2", "expected 'rigel-rig 1'"},
      {"\"cameras\"", "\"ground_m\": \"x\", \"cameras\"", "ground_m is '\"x\"', expected a number"},
      {"\"cameras\"", "\"down\": [0, 0, 2], \"cameras\"", "down has a norm that is not 1"},
      {"\"cameras\"", "\"forward\": [0, 1], \"cameras\"", "forward has 2 entries, expected 3"},
      {"\"front\"", "7", "camera 0: name is '7', expected a text"},
      {"\"model\"", "\"kind\"", "camera 0 (front): no 'model', expected the name"},
      {"pinhole", "fisheye624", "camera 0 (front): camera model 'fisheye624' is not read"},
      {"pinhole", "spherical",
       "camera model 'spherical' is not read, expected one of pinhole, sim"},
      {"pinhole", "opencv_fisheye", "camera 0 (front): parameters has 4 entries, expected 8"},
      {"pinhole", "PINHOLE", "camera model 'PINHOLE' is not read"},
      {"[7, 8, 3, 4]", "[7, 8, 3]", "parameters has 3 entries, expected 4 numbers"},
      {"[7, 8, 3, 4]", "7", "parameters has '7', expected 4 numbers"},
      {"[7, 8, 3, 4]", "[7, 0, 3, 4]", "pinhole: fy is 0.000000, expected a positive number"},
      {"[7, 8, 3, 4]", "[7, null, 3, 4]", "parameters is 'null', expected a number"},
      {"[7, 8, 3, 4]", "[7, 8, 3, 4], \"fx\": 7", "'parameters' and 'fx', expected one of them"},
      {"\"parameters\"", "\"values\"", "no 'fx', expected 'parameters', or 'fx', 'fy', 'cx'"},
      {"640", "0", "width is '0', expected an integer from 1"},
      {"480", "480.5", "height is '480.5', expected an integer from 1"},
      {"\"height\"", "\"tall\"", "no 'height', expected the size of the image"},
      {"[0.6, 0.8, 0, 0]", "[0.6, 0.7, 0, 0]", "q has a norm that is not 1, expected"},
      {"[0.6, 0.8, 0, 0]", "[0.6, 0.8, 0]", "q has 3 entries, expected 4 numbers"},
      {"[0.5, -0.1, 2]", "[0.5, -0.1, 1e999]", "number overflow"},
      {"\"s\"", "\"camera_sigma\": 0.1, \"s\"", "camera_sigma has '0.1', expected 2 numbers"},
      {"\"s\"", "\"camera_sigma\": [1, 0], \"s\"", "camera_sigma is '0', expected a positive"},
      {"\"s\"", "\"time_offset\": \"1\", \"s\"", "time_offset is '\"1\"', expected a number"},
      {"\"s\"", "\"t\"", "no 's', expected the position"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.phrase);
    RigFile rig;
    rig.name = "untouched";
    std::string error;
    EXPECT_FALSE(ParseRigFile(Replace(good, c.from, c.to), "a\nb.json", &rig, &error));
    EXPECT_THAT(error, testing::StartsWith("a\\x0ab.json: "));
    EXPECT_THAT(error, HasSubstr(c.phrase));
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
    EXPECT_EQ(rig.name, "untouched");
  }
}

TEST(RigFile, OlderModelsThatAreRefused) {
  for (const char* model : {"Fisheye624 k0..k5", "opencv_fisheye"}) {
    RigFile rig;
    std::string error;
    EXPECT_FALSE(ParseRigFile(
        OneCamera(R"("fx": 7, "fy": 8, "cx": 3, "cy": 4, "model": ")" + std::string(model) + "\""),
        "rig.json", &rig, &error));
    EXPECT_THAT(error, HasSubstr("rig.json: camera 0 (front): camera model '"));
    EXPECT_THAT(error, HasSubstr(std::string(model).substr(0, 10)));
  }
  RigFile rig;
  std::string error;
  EXPECT_FALSE(ParseRigFile(OneCamera(R"("fx": 7, "fy": 8, "cx": 3, "cy": 4, "model": "radial",
                                         "distortion": [0, 0])"),
                            "rig.json", &rig, &error));
  EXPECT_THAT(error, HasSubstr("distortion has 2 entries, expected 3 numbers"));
}

TEST(RigFile, ReadsAFile) {
  const TempDir dir;
  RigFile rig;
  std::string error;
  EXPECT_FALSE(ReadRigFile(dir / "none.json", &rig, &error));
  EXPECT_THAT(error, HasSubstr("none.json: cannot be opened"));
  WriteText(dir / "rig.json", OneCamera(R"("model": "pinhole", "parameters": [7, 8, 3, 4])"));
  EXPECT_TRUE(ReadRigFile(dir / "rig.json", &rig, &error)) << error;
  EXPECT_EQ(rig.rig.size(), 1);
}

TEST(RigFile, RealRigs) {
  const char* root = std::getenv("RIGEL_REAL_DATA");
  if (root == nullptr || *root == '\0') GTEST_SKIP() << "RIGEL_REAL_DATA is not set";
  int num_read = 0, num_refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(root) + "/rigs")) {
    RigFile rig;
    std::string error;
    if (ReadRigFile(entry.path().string(), &rig, &error)) {
      ++num_read;
    } else {
      ++num_refused;
      EXPECT_THAT(error, HasSubstr("is not read, expected pinhole"));
    }
  }
  EXPECT_EQ(num_read, 9);
  EXPECT_EQ(num_refused, 1);
}

}  // namespace
}  // namespace rigel
