// nuScenes' tables: cameras of one drive among those of others, what is refused.
#include "rigel/problems/rigs/nuscenes_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kSensors[] = R"([
{"token": "s1", "channel": "CAM_FRONT", "modality": "camera"},
{"token": "s2", "channel": "LIDAR_TOP", "modality": "lidar"},
{"token": "s3", "channel": "CAM_BACK", "modality": "camera"}
])";

constexpr char kTable[] = R"([
{"token": "a", "sensor_token": "s1", "translation": [1.7, 0.016, 1.51],
 "rotation": [0.5, -0.5, 0.5, -0.5],
 "camera_intrinsic": [[1266.5, 0.0, 816.25], [0.0, 1266.25, 491.5], [0.0, 0.0, 1.0]]},
{"token": "b", "sensor_token": "s2", "translation": [0.94, 0.0, 1.84],
 "rotation": [0.8, 0, 0, 0.6], "camera_intrinsic": []},
{"token": "c", "sensor_token": "s3", "translation": [0.028, 0.003, 1.57],
 "rotation": [0.5, -0.5, -0.5, 0.5],
 "camera_intrinsic": [[809.25, 0.0, 829.25], [0.0, 809.0, 481.75], [0.0, 0.0, 1.0]]},
{"token": "d", "sensor_token": "s1", "translation": [1.75, 0.016, 1.51],
 "rotation": [0.5, -0.5, 0.5, -0.5],
 "camera_intrinsic": [[1250, 0.0, 816.25], [0.0, 1250, 491.5], [0.0, 0.0, 1.0]]}
])";

class NuscenesRig : public RigFilesTest {
 protected:
  void SetUp() override {
    RigFilesTest::SetUp();
    Write("sensor.json", kSensors);
    Write("calibrated_sensor.json", kTable);
  }
};

TEST_F(NuscenesRig, HasTheCamerasOfADrive) {
  for (const char* name : {"", "calibrated_sensor.json"}) {
    const Calibration calibration = Read(name, "nuscenes");
    EXPECT_THAT(calibration.rig.camera_names, ElementsAre("CAM_FRONT", "CAM_BACK"));
    EXPECT_THAT(calibration.notes,
                ElementsAre("rig 0 of 2", "image size: 1600 x 900, as all of nuScenes"));
    EXPECT_EQ(calibration.rig.down, -Eigen::Vector3d::UnitZ());
    const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
    ASSERT_EQ(cameras.size(), 2u);
    ExpectLens(cameras[0], {CameraModel::kPinhole, {1266.5, 1266.25, 816.25, 491.5}, 1600, 900});
    Eigen::Matrix3d front;  // looks along x, with its right along -y
    front << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    ExpectPose(cameras[0], front, {1.7, 0.016, 1.51});
  }
  options_.index = 1;
  options_.size = ImageSize{800, 450};
  const Calibration second = Read("", "nuscenes");
  EXPECT_THAT(second.notes, ElementsAre("rig 1 of 2", "this rig has 1 cameras, others have 2"));
  EXPECT_EQ(second.rig.rig.cameras[0].intrinsics.width, 800);
  options_.index = 2;
  EXPECT_THAT(Error("", "nuscenes"), HasSubstr("has 2 rigs, expected an index below"));
}

TEST_F(NuscenesRig, BrokenOnesAreRefused) {
  const BrokenCase cases[] = {
      {"\"sensor_token\": \"s1\",", "", "the key 'sensor_token' is missing"},
      {"\"sensor_token\": \"s1\"", "\"sensor_token\": 1", "sensor_token is '1', expected a text"},
      {"[0.5, -0.5, 0.5, -0.5]", "[0.5, -0.5, 0.5]",
       "CAM_FRONT: rotation is an array, expected 4 finite numbers"},
      {"[0.5, -0.5, 0.5, -0.5]", "[0.5, -0.5, 0.5, 5]",
       "CAM_FRONT: rotation: the quaternion has a norm that is not 1"},
      {"[1.7, 0.016, 1.51]", "[1.7, null, 1.51]", "CAM_FRONT: translation is an array"},
      {"[0.0, 1266.25, 491.5]", "[0.1, 1266.25, 491.5]", "CAM_FRONT: camera_intrinsic: expected"},
      {"[0.0, 1266.25, 491.5]", "5", "CAM_FRONT: row is '5', expected 3 finite numbers"},
      {"[[1266.5,", "[[-1266.5,", "calibrated_sensor.json: "},
      {kTable, "{}", "expected an array of at least one object"},
      {kTable, R"([{"sensor_token": "s2"}])", "no camera, expected sensors that sensor.json has"},
  };
  for (const BrokenCase& c : cases) {
    SCOPED_TRACE(c.to);
    Write("calibrated_sensor.json", With(kTable, c.from, c.to));
    EXPECT_THAT(Error("calibrated_sensor.json", "nuscenes"), HasSubstr(c.phrase));
  }
  Write("sensor.json", "[3]");
  EXPECT_THAT(Error("", "nuscenes"), HasSubstr("sensor.json: '3', expected an object"));
}

}  // namespace
}  // namespace rigel
