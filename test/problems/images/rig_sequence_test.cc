// Images of any rig: which of them are a frame, masks, pairs of cameras, what is refused.
#include "rigel/problems/images/rig_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/problems/images/plane_scene.h"
#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

std::string CameraJson(const std::string& name, const std::string& more = "") {
  return R"({"name": ")" + name + R"(", "model": "pinhole", "parameters": [320, 320, 320, 240],
      "width": 640, "height": 480, "q": [1, 0, 0, 0], "s": [0, 0, 0])" +
         more + "}";
}

class RigSequence : public testing::Test {
 protected:
  void SetUp() override {
    WriteRig({CameraJson("left"), CameraJson("right-2")});
    options_.images = directory_ / "{camera}/{frame}.png";
  }

  void WriteRig(const std::vector<std::string>& cameras) {
    std::string text;
    for (const std::string& camera : cameras) text += (text.empty() ? "" : ", ") + camera;
    WriteText(directory_ / "car.json",
              R"({"format": "rigel-rig 1", "forward": [0, 0, 1], "cameras": [)" + text + "]}");
  }
  void Touch(const std::vector<std::string>& names) {
    for (const std::string& name : names) WriteFile(directory_ / name, "");
  }

  ImageSequence Read() {
    ImageSequence sequence;
    std::string error;
    EXPECT_TRUE(ReadRigSequence(directory_ / "car.json", options_, &sequence, &error)) << error;
    return sequence;
  }
  std::string Error() {
    ImageSequence sequence;
    std::string error;
    EXPECT_FALSE(ReadRigSequence(directory_ / "car.json", options_, &sequence, &error));
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
    return error;
  }

  // "left/1.png right-2/1.png", "-" where a camera has no image, of each frame.
  std::vector<std::string> Frames(const ImageSequence& sequence) {
    std::vector<std::string> frames;
    for (const ImageFrame& frame : sequence.frames) {
      std::string text;
      for (const std::string& image : frame.images) {
        text += (text.empty() ? "" : " ") +
                (image.empty() ? "-" : image.substr(directory_.path().size() + 1));
      }
      frames.push_back(text);
    }
    return frames;
  }

  TempDir directory_;
  RigSequenceOptions options_;
};

TEST_F(RigSequence, CamerasOfOneNameAreRefused) {
  WriteRig({CameraJson("left"), CameraJson("left")});
  Touch({"left/1.png", "left/2.png"});
  EXPECT_THAT(Error(), HasSubstr("cameras 0 and 1 (left) have the same images, expected names"));
}

TEST_F(RigSequence, FramesOfOneName) {
  Touch({"left/9.png", "left/10.png", "left/11.png", "right-2/9.png", "right-2/11.png"});
  const ImageSequence sequence = Read();
  EXPECT_EQ(sequence.name, "car");
  EXPECT_EQ(sequence.forward, Eigen::Vector3d::UnitZ());
  EXPECT_THAT(Frames(sequence), ElementsAre("left/9.png right-2/9.png", "left/10.png -",
                                            "left/11.png right-2/11.png"));
  EXPECT_FALSE(sequence.frames[0].time.has_value());
  EXPECT_THAT(sequence.notes,
              ElementsAre(HasSubstr("as their fields of view overlap: left-right-2"),
                          "camera right-2 has no image of 1 of 3 frames, the first is frame 1; "
                          "they are matched without it"));
  EXPECT_THAT(sequence.settings, ElementsAre("camera_pairs 0-1", "frame 0 '9'"));
}

TEST_F(RigSequence, CamerasByTheirNumbers) {
  Touch({"0/a.png", "1/a.png"});
  EXPECT_THAT(Frames(Read()), ElementsAre("0/a.png 1/a.png"));
}

TEST_F(RigSequence, FramesByOrder) {
  Touch({"left/l2.png", "left/l10.png", "right-2/r5.png", "right-2/r6.png", "right-2/r7.png"});
  options_.order = FrameOrder::kIndex;
  EXPECT_THAT(Frames(Read()), ElementsAre("left/l2.png right-2/r5.png",
                                          "left/l10.png right-2/r6.png", "- right-2/r7.png"));
}

TEST_F(RigSequence, FramesByTime) {
  // Nanoseconds; the right camera is 40 ms late, but for one image.
  Touch({"left/1403715273000000000.png", "left/1403715274000000000.png",
         "left/1403715275000000000.png", "right-2/1403715273040000000.png",
         "right-2/1403715274300000000.png", "right-2/1403715275040000007.png"});
  options_.order = FrameOrder::kTime;
  const ImageSequence late = Read();
  EXPECT_THAT(Frames(late),
              ElementsAre("left/1403715273000000000.png right-2/1403715273040000000.png",
                          "left/1403715274000000000.png -", "- right-2/1403715274300000000.png",
                          "left/1403715275000000000.png right-2/1403715275040000007.png"));
  EXPECT_DOUBLE_EQ(*late.frames[3].time, 1403715275.0);
  EXPECT_THAT(late.settings, Contains("sync_tolerance_ms default"));
  EXPECT_THAT(late.notes,
              AllOf(Contains(HasSubstr("differ by up to 40.000007 ms, within 100 ms")),
                    Contains(HasSubstr("camera right-2 fires 40 ms after the others (median)"))));

  // Its offset is taken off first.
  WriteRig({CameraJson("left"), CameraJson("right-2", R"(, "time_offset": 0.04)")});
  options_.order = FrameOrder::kIndex;
  EXPECT_THAT(Read().notes, Contains(HasSubstr("the rig file has time offsets of cameras, but")));
  options_.order = FrameOrder::kTime;
  options_.sync_tolerance_ms = 0.0005;
  const ImageSequence exact = Read();
  EXPECT_EQ(exact.frames.size(), 4u);
  EXPECT_THAT(exact.notes, Not(Contains(HasSubstr("fires"))));
  options_.sync_tolerance_ms = 0.000006;
  EXPECT_EQ(Read().frames.size(), 5u);
}

