// Argoverse 2's tables as CSV: columns in any order, what is refused.
#include "rigel/problems/rigs/argoverse_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// With pandas' index before the columns.
constexpr char kIntrinsics[] =
    ",sensor_name,fx_px,fy_px,cx_px,cy_px,k1,k2,k3,height_px,width_px\n"
    "0,ring_front_center,1776.5,1776.25,777.5,1013.5,-0.24,-0.21,0.33,2048,1550\n"
    "1,ring_side_left,1687.5,1687.5,1031.5,768.25,-0.28,-0.04,0.1,1550,2048\n";
constexpr char kPoses[] =
    "sensor_name,qw,qx,qy,qz,tx_m,ty_m,tz_m\n"
    "ring_front_center,0.5,-0.5,0.5,-0.5,1.635,0.0027,1.398\n"
    "up_lidar,1,0,0,0,1.35,0,1.64\n"
    "ring_side_left,0.8,0,0,0.6,1.3,0.25,1.4\n";

class ArgoverseRig : public RigFilesTest {
 protected:
  void SetUp() override {
    RigFilesTest::SetUp();
    Write("calibration/intrinsics.csv", kIntrinsics);
    Write("calibration/egovehicle_SE3_sensor.csv", kPoses);
  }
};

TEST_F(ArgoverseRig, JoinsBothTables) {
  for (const char* name :
       {"", "calibration", "calibration/intrinsics.csv", "calibration/egovehicle_SE3_sensor.csv"}) {
    const Calibration calibration = Read(name, "argoverse2");
    EXPECT_THAT(calibration.rig.camera_names, ElementsAre("ring_front_center", "ring_side_left"));
    EXPECT_THAT(calibration.notes,
                ElementsAre("k1, k2, k3 are left out: the images are undistorted"));
    const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
    ASSERT_EQ(cameras.size(), 2u);
    ExpectLens(cameras[0], {CameraModel::kPinhole, {1776.5, 1776.25, 777.5, 1013.5}, 1550, 2048});
    Eigen::Matrix3d front;
    front << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    ExpectPose(cameras[0], front, {1.635, 0.0027, 1.398});
  }
}

TEST_F(ArgoverseRig, BrokenOnesAreRefused) {
  const BrokenCase cases[] = {
      {"fx_px", "f", "intrinsics.csv:1: no column fx_px, expected a first line with the names"},
      {"1776.5,", "", "intrinsics.csv:2: 10 cells, expected 11"},
      {"1776.5", "", "intrinsics.csv:2: fx_px is '', expected a finite number"},
      {"0,ring_front_center", "0,ring_front", "intrinsics.csv:2: 'ring_front' has no row in "},
      {"2048,1550\n", "2048,0\n", "intrinsics.csv:2: width_px: expected an image's width"},
      {"1776.5", "-1", "calibration/intrinsics.csv"},
      {kIntrinsics, "", "intrinsics.csv: no column sensor_name"},
      {kIntrinsics, "sensor_name,fx_px,fy_px,cx_px,cy_px,width_px,height_px",
       "no camera, expected"},
  };
  for (const BrokenCase& c : cases) {
    SCOPED_TRACE(c.to);
    Write("calibration/intrinsics.csv", With(kIntrinsics, c.from, c.to));
    EXPECT_THAT(Error("calibration/intrinsics.csv", "argoverse2"), HasSubstr(c.phrase));
  }
  Write("calibration/egovehicle_SE3_sensor.csv", With(kPoses, "0.6", "0.7"));
  EXPECT_THAT(Error("", "argoverse2"),
              HasSubstr("egovehicle_SE3_sensor.csv:4: ring_side_left: the quaternion has a norm"));
}

}  // namespace
}  // namespace rigel
