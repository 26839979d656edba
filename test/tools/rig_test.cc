// rigel_rig: calibrations as tables and as rig files, that other programs take.
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RigTest : public ToolsTest {
 protected:
  void SetUp() override {
    ToolsTest::SetUp();
    WriteText(Path("camchain.yaml"), kCamchain);
  }

  static constexpr char kCamchain[] =
      "cam0:\n"
      "  camera_model: pinhole\n"
      "  distortion_coeffs: [-0.1, 0.01, 0.0002, 1.7e-05]\n"
      "  distortion_model: radtan\n"
      "  intrinsics: [458.5, 457.25, 367.5, 248.375]\n"
      "  resolution: [752, 480]\n"
      "cam1:\n"
      "  T_cn_cnm1: [[1, 0, 0, -0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
      "  camera_model: pinhole\n"
      "  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]\n"
      "  distortion_model: equidistant\n"
      "  intrinsics: [290.5, 290.25, 367.5, 248.375]\n"
      "  resolution: [752, 480]\n"
      "  timeshift_cam_imu: 0.002\n";
};

TEST_F(RigTest, ShowsACalibrationAndWritesARigFile) {
  const Outcome run = RunTool("rig", {"--calibration=" + Path("camchain.yaml"),
                                      "--output=" + Path("rig.json"), "--name=stick"});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("format kalibr, body: cam0; down +y, forward +z (from the"),
                             HasSubstr("752x480"), HasSubstr("opencv_fisheye"),
                             HasSubstr("cam1 from cam0: 0.500 m, 0.500 right"),
                             HasSubstr("time offset of cam1: 2.000 ms")));
  EXPECT_LE(Width(run.out), 100u);
  EXPECT_THAT(run.err, AllOf(HasSubstr("wrote " + Path("rig.json")), Not(HasSubstr("warning"))));
  // The rig file is read back, and the street takes it.
  const Outcome again = RunTool("rig", {"--calibration=" + Path("rig.json"), "--output=-"});
  ASSERT_EXIT_CODE(again, 0);
  EXPECT_EQ(again.out, ReadText(Path("rig.json")));
  const Json rig = ParseReport(again.out);
  EXPECT_EQ(rig["format"], "rigel-rig 1");
  EXPECT_EQ(rig["name"], "stick");
  EXPECT_EQ(rig["cameras"][1]["time_offset"], 0.002);
  ASSERT_EXIT_CODE(RunTool("simulate", {"--scene=street", "--rig=" + Path("rig.json"), "--pairs=1",
                                        "--output=" + Path("street")}),
                   0);
}

TEST_F(RigTest, FlagsSayWhatTheFileDoesNot) {
  const Outcome run =
      RunTool("rig", {"--calibration=" + Path("camchain.yaml"), "--cameras=cam1", "--down=+y",
                      "--forward=0,0,2", "--ground_m=1.5", "--output=-"});
  ASSERT_EXIT_CODE(run, 0);
  const Json rig = ParseReport(run.out);
  ASSERT_EQ(rig["cameras"].size(), 1u);
  EXPECT_EQ(rig["cameras"][0]["name"], "cam1");
  EXPECT_EQ(rig["down"], Json({0.0, 1.0, 0.0}));
  EXPECT_EQ(rig["forward"], Json({0.0, 0.0, 1.0}));
  EXPECT_EQ(rig["ground_m"], 1.5);

  WriteText(Path("calib.txt"), "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n");
  const Outcome without = RunTool("rig", {"--calibration=" + Path("calib.txt")});
  EXPECT_EXIT_CODE(without, 1);
  EXPECT_THAT(without.err, HasSubstr("calib.txt: states no image size, expected --size=1241x376"));
  EXPECT_EXIT_CODE(RunTool("rig", {"--calibration=" + Path("calib.txt"), "--size=1241x376"}), 0);
}

TEST_F(RigTest, WarnsOfInvertedPoses) {
  // Four cameras around a car, x forward and z up, as camera_from_body.
  std::string cameras;
  for (const char* pose : {R"("q": [0.5, 0.5, -0.5, 0.5], "s": [0, 1.5, -2])",
                           R"("q": [0.7071067811865476, 0.7071067811865476, 0, 0],
                              "s": [-0.5, 1.5, -1])",
                           R"("q": [0.5, 0.5, 0.5, -0.5], "s": [0, 1.5, 0])",
                           R"("q": [0, 0, 0.7071067811865476, -0.7071067811865476],
                              "s": [0.5, 1.5, -1])"}) {
    cameras += std::string(cameras.empty() ? "" : ",") +
               R"({"model": "pinhole", "parameters": [400, 400, 320, 240], "width": 640,
                   "height": 480, )" +
               pose + "}";
  }
  WriteText(Path("rig.json"), R"({"format": "rigel-rig 1", "cameras": [)" + cameras + "]}");
  const Outcome run = RunTool("rig", {"--calibration=" + Path("rig.json")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("warning: poses look inverted"));
}

TEST_F(RigTest, WrongFlagsAndFilesAreRefused) {
  const std::string calibration = "--calibration=" + Path("camchain.yaml");
  const struct {
    Args args;
    int exit_code;
    const char* phrase;
  } cases[] = {
      {{}, 2, "--calibration is missing: name a file"},
      {{calibration, "--format=matlab"}, 2, "expected auto, rigel, kalibr"},
      {{calibration, "--size=640"}, 2, "expected width and height, as 1241x376"},
      {{calibration, "--size=0x480"}, 2, "expected width and height, as 1241x376"},
      {{calibration, "--index=-1"}, 2, "--index: expected a number from 0"},
      {{calibration, "--down=up"}, 2, "expected +x, -x"},
      {{calibration, "--output=" + Path("camchain.yaml")}, 2, "camchain.yaml"},
      {{calibration, "--format=colmap"}, 1, "cameras.txt"},
      {{calibration, "--cameras=left"}, 1, "no camera left, expected one of cam0 cam1"},
      {{calibration, "--down=+z", "--forward=-z"}, 1, "within 30 degrees"},
      {{"--calibration=" + Path("absent")}, 1, "absent"},
  };
  for (const auto& c : cases) {
    const Outcome run = RunTool("rig", c.args);
    EXPECT_EXIT_CODE(run, c.exit_code);
    EXPECT_THAT(run.err, HasSubstr(c.phrase));
    EXPECT_THAT(run.out, IsEmpty());
  }
}

}  // namespace
}  // namespace rigel
