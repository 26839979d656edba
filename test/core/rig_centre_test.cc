#include "rigel/core/rig_centre.h"

#include <gtest/gtest.h>

#include "rigel/core/pixel_unit.h"
#include "rigel/core/random.h"
#include "rigel/test/core/random_vector.h"

namespace rigel {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

TEST(RigCentre, IsTheMeanAlsoFarAway) {
  Rig rig;
  EXPECT_EQ(RigCentre(rig).norm(), 0.0);
  rig.cameras.resize(2);
  rig.cameras[0].s = {4e6, 5e5, 100};
  rig.cameras[1].s = {4e6 + 0.5, 5e5, 101};
  EXPECT_EQ(RigCentre(rig), Eigen::Vector3d(4e6 + 0.25, 5e5, 100.5));
  EXPECT_EQ(RigCentre(WithOrigin(rig, RigCentre(rig))).norm(), 0.0);
}

TEST(RigCentre, MotionAndPerturbationOfAPointAreThoseOfTheBody) {
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    Pose body;
    body.R = ExpSO3(RandomVector3(0.0, 3.0, &random));
    body.t = random.NormalVector3();
    const Eigen::Vector3d point = 10.0 * random.NormalVector3();
    const Pose about = MotionOfPoint(body, point);
    // The point in f2 is where its own frame says.
    EXPECT_LT((body * point - (point + about.t)).norm(), 1e-13);
    EXPECT_LT((MotionOfBody(about, point).t - body.t).norm(), 1e-13);
    Vector6d d;
    d << random.NormalVector3(), random.NormalVector3();
    d *= 1e-6;
    const auto moved = [](const Pose& pose, const Vector6d& by) {
      return Pose{ExpSO3(by.head<3>()) * pose.R, pose.t + by.tail<3>()};
    };
    const Pose expected = MotionOfBody(moved(about, d), point);
    const Pose linear = moved(body, BodyFromPointJacobian(body.R, point) * d);
    EXPECT_LT((expected.t - linear.t).norm(), 1e-9);
    EXPECT_LT((expected.R - linear.R).norm(), 1e-12);
    const Eigen::Matrix<double, 6, 6> identity =
        BodyFromPointJacobian(body.R, point) * BodyFromPointJacobian(body.R, -point);
    EXPECT_LT((identity - Eigen::Matrix<double, 6, 6>::Identity()).norm(), 1e-13);
  }
}

TEST(RigCentre, BodyLengthKeepsTheDirectionOfThePoint) {
  // A quarter turn with the point 1.7 m ahead.
  const Eigen::Vector3d point(0, 0, 1.7);
  Pose body{ExpSO3({0, 0.3, 0}), {0.1, 0, -1.0}};
  const Eigen::Vector3d b = MotionOfPoint(body, point).t.normalized();
  const Pose longer = WithBodyLength(body, point, 3.0);
  EXPECT_NEAR(longer.t.norm(), 3.0, 1e-12);
  EXPECT_LT((MotionOfPoint(longer, point).t.normalized() - b).norm(), 1e-12);
  // The lever alone moves the origin by half a metre: |b| gets the length.
  body.t = {2, 0, 0};
  EXPECT_NEAR(MotionOfPoint(WithBodyLength(body, point, 1e-3), point).t.norm(), 1e-3, 1e-12);
  EXPECT_EQ(WithBodyLength(Pose(), point, 1.0).t.norm(), 0.0);
}

TEST(PixelUnit, IsAShareOfShortFocalLengths) {
  Rig rig;
  rig.cameras.resize(2);
  for (RigCamera& camera : rig.cameras)
    camera.intrinsics = Camera::Pinhole(700, 710, 0, 0, 640, 480);
  EXPECT_EQ(PixelUnit(rig), 1.0);
  EXPECT_EQ(DefaultThresholdPx(rig), 1.5);
  EXPECT_EQ(ThresholdPx(kAutoThresholdPx, rig), 1.5);
  EXPECT_EQ(ThresholdPx(0.7, rig), 0.7);
  rig.cameras[1].intrinsics = Camera::Pinhole(1, 1, 0, 0, 2, 1);
  EXPECT_DOUBLE_EQ(DefaultThresholdPx(rig), 1.0 / 300.0);
  rig.cameras[0].intrinsics.parameters[0] = 1e-300;
  EXPECT_EQ(DefaultThresholdPx(rig), kMinThresholdPx);
}

}  // namespace
}  // namespace rigel
