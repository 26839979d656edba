// Which format a file has, and rigs that are not valid.
#include "rigel/problems/rigs/rig_formats.h"

#include <sstream>

#include "rigel/core/angles.h"
#include "rigel/problems/rigs/field_of_view.h"
#include "rigel/problems/rigs/rig_table.h"
#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RigFormats : public RigFilesTest {};

constexpr char kRig[] = R"({"format": "rigel-rig 1", "name": "car", "ground_m": 0.5,
  "down": [0, 0, -1], "forward": [1, 0, 0], "cameras": [
  {"name": "front", "model": "pinhole", "parameters": [500, 500, 319.5, 239.5], "width": 640,
   "height": 480, "q": [0.5, -0.5, 0.5, -0.5], "s": [1.5, 0, 1.25], "time_offset": 0.005,
   "images": "front/*.jpg", "camera_sigma": [0.1, 0.02]},
  {"name": "left, with a lens", "model": "thin_prism_fisheye", "width": 1920, "height": 1208,
   "parameters": [500, 500, 960, 604, 0, 0, 0, 0, 0, 0, 0, 0],
   "q": [0.5, -0.5, 0.5, -0.5], "s": [1.5, 0.25, 1.25]}]})";

TEST_F(RigFormats, RigFilesAreReadToo) {
  Write("rig.json", kRig);
  const Calibration calibration = Read("rig.json", "rigel");
  EXPECT_EQ(calibration.rig.camera_images[0], "front/*.jpg");
  EXPECT_NEAR(calibration.rig.rig.cameras[0].rotation_sigma, DegToRad(0.1), 1e-15);
  // The older keys have no format.
  Write("older.json", R"({"cameras": [{"name": "a", "model": "pinhole", "fx": 7, "fy": 8, "cx": 3,
    "cy": 4, "width": 6, "height": 8, "q": [1, 0, 0, 0], "s": [0, 0, 0]}]})");
  EXPECT_EQ(Read("older.json", "rigel").rig.rig.size(), 1);
}

TEST_F(RigFormats, OthersAreRefused) {
  std::string format, error;
  for (const char* text : {"", "hello", "{}", "[1]", "3 PINHOLE 640 480 1 1 1 1"}) {
    Write("file", text);
    EXPECT_FALSE(DetectRigFormat(Path("file"), &format, &error));
    EXPECT_THAT(error, HasSubstr("file: not known as a calibration, expected one of rigel, kalibr, "
                                 "openvins, orbslam3, euroc, colmap, kitti"));
  }
  EXPECT_FALSE(DetectRigFormat(Path(""), &format, &error));
  EXPECT_FALSE(DetectRigFormat(Path("absent"), &format, &error));
  EXPECT_THAT(error, HasSubstr("absent"));
  Write("file", std::string("cam0:\0x", 7));
  EXPECT_FALSE(DetectRigFormat(Path("file"), &format, &error));
  EXPECT_THAT(error, HasSubstr("expected UTF-8 text"));
  Calibration calibration;
  EXPECT_FALSE(ReadRigCalibration(Path("file"), "matlab", options_, &calibration, &error));
  EXPECT_THAT(error, HasSubstr("format 'matlab', expected one of rigel, kalibr"));
  // A folder where a file is expected, and the other way round.
  for (const char* name : {"kalibr", "colmap", "orbslam3", "kitti", "nuscenes", "argoverse2"}) {
    EXPECT_FALSE(ReadRigCalibration(Path(""), name, options_, &calibration, &error)) << name;
    EXPECT_FALSE(ReadRigCalibration(Path("file"), name, options_, &calibration, &error)) << name;
  }
}

TEST_F(RigFormats, ATableFitsAHundredColumns) {
  Write("rig.json", kRig);
  const RigFile rig = Read("rig.json", "rigel").rig;
  BodyAxes axes;
  axes.down = *rig.down;
  axes.forward = *rig.forward;
  const std::string table = RigTable(rig, axes);
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
  EXPECT_THAT(table, AllOf(HasSubstr("640x480"), HasSubstr("... with a lens"), HasSubstr("65.2"),
                           HasSubstr("left, with a lens from front: 0.250 m, 0.250 left"),
                           HasSubstr("time offset of front: 5.000 ms")));
}

TEST(RigFormatsFieldOfView, IsThatOfTheLens) {
  const double pi = 3.14159265358979323846;
  const auto view = [](const Camera& camera) { return RadToDeg(HorizontalFieldOfView(camera)); };
  EXPECT_NEAR(view(Camera::Pinhole(320, 320, 319.5, 239.5, 640, 480)), 90, 1e-9);
  EXPECT_NEAR(view(Camera::Pinhole(320, 320, -0.5, 239.5, 640, 480)), RadToDeg(std::atan(2.0)),
              1e-9);
  const double f = 320 / (0.55 * pi);  // of 198 degrees
  Camera fisheye = {CameraModel::kOpencvFisheye, {f, f, 319.5, 239.5}, 640, 480};
  EXPECT_NEAR(view(fisheye), 198, 1e-9);
  // Its image ends at 180 degrees to both sides, before the edges.
  fisheye.parameters[0] = fisheye.parameters[1] = 80;
  EXPECT_NEAR(view(fisheye), 360, 1);
  EXPECT_EQ(view(Camera::Pinhole(320, 320, 319.5, 239.5)), 0);
}

}  // namespace
}  // namespace rigel
