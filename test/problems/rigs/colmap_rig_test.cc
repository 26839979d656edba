// COLMAP's rigs: both forms of rig_config.json, rigs.txt, the origin of pixels, what is refused.
#include "rigel/problems/rigs/colmap_rig.h"

#include "rigel/test/problems/rigs/rig_files.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ColmapRig : public RigFilesTest {
 protected:
  void SetUp() override {
    RigFilesTest::SetUp();
    Write("cameras.txt",
          "# Camera list with one line of data per camera:\n"
          "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
          "# Number of cameras: 2\n"
          "3 PINHOLE 1920 1080 1200 1201 960.5 540.5\n"
          "5 SIMPLE_RADIAL 640 480 700 320 240 -0.125\n");
  }

  // The two cameras: the reference, and one that is turned and moved.
  static void ExpectRig(const Calibration& calibration) {
    const std::vector<RigCamera>& cameras = calibration.rig.rig.cameras;
    ASSERT_EQ(cameras.size(), 2u);
    ExpectPose(cameras[0], Eigen::Matrix3d::Identity(), {0, 0, 0});
    // cam_from_rig: a turn of the angle with cosine 0.28 about z, then a shift.
    Eigen::Matrix3d R;
    R << 0.28, -0.96, 0, 0.96, 0.28, 0, 0, 0, 1;
    ExpectPose(cameras[1], R.transpose(), -R.transpose() * Eigen::Vector3d(0.5, 0.25, 1));
    // Their pixels begin half a pixel earlier.
    ExpectLens(cameras[0], {CameraModel::kPinhole, {1200, 1201, 960, 540}, 1920, 1080});
    ExpectLens(cameras[1], {CameraModel::kSimpleRadial, {700, 319.5, 239.5, -0.125}, 640, 480});
  }
};

constexpr char kNewer[] = R"([
  {
    "cameras": [
      {"image_prefix": "rig1/front/", "ref_sensor": true},
      {
        "image_prefix": "rig1/left/",
        "cam_from_rig_rotation": [0.8, 0.0, 0.0, 0.6],
        "cam_from_rig_translation": [0.5, 0.25, 1]
      }
    ]
  }
])";

constexpr char kOlder[] = R"([
  {
    "ref_camera_id": 3,
    "cameras": [
      {"camera_id": 3, "image_prefix": "front", "rel_qvec": [1, 0, 0, 0], "rel_tvec": [0, 0, 0]},
      {"camera_id": 5, "image_prefix": "left",
       "rel_qvec": [0.8, 0, 0, 0.6], "rel_tvec": [0.5, 0.25, 1]}
    ]
  }
])";

constexpr char kRigs[] =
    "# Rig calib list with one line of data per calib:\n"
    "#   RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, "
    "SENSOR_ID, HAS_POSE, [QW, QX, QY, QZ, TX, TY, TZ])\n"
    "# Number of rigs: 2\n"
    "1 2 CAMERA 3 CAMERA 5 1 0.8 0 0 0.6 0.5 0.25 1\n"
    "2 1 CAMERA 5\n";

TEST_F(ColmapRig, OfCamFromRig) {
  Write("rig_config.json", kNewer);
  const Calibration calibration = Read("rig_config.json", "colmap");
  ExpectRig(calibration);
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("rig1/front", "rig1/left"));
  EXPECT_THAT(calibration.rig.camera_images, ElementsAre("rig1/front", "rig1/left"));
  EXPECT_THAT(calibration.notes,
              ElementsAre("lenses are those of cameras.txt in its order: no images.txt"));
}

