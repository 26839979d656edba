// What is told of a rig: inverted poses, orders of quaternions, directions, units, lenses.
#include "rigel/problems/rigs/rig_check.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Cameras around a car, x forward and z up, that look outwards and a little down.
RigFile Ring(const std::vector<double>& yaws_deg) {
  RigFile file;
  for (const double yaw_deg : yaws_deg) {
    const double yaw = DegToRad(yaw_deg);
    const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), -0.05);
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(1200, 1200, 800, 450, 1600, 900);
    camera.Q.col(2) = ahead.normalized();
    camera.Q.col(0) = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
    camera.Q.col(1) = camera.Q.col(2).cross(camera.Q.col(0));
    camera.s = Eigen::Vector3d(1.5 * std::cos(yaw), 0.5 * std::sin(yaw), 1.5);
    file.rig.cameras.push_back(camera);
    file.camera_names.push_back("yaw" + std::to_string(static_cast<int>(yaw_deg)));
  }
  return file;
}

std::vector<std::vector<double>> Rings() {
  return {{0, 60, 120, 180, 240, 300}, {0, 90, 180, 270}, {-45, 0, 45}, {0, 90}, {-100, 0, 100}};
}

// The pose whose quaternion, written x y z w, is read as w x y z.
Eigen::Matrix3d Misread(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
}

TEST(RigCheck, GoodRigsHaveNoWarnings) {
  for (const std::vector<double>& yaws : Rings()) {
    const RigFile file = Ring(yaws);
    EXPECT_THAT(RigWarnings(file, true), IsEmpty());
    EXPECT_NEAR(LookOf(file.rig).upright, 1, 0.01);
    EXPECT_GT(LookOf(file.rig).outward, 0.5);
  }
}

TEST(RigCheck, InvertedPosesAreTold) {
  for (const std::vector<double>& yaws : Rings()) {
    if (yaws == std::vector<double>{-45, 0, 45}) continue;  // 0.8 upright when inverted
    RigFile file = Ring(yaws);
    file.rig = InvertedRig(file.rig);
    EXPECT_THAT(RigWarnings(file, false),
                ElementsAre("poses look inverted: as the inverse of what the file says the cameras "
                            "stand upright and look outwards"));
    file.down = -Eigen::Vector3d::UnitZ();
    EXPECT_THAT(RigWarnings(file, true), testing::Contains(HasSubstr("poses look inverted")));
  }
}

TEST(RigCheck, CamerasThatLookOneWayAreToldByTheBodysDown) {
  RigFile file = Ring({0, 0});
  file.rig.cameras[1].s.y() = 0.5;
  file.down = -Eigen::Vector3d::UnitZ();
  EXPECT_THAT(RigWarnings(file, true), IsEmpty());
  file.rig = InvertedRig(file.rig);
  EXPECT_THAT(RigWarnings(file, true),
              ElementsAre("down of the cameras is 90 degrees from the body's down -z: poses look "
                          "inverted or of another body frame"));
}

TEST(RigCheck, QuaternionsOfTheOtherOrderAreTold) {
  const char* const expected =
      "quaternions look like x y z w: in that order the cameras stand upright and look outwards";
  for (const std::vector<double>& yaws : Rings()) {
    if (yaws == std::vector<double>{-45, 0, 45}) continue;
    RigFile file = Ring(yaws);
    for (RigCamera& camera : file.rig.cameras) camera.Q = Misread(camera.Q);
    EXPECT_THAT(RigWarnings(file, true), testing::Contains(expected));
    EXPECT_THAT(RigWarnings(file, false), testing::Not(testing::Contains(expected)));
    // The same of a file with camera_from_body.
    RigFile inverse = Ring(yaws);
    for (RigCamera& camera : inverse.rig.cameras) {
      const Pose pose = Pose{camera.Q, camera.s}.Inverse();
      const Pose misread = Pose{Misread(pose.R), pose.t}.Inverse();
      camera.Q = misread.R;
      camera.s = misread.t;
    }
    EXPECT_THAT(RigWarnings(inverse, true), testing::Contains(expected));
  }
  RigFile identity = Ring({0});
  identity.rig.cameras[0].Q = Misread(Eigen::Matrix3d::Identity());
  EXPECT_THAT(RigWarnings(identity, true),
              ElementsAre("yaw0 has the quaternion 0 0 0 1, which is no turn only as x y z w"));
}

TEST(RigCheck, TellsOfDirectionsUnitsAndLenses) {
  RigFile file = Ring({0, 60, 120, 180, 240, 300});
  file.down = Eigen::Vector3d::UnitZ();
  EXPECT_THAT(RigWarnings(file, true), ElementsAre(HasSubstr("from the body's down +z: poses")));

  file = Ring({0, 60, 120, 180});
  file.rig.cameras[1].Q.leftCols<2>() *= -1;
  EXPECT_THAT(RigWarnings(file, true), ElementsAre("yaw60 is upside down, the others are not"));

  file = Ring({0, 60, 120, 180, 240, 300});
  for (RigCamera& camera : file.rig.cameras) camera.s *= 5;
  EXPECT_THAT(RigWarnings(file, true), ElementsAre("cameras are 15.0 m apart"));
  for (RigCamera& camera : file.rig.cameras) camera.s *= 200;
  EXPECT_THAT(RigWarnings(file, true),
              ElementsAre("cameras are 3000.0 m apart: positions look like millimetres"));
  for (RigCamera& camera : file.rig.cameras) camera.s *= 0;
  EXPECT_THAT(RigWarnings(file, true), ElementsAre(HasSubstr("all cameras are in one place")));

  file = Ring({0});
  file.rig.cameras[0].intrinsics = Camera::Pinhole(1200, 1200, 800, 450, 800, 450);
  EXPECT_THAT(RigWarnings(file, true),
              ElementsAre("yaw0: the principal point (800, 450) is far from the middle of the "
                          "image: of another size?"));
  file.rig.cameras[0].intrinsics = Camera::Pinhole(1e5, 1e5, 800, 450, 1600, 900);
  EXPECT_THAT(RigWarnings(file, true), ElementsAre("yaw0: a field of view of 0.9 degrees"));
}

TEST(RigCheck, CamerasThatLookInwardsAreTold) {
  RigFile file = Ring({0, 60, 120, 180, 240, 300});
  for (RigCamera& camera : file.rig.cameras) camera.s.head<2>() *= -1;
  EXPECT_THAT(RigWarnings(file, false),
              ElementsAre("the cameras look at each other: positions look inverted"));
}

}  // namespace
}  // namespace rigel
