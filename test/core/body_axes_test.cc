// Which body axis is down and which forward: what the cameras of a rig suggest, and how it is said.
#include "rigel/core/body_axes.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

// A camera whose optical axis and image "down" point along these.
RigCamera Looking(const Vector3d& ahead, const Vector3d& down) {
  RigCamera camera;
  camera.Q << down.cross(ahead), down, ahead;
  return camera;
}

// Level cameras in a body with x forward and z up, at these headings (degrees, to the left).
Rig ZUp(const std::vector<double>& headings) {
  Rig rig;
  for (const double heading : headings) {
    const double a = DegToRad(heading);
    rig.cameras.push_back(Looking({std::cos(a), std::sin(a), 0}, {0, 0, -1}));
  }
  return rig;
}

// The same rig in a body that is turned by B: X_new = B X.
Rig Turned(Rig rig, const Eigen::Matrix3d& B) {
  for (RigCamera& camera : rig.cameras) camera.Q = B * camera.Q;
  return rig;
}

std::string Axes(const Rig& rig, const std::optional<Vector3d>& down = {},
                 const std::optional<Vector3d>& forward = {}) {
  BodyAxes axes;
  std::string error;
  if (!ResolveBodyAxes(rig, down, forward, &axes, &error)) return error;
  EXPECT_NEAR(axes.down.norm(), 1.0, 1e-12);
  EXPECT_NEAR(axes.forward.norm(), 1.0, 1e-12);
  EXPECT_NEAR(axes.down.dot(axes.forward), 0.0, 1e-12);
  EXPECT_NEAR((axes.Right().cross(axes.down) - axes.forward).norm(), 0.0, 1e-12);
  return DirectionText(axes.down) + " " + DirectionText(axes.forward);
}

TEST(BodyAxes, RightIsAcrossDownAndForward) {
  EXPECT_EQ(BodyAxes().Right(), Vector3d::UnitX());  // of a camera: x right, y down, z ahead
}

TEST(BodyAxes, CamerasSuggestThem) {
  // A camera that is the body; stereo.
  Rig camera;
  camera.cameras.resize(2);
  EXPECT_EQ(Axes(camera), "+y +z");
  // All round, the first of them looking back: no mean to speak of.
  EXPECT_EQ(Axes(ZUp({180, 0, 55, -55, 110, -110})), "-z +x");
  EXPECT_EQ(Axes(ZUp({0})), "-z +x");
  // Cameras that agree tell of a body with y forward and z up ...
  EXPECT_EQ(Axes(ZUp({85, 95})), "-z +y");
  // ... and of an IMU that stands on end.
  Rig imu;
  imu.cameras = {Looking({0, 0, 1}, {-1, 0, 0}), Looking({0, 0.02, 0.9998}, {-1, 0, 0})};
  EXPECT_EQ(Axes(imu), "-x +z");
  // All round in a body with no custom: as the first.
  EXPECT_EQ(Axes(Turned(ZUp({180, 0, 90, -90}), RotationY(kPi / 2))), "-x +z");
  // A camera that looks down, and a rig of no cameras.
  Rig down;
  down.cameras = {Looking({0, 0, -1}, {-1, 0, 0})};
  EXPECT_EQ(Axes(down, Vector3d(0, 0, -1)), "-z +x");
  EXPECT_EQ(Axes(Rig()), "+y +z");
  // One of two cameras stands on its head.
  Rig heads;
  heads.cameras = {Looking({0, 0, 1}, {0, 1, 0}), Looking({0, 0, 1}, {0, -1, 0})};
  EXPECT_EQ(Axes(heads), "+y +z");
}

TEST(BodyAxes, TiltedCamerasSuggestTheNearestAxis) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    Random random = Random::Stream(3, seed);
    Rig rig = ZUp({0, 60, 120, 180, 240, 300});
    for (RigCamera& camera : rig.cameras) {
      camera.Q = camera.Q * ExpSO3(0.1 * random.NormalVector3());
    }
    EXPECT_EQ(Axes(rig), "-z +x") << seed;
    EXPECT_LT(CamerasOffDown(rig, {0, 0, -1}), DegToRad(15.0)) << seed;
  }
  // Hand-held glasses.
  const Rig tilted = Turned(ZUp({0}), RotationY(DegToRad(38)));
  EXPECT_EQ(Axes(tilted), "-z +x");
  EXPECT_NEAR(CamerasOffDown(tilted, {0, 0, -1}), DegToRad(38), 1e-12);
  EXPECT_EQ(CamerasOffDown(Rig(), {0, 0, -1}), 0.0);
}

TEST(BodyAxes, WhatIsStatedWins) {
  const Rig rig = ZUp({0, 120, 240});
  EXPECT_EQ(Axes(rig, Vector3d(0, 1, 0)), "+y +z");
  EXPECT_EQ(Axes(rig, {}, Vector3d(0, -1, 0)), "-z -y");
  // Only the line of forward is left out for down.
  EXPECT_EQ(Axes(rig, {}, Vector3d(0, 0, 1)), "+x +z");
  EXPECT_EQ(Axes(rig, Vector3d(1, 0, 0), Vector3d(0, 0, -1)), "+x -z");
  // Forward is taken across down, whatever their lengths.
  EXPECT_EQ(Axes(rig, Vector3d(0, 0, -2), Vector3d(3, 0, 1)), "-z +x");
  EXPECT_THAT(Axes(rig, Vector3d(0, 0, -1), Vector3d(0.1, 0, 1)),
              AllOf(HasSubstr("forward 0.1,0,1 is within 30 degrees"), HasSubstr("down -z")));
  // An oblique down: forward is of the other two axes, across it.
  BodyAxes axes;
  std::string error;
  ASSERT_TRUE(ResolveBodyAxes(rig, Vector3d(0.2, 0, -1), {}, &axes, &error));
  EXPECT_NEAR((axes.forward - Vector3d(1, 0, 0.2).normalized()).norm(), 0.0, 1e-12);
}

TEST(BodyAxes, DirectionsAreReadAndWritten) {
  Vector3d v;
  for (const char* text : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    ASSERT_TRUE(ParseDirection(text, &v)) << text;
    EXPECT_EQ(DirectionText(v), text);
  }
  ASSERT_TRUE(ParseDirection("y", &v));
  EXPECT_EQ(v, Vector3d(0, 1, 0));
  ASSERT_TRUE(ParseDirection("-Z", &v));
  EXPECT_EQ(v, Vector3d(0, 0, -1));
  ASSERT_TRUE(ParseDirection("0, +3,-4", &v));
  EXPECT_LT((v - Vector3d(0, 0.6, -0.8)).norm(), 1e-15);
  EXPECT_EQ(DirectionText(v), "0,0.6,-0.8");
  ASSERT_TRUE(ParseDirection("1e300,0,1e300", &v));
  EXPECT_NEAR(v.norm(), 1.0, 1e-12);
  for (const char* text : {"", "+", "w", "+w", "xy", "--x", "1", "1,2", "1,2,3,4", "0,0,0", "1,,2",
                           "nan,0,1", "inf,0,1", "1,0,x", "+-1,0,0", "1;0;0"}) {
    EXPECT_FALSE(ParseDirection(text, &v)) << text;
  }
}

}  // namespace
}  // namespace rigel