TEST_F(ColmapRig, ImagesSayWhichCameraAPrefixHas) {
  Write("rig_config.json", With(With(kNewer, "rig1/front", "x"), "rig1/left", "rig1/front"));
  Write("rig_config.json", With(kNewer, "rig1/front/", "b/"));
  Write("images.txt",
        "# Image list with two lines of data per image:\n"
        "1 1 0 0 0 0 0 0 5 rig1/left/1.jpg\n"
        "10.5 11.5 -1 12.5 13.5 7\n"
        "2 1 0 0 0 0 0 0 3 b/1.jpg\n"
        "\n"
        "3 1 0 0 0 0 0 0 3 b/2.jpg\n"
        "1.5 2.5 -1\n");
  const Calibration calibration = Read("rig_config.json", "colmap");
  ExpectRig(calibration);
  EXPECT_THAT(calibration.notes, IsEmpty());
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("b", "rig1/left"));
}

TEST_F(ColmapRig, LensesOfTheRigComeFirst) {
  Write("rig_config.json", With(kNewer, R"("ref_sensor": true)",
                                R"("ref_sensor": true, "camera_model_name": "OPENCV",
                                   "camera_params": [7, 8, 3, 4, 0.1, 0.2, 0.01, 0.02])"));
  const RigCamera camera = Read("rig_config.json", "colmap").rig.rig.cameras[0];
  ExpectLens(camera, {CameraModel::kOpencv, {7, 8, 2.5, 3.5, 0.1, 0.2, 0.01, 0.02}, 1920, 1080});
}

TEST_F(ColmapRig, OfRelativePoses) {
  Write("rig_config.json", kOlder);
  const Calibration calibration = Read("rig_config.json", "colmap");
  ExpectRig(calibration);
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("front", "left"));
  EXPECT_THAT(calibration.notes, IsEmpty());
  // The reference may do without.
  Write("rig_config.json",
        With(kOlder, R"(, "rel_qvec": [1, 0, 0, 0], "rel_tvec": [0, 0, 0])", ""));
  ExpectRig(Read("rig_config.json", "colmap"));
}

TEST_F(ColmapRig, OfATextModel) {
  Write("rigs.txt", kRigs);
  Calibration calibration = Read("rigs.txt", "colmap");
  ExpectRig(calibration);
  EXPECT_THAT(calibration.rig.camera_names, ElementsAre("camera_3", "camera_5"));
  EXPECT_THAT(calibration.notes, ElementsAre("rig 0 of 2"));
  ExpectRig(Read("", "colmap"));  // of the folder
  options_.index = 1;
  EXPECT_EQ(Read("rigs.txt", "colmap").rig.rig.size(), 1);
  options_.index = 2;
  EXPECT_THAT(Error("rigs.txt", "colmap"), HasSubstr("has 2 rigs, expected an index below"));
  options_.index = 0;
  // An IMU is no camera, but the rig's frame may be one.
  Write("rigs.txt", "1 3 IMU 1 CAMERA 3 1 1 0 0 0 0 0 0 CAMERA 5 1 0.8 0 0 0.6 0.5 0.25 1\n");
  ExpectRig(Read("rigs.txt", "colmap"));
}

TEST_F(ColmapRig, CamerasMayBeElsewhere) {
  Write("project/rig_config.json", kOlder);
  EXPECT_THAT(Error("project/rig_config.json", "colmap"), HasSubstr("project/cameras.txt"));
  options_.cameras = Path("cameras.txt");
  ExpectRig(Read("project/rig_config.json", "colmap"));
}