TEST_F(RigSequence, StampsInOtherUnits) {
  Touch({"left/12.25.png", "right-2/12.26.png"});
  options_.order = FrameOrder::kTime;
  options_.time_unit_ns = 1000000000;
  options_.sync_tolerance_ms = 10;
  const ImageSequence sequence = Read();
  EXPECT_THAT(Frames(sequence), ElementsAre("left/12.25.png right-2/12.26.png"));
  EXPECT_EQ(sequence.frames[0].time, 12.25);
}

TEST_F(RigSequence, ImagesOfTheRigFile) {
  options_.images.clear();
  WriteRig({CameraJson("left", R"(, "images": "a/{frame}.png")"),
            CameraJson("right", R"(, "images": "b")")});
  Touch({"a/1.png", "b/1.jpg", "b/readme.txt"});
  EXPECT_THAT(Frames(Read()), ElementsAre("a/1.png b/1.jpg"));
  WriteRig({CameraJson("left", R"(, "images": "a")"), CameraJson("right")});
  EXPECT_THAT(Error(), HasSubstr("--images is missing, and the rig file has no 'images' of camera "
                                 "right"));
}

TEST_F(RigSequence, Masks) {
  Touch({"left/1.png", "left/2.png", "right-2/1.png", "masks/left.png"});
  options_.masks = directory_ / "masks/{camera}.png";
  const ImageSequence sequence = Read();
  EXPECT_THAT(sequence.frames[1].masks, ElementsAre(directory_ / "masks/left.png", ""));
  EXPECT_THAT(sequence.notes, Contains("camera right-2: 1 of 1 images have no mask"));
  EXPECT_THAT(sequence.settings, Contains("masks yes"));

  Touch({"masks/left-2.png", "masks/right-2-1.png"});
  options_.masks = directory_ / "masks/{camera}-{frame}.png";
  const ImageSequence each = Read();
  EXPECT_THAT(each.frames[0].masks, ElementsAre("", directory_ / "masks/right-2-1.png"));
  EXPECT_THAT(each.frames[1].masks, ElementsAre(directory_ / "masks/left-2.png", ""));

  options_.masks = directory_ / "{camera}.jpg";
  EXPECT_THAT(Error(), HasSubstr("--masks: no file fits '"));
  options_.masks = "mask.png";
  EXPECT_THAT(Error(), HasSubstr("--masks: 'mask.png' has no {camera}"));
}

TEST_F(RigSequence, PairsOfCameras) {
  const std::vector<std::string> names = {"front", "front-left", "rear"};
  Rig rig;
  for (int k = 0; k < 3; ++k) {
    rig.cameras.emplace_back();
    rig.cameras[k].intrinsics = Camera::Pinhole(320, 320, 320, 240, 640, 480);
  }
  rig.cameras[2].Q = ExpSO3({0, 3, 0});
  std::vector<std::pair<int, int>> pairs;
  std::string error;
  const auto parse = [&](const std::string& text) {
    return ParseCameraPairs(text, rig, names, &pairs, &error);
  };
  ASSERT_TRUE(parse("overlap"));
  EXPECT_THAT(pairs, ElementsAre(Pair(0, 1)));
  ASSERT_TRUE(parse("all"));
  EXPECT_THAT(pairs, ElementsAre(Pair(0, 1), Pair(0, 2), Pair(1, 2)));
  ASSERT_TRUE(parse("none"));
  EXPECT_THAT(pairs, IsEmpty());
  ASSERT_TRUE(parse("2-0, rear-front-left,front-left-front,1-2"));
  EXPECT_THAT(pairs, ElementsAre(Pair(0, 1), Pair(0, 2), Pair(1, 2)));
  for (const char* wrong : {"0-3", "0-0", "0", "front", "x-rear", "", "0-1,,"}) {
    EXPECT_FALSE(parse(wrong)) << wrong;
    EXPECT_THAT(error, HasSubstr("--camera_pairs: '")) << wrong;
  }
}

TEST_F(RigSequence, WhatIsWrongIsTold) {
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("camera left: no image fits '"), HasSubstr("/left/{frame}")));
  Touch({"left/1.png"});
  EXPECT_THAT(Error(), HasSubstr("camera right-2: no image fits '"));
  Touch({"right-2/1.png", "right-2/b.png"});
  options_.order = FrameOrder::kTime;
  EXPECT_THAT(Error(), HasSubstr("b.png: {frame} is 'b', expected a time stamp (--frames=time)"));
  for (const char* name : {"-1", "1.", "1e3", "9223372036854775807.5", "1.2.3"}) {
    Touch({std::string("right-2/") + name + ".png"});
    fs::remove(directory_ / "right-2/b.png");
    options_.time_unit_ns = 10;
    EXPECT_THAT(Error(), HasSubstr("expected a time stamp")) << name;
    fs::remove(directory_ / (std::string("right-2/") + name + ".png"));
  }
  options_.images = directory_ / "{frame}.png";
  EXPECT_THAT(Error(), HasSubstr("has no {camera}, expected it where the cameras' images differ"));
  options_.time_unit_ns = 0;
  EXPECT_THAT(Error(), HasSubstr("time_unit_ns: expected 1 to 1000000000"));
  options_.time_unit_ns = 1;
  WriteText(directory_ / "car.json", "{}");
  EXPECT_THAT(Error(), HasSubstr("car.json: no 'cameras'"));
}

}  // namespace
}  // namespace rigel
