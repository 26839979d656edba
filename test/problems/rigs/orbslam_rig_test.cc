// ORB-SLAM3's settings: types of cameras, both versions, what is refused.
#include "rigel/problems/rigs/orbslam_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class OrbslamRig : public RigFilesTest {};

// Keys without a blank after their colon are in files that OpenCV reads.
constexpr char kFisheye[] = R"(%YAML:1.0

#--------------------------------------------------------------------------------------------
# Camera Parameters. Adjust them!
#--------------------------------------------------------------------------------------------
File.version: "1.0"

Camera.type: "KannalaBrandt8"

Camera1.fx: 190.5
Camera1.fy: 190.25
Camera1.cx: 254.5
Camera1.cy: 256.5
Camera1.k1: 0.0034
Camera1.k2: 0.0007
Camera1.k3: -0.002
Camera1.k4: 0.0002

Camera2.fx: 191.5
Camera2.fy: 191.25
Camera2.cx: 252.5
Camera2.cy: 254.5
Camera2.k1: 0.0033
Camera2.k2: 0.0017
Camera2.k3: -0.0026
Camera2.k4: 0.0003

# Transformation matrix from right camera to left camera
Stereo.T_c1_c2: !!opencv-matrix
  rows: 4
  cols: 4
  dt: f
  data:[ 1.0, 0.0, 0.0, 0.1,
         0.0, 1.0, 0.0, 0.02,
         0.0, 0.0, 1.0, 0.0,
         0.0, 0.0, 0.0, 1.0]

Camera.width: 512
Camera.height: 510

# Transformation from body-frame (imu) to left camera
IMU.T_b_c1: !!opencv-matrix
   rows: 4
   cols: 4
   dt: f
   data: [0.6, -0.8, 0.0, 0.5,
          0.8, 0.6, 0.0, 0.25,
          0.0, 0.0, 1.0, -1.0,
          0.0, 0.0, 0.0, 1.0]
Viewer.PointSize:2
)";

constexpr char kRectified[] = R"(%YAML:1.0

File.version: "1.0"
Camera.type: "Rectified"
Camera1.fx: 718.75
Camera1.fy: 718.75
Camera1.cx: 607.25
Camera1.cy: 185.25
Camera.width: 1241
Camera.height: 376
Stereo.b: 0.5
)";

// As before version 1.0.
constexpr char kOlder[] = R"(%YAML:1.0
Camera.type: "PinHole"
Camera.fx: 435
Camera.fy: 436
Camera.cx: 367.5
Camera.cy: 252.25
Camera.k1: 0.0
Camera.k2: 0.0
Camera.p1: 0.0
Camera.p2: 0.0
Camera.bf: 47.85
)";

TEST_F(OrbslamRig, FisheyesOnAnImu) {
  Write("TUM-VI.yaml", kFisheye);
  const Calibration calibration = Read("TUM-VI.yaml", "orbslam3");
  EXPECT_EQ(calibration.body, "the IMU");
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("camera1", "camera2"));
  const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 2u);
  ExpectPose(cameras[0], TurnZ(), {0.5, 0.25, -1});
  ExpectPose(cameras[1], TurnZ(),
             TurnZ() * Eigen::Vector3d(0.1, 0.02, 0) + Eigen::Vector3d(0.5, 0.25, -1));
  ExpectLens(cameras[1], {CameraModel::kOpencvFisheye,
                          {191.5, 191.25, 252.5, 254.5, 0.0033, 0.0017, -0.0026, 0.0003},
                          512,
                          510});
}

TEST_F(OrbslamRig, OlderKeysAreTheSame) {
  std::string text = With(With(kFisheye, "IMU.T_b_c1", "Tbc"), "Stereo.T_c1_c2", "Tlr");
  text = With(text, ",\n         0.0, 0.0, 0.0, 1.0]\n\nCamera.width", "]\n\nCamera.width");
  for (size_t at; (at = text.find("Camera1.")) != std::string::npos;) text.erase(at + 6, 1);
  Write("older.yaml", text);
  Write("newer.yaml", kFisheye);
  ExpectSame(Read("older.yaml", "orbslam3").rig, Read("newer.yaml", "orbslam3").rig);
}

TEST_F(OrbslamRig, RectifiedCamerasHaveABaseline) {
  Write("KITTI00-02.yaml", kRectified);
  std::vector<RigCamera> cameras = Read("KITTI00-02.yaml", "orbslam3").rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 2u);
  ExpectPose(cameras[1], Eigen::Matrix3d::Identity(), {0.5, 0, 0});
  ExpectLens(cameras[1], {CameraModel::kPinhole, {718.75, 718.75, 607.25, 185.25}, 1241, 376});

  Write("older.yaml", kOlder);
  EXPECT_THAT(Error("older.yaml", "orbslam3"), HasSubstr("no Camera.width, expected it or"));
  options_.size = ImageSize{752, 480};
  cameras = Read("older.yaml", "orbslam3").rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 2u);
  ExpectPose(cameras[1], Eigen::Matrix3d::Identity(), {0.11, 0, 0});
  ExpectLens(cameras[0], {CameraModel::kPinhole, {435, 436, 367.5, 252.25}, 752, 480});
}

TEST_F(OrbslamRig, OneCameraWithDistortion) {
  options_.size = ImageSize{752, 480};
  std::string text = With(With(kOlder, "Camera.bf: 47.85\n", ""), "k1: 0.0", "k1: -0.25");
  Write("mono.yaml", With(text, "p2: 0.0", "p2: 0.001\nCamera.k3: 0.5"));
  const std::vector<RigCamera> cameras = Read("mono.yaml", "orbslam3").rig.rig.cameras;
  ASSERT_EQ(cameras.size(), 1u);
  ExpectLens(
      cameras[0],
      {CameraModel::kFullOpencv, {435, 436, 367.5, 252.25, -0.25, 0, 0, 0.001, 0.5}, 752, 480});
}

TEST_F(OrbslamRig, BrokenOnesAreRefused) {
  const BrokenCase cases[] = {
      {"\"KannalaBrandt8\"", "\"Omni\"", ":8: Camera.type is 'Omni', expected PinHole, Rectified"},
      {"Camera.type", "Type", "the key Camera.type is missing"},
      {"Camera1.fy: 190.25", "Camera1.fy: wide", ":11: Camera1.fy is 'wide', expected a finite"},
      {"Camera1.fx: 190.5", "Camera1.fx: -190.5", ":10: Camera1: "},
      {"Camera.height: 510", "Camera.height: 0", ":39: Camera.height: expected an image's width"},
      {"Stereo.T_c1_c2", "Stereo.T_c2_c1", ":19: Camera2 without a pose, expected Stereo.T_c1_c2"},
      {"1.0, 0.0, 0.02", "-1.0, 0.0, 0.02", ":29: Stereo.T_c1_c2: the rotation is left-handed"},
      {"0.0, 0.0, 1.0, -1.0", "0.0, 0.0 1.0, -1.0", "IMU.T_b_c1 has '0.0 1.0', expected finite"},
  };
  for (const BrokenCase& c : cases) {
    SCOPED_TRACE(c.to);
    Write("broken.yaml", With(kFisheye, c.from, c.to));
    EXPECT_THAT(Error("broken.yaml", "orbslam3"), HasSubstr(c.phrase));
  }
  Write("broken.yaml", With(kRectified, "Stereo.b: 0.5", "Stereo.b: 0"));
  EXPECT_THAT(Error("broken.yaml", "orbslam3"),
              HasSubstr(":11: Stereo.b: expected a positive number"));
}

}  // namespace
}  // namespace rigel