TEST_F(ColmapRig, BrokenOnesAreRefused) {
  const BrokenCase newer[] = {
      {"0.6]", "0.7]", "rig 0, camera 1: cam_from_rig_rotation: the quaternion has a norm"},
      {"[0.8, 0.0, 0.0, 0.6]", "[0.8, 0.0, 0.6]",
       "cam_from_rig_rotation is an array, expected 4 finite numbers"},
      {"0.25, 1]", "\"a\", 1]", "cam_from_rig_translation is an array, expected 3 finite numbers"},
      {"\"image_prefix\": \"rig1/left/\",", "", "camera 1: the key 'image_prefix' is missing"},
      {"[0.5, 0.25, 1]", "[0.5, 0.25, 1", "parse error"},
      {"\"cameras\"", "\"kameras\"", "rig 0: expected an array 'cameras'"},
      {"{\"image_prefix\": \"rig1/front/\", \"ref_sensor\": true},", "",
       "which camera of cameras.txt has which image_prefix is not known"},
      {"\"ref_sensor\": true", "\"ref_sensor\": false", "rig1/front has no pose in the rig"},
      {kNewer, "[]", "an array, expected an array of at least one object"},
      {kNewer, "[[1]]", "rig 0: expected an array 'cameras'"},
      {kNewer, "[{\"cameras\": [1]}]", "camera 0: '1', expected an object"},
      {kNewer, "[{\"cameras\": []}]", "a rig without cameras"},
  };
  for (const BrokenCase& c : newer) {
    SCOPED_TRACE(c.to);
    Write("rig_config.json", With(kNewer, c.from, c.to));
    EXPECT_THAT(Error("rig_config.json", "colmap"), HasSubstr(c.phrase));
  }
  Write("rig_config.json", With(kOlder, "\"camera_id\": 5", "\"camera_id\": 4"));
  EXPECT_THAT(Error("rig_config.json", "colmap"),
              HasSubstr("left: camera 4 is not in cameras.txt"));

  const BrokenCase rigs[] = {
      {"1 2 CAMERA", "1 3 CAMERA", "rigs.txt:4: the line ends, expected a sensor's type"},
      {"5 1 0.8", "5 0 0.8", "rigs.txt:4: more words than NUM_SENSORS sensors have"},
      {"5 1 0.8 0 0 0.6 0.5 0.25 1", "5 0", "camera_5 has no pose in the rig"},
      {"0.25 1", "0.25 x", "rigs.txt:4: TX TY TZ is 'x', expected a finite number"},
      {"1 2 CAMERA 3", "1 2 CAMERA -3", "rigs.txt:4: a sensor's ID is '-3', expected a number"},
      {kRigs, "# no rig\n", "no rig, expected COLMAP's rigs.txt"},
  };
  for (const BrokenCase& c : rigs) {
    SCOPED_TRACE(c.to);
    Write("rigs.txt", With(kRigs, c.from, c.to));
    EXPECT_THAT(Error("rigs.txt", "colmap"), HasSubstr(c.phrase));
  }

  Write("rigs.txt", kRigs);
  const struct {
    const char *text, *phrase;
  } cameras[] = {
      {"", "no camera, expected COLMAP's cameras.txt"},
      {"3 PINHOLE 1920", "cameras.txt:1: expected CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS"},
      {"x PINHOLE 1920 1080 1 1 1 1", "cameras.txt:1: CAMERA_ID is 'x', expected a number from 0"},
      {"3 PINHOLE 1920 1080 1 1 1", "camera 3: PINHOLE with 3 parameters, expected 4: fx fy cx cy"},
      {"3 PINHOLE 1920 0 1 1 1 1", "camera 3: HEIGHT: expected an image's width and height"},
      {"3 PINHOLE 1920 1080 0 1 1 1", "cameras.txt:1: camera 3: "},
      {"3 RAD_TAN_THIN 9 9 1 1 1 1", "camera 3: camera model 'RAD_TAN_THIN' is not read, expected"},
      {"3 OMNI 9 9 1 1 1 1 1 0 0 0 0", "camera 3: camera model 'OMNI' is not read"},
      {"3 PINHOLE 9 9 1 1 1 1\n3 PINHOLE 9 9 1 1 1 1", "cameras.txt:2: camera 3: is there twice"},
  };
  for (const auto& c : cameras) {
    SCOPED_TRACE(c.text);
    Write("cameras.txt", c.text);
    EXPECT_THAT(Error("rigs.txt", "colmap"), HasSubstr(c.phrase));
  }
}

}  // namespace
}  // namespace rigel
