// KITTI's calibrations: rectified and raw, where the cameras are, what is refused.
#include "rigel/problems/rigs/kitti_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class KittiRig : public RigFilesTest {};

constexpr char kCalib[] =
    "P0: 7.0e+02 0 6.0e+02 0 0 7.0e+02 1.8e+02 0 0 0 1 0\n"
    "P1: 7.0e+02 0 6.0e+02 -3.5e+02 0 7.0e+02 1.8e+02 0 0 0 1 0\n"
    "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

constexpr char kRaw[] =
    "calib_time: 09-Jan-2012 13:57:47\n"
    "corner_dist: 9.950000e-02\n"
    "S_00: 1.392000e+03 5.120000e+02\n"
    "K_00: 984.25 0 690 0 980.75 233.25 0 0 1\n"
    "D_00: -0.37 0.2 0.0022 0.0014 -0.072\n"
    "R_00: 1 0 0 0 1 0 0 0 1\n"
    "T_00: 0 0 0\n"
    "S_rect_00: 1242 375\n"
    "R_rect_00: 1 0 0 0 1 0 0 0 1\n"
    "P_rect_00: 721.5 0 609.5 0 0 721.5 172.75 0 0 0 1 0\n"
    "S_02: 1392 512\n"
    "K_02: 960 0 696 0 957 224 0 0 1\n"
    "D_02: 0 0 0 0 0\n"
    "R_02: 0.6 0.8 0 -0.8 0.6 0 0 0 1\n"
    "T_02: 0.06 0.01 -0.02\n"
    "S_rect_02: 1242 375\n"
    "R_rect_02: 1 0 0 0 1 0 0 0 1\n"
    "P_rect_02: 721.5 0 609.5 45.09375 0 721.5 172.75 0 0 0 1 0\n";

TEST_F(KittiRig, RectifiedCamerasNeedASize) {
  Write("calib.txt", kCalib);
  EXPECT_THAT(Error("calib.txt", "kitti"), HasSubstr("states no image size, expected --size="));
  options_.size = ImageSize{1241, 376};
  for (const char* name : {"", "calib.txt"}) {
    const Calibration calibration = Read(name, "kitti");
    EXPECT_THAT(calibration.rig.camera_names, ElementsAre("image_0", "image_1"));
    EXPECT_EQ(calibration.rig.down, Eigen::Vector3d::UnitY());
    EXPECT_EQ(calibration.rig.forward, Eigen::Vector3d::UnitZ());
    const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
    ASSERT_EQ(cameras.size(), 2u);
    ExpectPose(cameras[0], Eigen::Matrix3d::Identity(), {0, 0, 0});
    ExpectPose(cameras[1], Eigen::Matrix3d::Identity(), {0.5, 0, 0});
    ExpectLens(cameras[1], {CameraModel::kPinhole, {700, 700, 600, 180}, 1241, 376});
  }
}

TEST_F(KittiRig, RawCamerasHaveDistortionAndPoses) {
  Write("calib_cam_to_cam.txt", kRaw);
  const Calibration calibration = Read("", "kitti_raw");
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("image_00", "image_02"));
  EXPECT_THAT(calibration.rig.camera_images, ElementsAre("image_00/data", "image_02/data"));
  const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 2u);
  ExpectLens(cameras[0], {CameraModel::kFullOpencv,
                          {984.25, 980.75, 690, 233.25, -0.37, 0.2, 0.0022, 0.0014, -0.072},
                          1392,
                          512});
  ExpectLens(cameras[1], {CameraModel::kPinhole, {960, 957, 696, 224}, 1392, 512});
  ExpectPose(cameras[1], TurnZ(), -TurnZ() * Eigen::Vector3d(0.06, 0.01, -0.02));
}

TEST_F(KittiRig, RectifiedImagesOfTheRawData) {
  Write("calib_cam_to_cam.txt", kRaw);
  detected_ = "kitti_raw";
  const std::vector<RigCamera> cameras =
      Read("calib_cam_to_cam.txt", "kitti_rectified").rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 2u);
  ExpectPose(cameras[1], Eigen::Matrix3d::Identity(), {-0.0625, 0, 0});
  ExpectLens(cameras[1], {CameraModel::kPinhole, {721.5, 721.5, 609.5, 172.75}, 1242, 375});
}

TEST_F(KittiRig, BrokenOnesAreRefused) {
  const BrokenCase raw[] = {
      {"K_00: 984.25", "K_00: x", "txt:4: K_00: number 1 is 'x', expected a finite number"},
      {"K_00: 984.25 0", "K_00: 984.25 1", "txt:4: K_00: expected FX 0 CX 0 FY CY 0 0 1"},
      {"D_00: -0.37", "D_00:", "txt:5: D_00: 4 numbers, expected 5"},
      {"R_02: 0.6 0.8", "R_02: 0.8 0.6", "txt:14: R_02: R is not a rotation"},
      {"R_02: 0.6 0.8", "R_02: -0.6 -0.8", "txt:14: R_02: the rotation is left-handed"},
      {"T_02:", "T_03:", ": the line T_02: is missing"},
      {"S_00: 1.392000e+03", "S_00: -1", "txt:3: S_00: expected an image's width and height"},
      {kRaw, "", "no line K_00:, expected KITTI's calib_cam_to_cam.txt"},
  };
  for (const BrokenCase& c : raw) {
    SCOPED_TRACE(c.to);
    Write("calib_cam_to_cam.txt", With(kRaw, c.from, c.to));
    EXPECT_THAT(Error("", "kitti_raw"), HasSubstr(c.phrase));
  }
  options_.size = ImageSize{1241, 376};
  Write("calib.txt", With(kCalib, "P1: 7.0e+02 0", "P1: 7.0e+02 1"));
  EXPECT_THAT(Error("", "kitti"), HasSubstr("calib.txt:2: P1: expected the projection of a rect"));
  Write("calib.txt", "R0: 1");
  EXPECT_THAT(Error("", "kitti"), HasSubstr("no line P0:, expected KITTI's calib.txt"));
}

}  // namespace
}  // namespace rigel
