// Kalibr's and OpenVINS' YAML: chains, both directions of the poses, each lens, what is refused.
#include "rigel/problems/rigs/kalibr_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class KalibrRig : public RigFilesTest {};

// As kalibr_calibrate_cameras writes it.
constexpr char kCamchain[] = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.7e-05]
  distortion_model: radtan
  intrinsics: [458.5, 457.25, 367.5, 248.375]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0, 2]
  camera_model: omni
  distortion_coeffs: [-0.3, 0.1, 0.0005, 0.0006]
  distortion_model: radtan
  intrinsics: [0.8, 833.0, 830.5, 373.75, 253.5]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
cam2:
  T_cn_cnm1:
  - [0.6, 0.8, 0.0, 0.5]
  - [-0.8, 0.6, 0.0, 0.0]
  - [0.0, 0.0, 1.0, -0.25]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: ds
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [-0.2, 0.6, 400.0, 401.0, 320.5, 240.5]
  resolution: [640, 480]
  rostopic: /cam2/image_raw
)";

// As kalibr_calibrate_imu_camera writes it: T_cam_imu is camera_from_imu.
constexpr char kImucam[] = R"(cam0:
  T_cam_imu:
  - [0.6, 0.8, 0.0, 0.1]
  - [-0.8, 0.6, 0.0, 0.2]
  - [0.0, 0.0, 1.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]
  distortion_model: equidistant
  intrinsics: [190.9, 190.8, 254.9, 256.8]
  resolution: [512, 512]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: -0.0021
)";

TEST_F(KalibrRig, AChainBeginsAtTheFirstCamera) {
  Write("camchain.yaml", kCamchain);
  const Calibration calibration = Read("camchain.yaml", "kalibr");
  EXPECT_THAT(calibration.notes, IsEmpty());
  EXPECT_EQ(calibration.body, "cam0");
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("cam0", "cam1", "cam2"));
  const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 3u);
  ExpectPose(cameras[0], Eigen::Matrix3d::Identity(), {0, 0, 0});
  // X_1 = X_0 - 0.11 e_x: camera 1 is to the right.
  ExpectPose(cameras[1], Eigen::Matrix3d::Identity(), {0.11, 0, 0});
  // X_2 = R (X_0 - 0.11 e_x) + t, R the inverse of TurnZ().
  ExpectPose(cameras[2], TurnZ(), Eigen::Vector3d(0.11, 0, 0) + Eigen::Vector3d(-0.3, -0.4, 0.25));
  using M = CameraModel;
  ExpectLens(cameras[0],
             {M::kOpencv, {458.5, 457.25, 367.5, 248.375, -0.28, 0.07, 0.0002, 1.7e-05}, 752, 480});
  ExpectLens(cameras[1],
             {M::kOmni, {0.8, 833, 830.5, 373.75, 253.5, -0.3, 0.1, 0.0005, 0.0006}, 752, 480});
  ExpectLens(cameras[2], {M::kDoubleSphere, {-0.2, 0.6, 400, 401, 320.5, 240.5}, 640, 480});
}

TEST_F(KalibrRig, ThePoseToTheImuIsInverted) {
  Write("camchain-imucam.yaml", kImucam);
  const Calibration calibration = Read("camchain-imucam.yaml", "kalibr");
  EXPECT_EQ(calibration.body, "the IMU");
  ASSERT_EQ(calibration.rig.rig.size(), 1);
  const RigCamera& camera = calibration.rig.rig.cameras[0];
  ExpectPose(camera, TurnZ(), -TurnZ() * Eigen::Vector3d(0.1, 0.2, 0.3));
  ExpectLens(camera, {CameraModel::kOpencvFisheye,
                      {190.9, 190.8, 254.9, 256.8, 0.003, 0.0007, -0.002, 0.0002},
                      512,
                      512});
  EXPECT_EQ(camera.time_offset, -0.0021);
}

TEST_F(KalibrRig, OpenVinsHasTheOtherDirectionAndOpenCvsFirstLine) {
  // Its key names body_from_camera; comments and a file type stand in the file.
  const std::string text =
      "%YAML:1.0 # need to specify the file type at the top!\n\n" +
      With(With(kImucam, "T_cam_imu:", "T_imu_cam: #rotation from camera to IMU"), "256.8]",
           "256.8] #fu, fv, cu, cv");
  Write("kalibr_imucam_chain.yaml", text);
  for (const char* format : {"kalibr", "openvins"}) {
    detected_ = "kalibr";
    const Calibration calibration = Read("kalibr_imucam_chain.yaml", format);
    ASSERT_EQ(calibration.rig.rig.size(), 1);
    ExpectPose(calibration.rig.rig.cameras[0], TurnZ().transpose(), {0.1, 0.2, 0.3});
  }
}

