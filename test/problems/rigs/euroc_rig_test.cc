// EuRoC's folders: cam0, cam1, their lenses, what is refused.
#include "rigel/problems/rigs/euroc_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class EurocRig : public RigFilesTest {};

constexpr char kSensor[] = R"(# General sensor definitions.
sensor_type: camera
comment: VI-Sensor cam0 (MT9M034)

# Sensor extrinsics wrt. the body-frame.
T_BS:
  cols: 4
  rows: 4
  data: [0.6, -0.8, 0.0, -0.021,
         0.8, 0.6, 0.0, -0.064,
         0.0, 0.0, 1.0, 0.009,
         0.0, 0.0, 0.0, 1.0]

# Camera specific definitions.
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)";

TEST_F(EurocRig, HasTheCamerasOfTheFolders) {
  Write("mav0/cam0/sensor.yaml", kSensor);
  Write("mav0/cam0/data/1.png", "");
  Write("mav0/cam1/sensor.yaml",
        With(With(kSensor, "-0.021", "0.089"), "radial-tangential", "equidistant"));
  for (const char* name : {"", "mav0"}) {
    const Calibration calibration = Read(name, "euroc");
    EXPECT_THAT(calibration.rig.camera_names, ElementsAre("cam0", "cam1"));
    EXPECT_THAT(calibration.rig.camera_images, ElementsAre("cam0/data", ""));
    const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
    ASSERT_EQ(cameras.size(), 2u);
    ExpectPose(cameras[0], TurnZ(), {-0.021, -0.064, 0.009});
    ExpectPose(cameras[1], TurnZ(), {0.089, -0.064, 0.009});
    Camera lens = {
        CameraModel::kOpencv,
        {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359, 1.76187114e-05},
        752,
        480};
    ExpectLens(cameras[0], lens);
    lens.model = CameraModel::kOpencvFisheye;
    ExpectLens(cameras[1], lens);
  }
  EXPECT_EQ(Read("mav0/cam1/sensor.yaml", "euroc").rig.rig.size(), 1);
}

TEST_F(EurocRig, ReadsFiveCoefficients) {
  Write("cam0/sensor.yaml", With(kSensor, "1.76187114e-05]", "1.76187114e-05, 0.5]"));
  ExpectLens(Read("", "euroc").rig.rig.cameras[0],
             {CameraModel::kFullOpencv,
              {458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359,
               1.76187114e-05, 0.5},
              752,
              480});
}

TEST_F(EurocRig, BrokenOnesAreRefused) {
  const BrokenCase cases[] = {
      {"T_BS:", "T_SB:", "the key T_BS is missing"},
      {"data:", "date:", ":7: the key data is missing"},
      {"[0.6, -0.8,", "[0.6, 0.8,", ":7: T_BS: R is not a rotation"},
      {"0.0, 0.0, 0.0, 1.0]", "0.0, 0.0, 1.0]", ":7: T_BS has 15 numbers, expected the rows"},
      {"camera_model: pinhole", "camera_model: cata", "camera_model 'cata' with distortion_model"},
      {"camera_model: pinhole", "camera_model: [1]", ":17: camera_model: expected a word"},
      {"[752, 480]", "[752.5, 480]", ":16: resolution: expected an image's width and height"},
      {"1.76187114e-05]", "]", ":20: distortion_coefficients has 3 numbers, expected 4"},
      {"T_BS:\n  cols: 4", "T_BS: 3\nx:\n  cols: 4", ":6: T_BS has 1 numbers"},
  };
  for (const BrokenCase& c : cases) {
    SCOPED_TRACE(c.to);
    Write("mav0/cam0/sensor.yaml", With(kSensor, c.from, c.to));
    EXPECT_THAT(Error("mav0", "euroc"), HasSubstr(c.phrase));
  }
  Write("other/file", "");
  EXPECT_THAT(Error("other", "euroc"), HasSubstr("no cam0/sensor.yaml, expected EuRoC's folder"));
}

}  // namespace
}  // namespace rigel