TEST_F(KalibrRig, TheImuCountsWhereAFileHasBoth) {
  std::string text = kImucam + With(kImucam, "cam0:", "cam1:");
  text += With(
      "  T_cn_cnm1:\n  - [1, 0, 0, D]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n"
      "  - [0, 0, 0, 1]\n",
      "D", "-0.3");
  Write("both.yaml", text);
  const Calibration calibration = Read("both.yaml", "kalibr");
  ASSERT_EQ(calibration.rig.rig.size(), 2);
  EXPECT_EQ(calibration.rig.rig.cameras[0].s, calibration.rig.rig.cameras[1].s);
  EXPECT_THAT(calibration.notes,
              ElementsAre("cam1: T_cn_cnm1 differs from the pose to the IMU by 0.00 degrees and "
                          "0.300 m; the pose to the IMU is taken"));
  Write("same.yaml", With(text, "-0.3]", "0]"));
  EXPECT_THAT(Read("same.yaml", "kalibr").notes, IsEmpty());
}

TEST_F(KalibrRig, ReadsEachLens) {
  using M = CameraModel;
  const struct {
    const char *model, *intrinsics, *distortion, *coefficients;
    Camera camera;
  } cases[] = {
      {"pinhole", "[7, 8, 3, 4]", "none", "[]", {M::kPinhole, {7, 8, 3, 4}}},
      {"pinhole", "[7, 8, 3, 4]", "radtan", "[0, 0, 0, 0]", {M::kPinhole, {7, 8, 3, 4}}},
      {"pinhole", "[7, 8, 3, 4]", "fov", "[0.9]", {M::kFov, {7, 8, 3, 4, 0.9}}},
      {"omni", "[1.5, 7, 8, 3, 4]", "none", "[]", {M::kOmni, {1.5, 7, 8, 3, 4}}},
      {"eucm", "[0.5, 1.1, 7, 8, 3, 4]", "none", "[]", {M::kEucm, {0.5, 1.1, 7, 8, 3, 4}}}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.model + std::string(c.distortion));
    std::string text =
        With(kImucam, "camera_model: pinhole", std::string("camera_model: ") + c.model);
    text = With(text, "[190.9, 190.8, 254.9, 256.8]", c.intrinsics);
    text = With(text, "equidistant", c.distortion);
    Write("lens.yaml", With(text, "[0.003, 0.0007, -0.002, 0.0002]", c.coefficients));
    Camera expected = c.camera;
    expected.width = expected.height = 512;
    ExpectLens(Read("lens.yaml", "kalibr").rig.rig.cameras[0], expected);
  }
}

TEST_F(KalibrRig, BrokenOnesAreRefused) {
  const BrokenCase cases[] = {
      {"cam0:", "camera0:", ": the key cam0 is missing, expected cam0, cam1, ..."},
      {"camera_model: pinhole", "camera_model: fisheye",
       ":8: cam0: camera_model 'fisheye' with distortion_model 'equidistant', expected pinhole"},
      {"distortion_model: equidistant", "distortion_model: fov",
       ":9: cam0: distortion_coeffs has 4 numbers, expected 1"},
      {"[190.9, 190.8, 254.9, 256.8]", "[190.9, 190.8, 254.9]",
       ":11: cam0: intrinsics has 3 numbers, expected 4"},
      {"[190.9,", "[-190.9,", ":11: cam0: "},
      {"[190.9,", "[many,", ":11: cam0: intrinsics has 'many', expected finite numbers"},
      {"[512, 512]", "[512, 0]", ":12: cam0: resolution: expected an image's width and height"},
      {"resolution", "size", "cam0: the key resolution is missing"},
      {"- [0.6, 0.8, 0.0, 0.1]", "- [0.6, -0.8, 0.0, 0.1]",
       ":3: cam0: T_cam_imu: R is not a rotation, expected orthonormal rows to 0.001"},
      {"- [0.6, 0.8, 0.0, 0.1]", "- [-0.6, -0.8, 0.0, 0.1]",
       ":3: cam0: T_cam_imu: the rotation is left-handed"},
      {"0.0, 0.0, 0.0, 1.0", "0.0, 0.0, 0.0, 2.0", ":3: cam0: T_cam_imu: the last row is not"},
      {"timeshift_cam_imu: -0.0021", "timeshift_cam_imu: soon",
       ":14: cam0: timeshift_cam_imu is 'soon', expected a finite number"},
      {"cam_overlaps: []", "cam_overlaps: [", ", expected YAML"},
      {"cam0:", "cam1: {}\ncam0:", ":1: cam1: no pose, expected T_cam_imu, T_imu_cam or T_cn_cnm1"},
      {"cam0:", "cam2: {}\ncam0:", ":1: cam2 without cam1, expected cam0, cam1, ..."},
      {kImucam, "", "expected YAML with keys"},
  };
  for (const BrokenCase& c : cases) {
    SCOPED_TRACE(c.to);
    Write("broken.yaml", With(kImucam, c.from, c.to));
    EXPECT_THAT(Error("broken.yaml", "kalibr"), HasSubstr(c.phrase));
  }
  EXPECT_THAT(Error("absent.yaml", "kalibr"), HasSubstr("absent.yaml"));
}

}  // namespace
}  // namespace rigel
