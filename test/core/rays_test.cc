#include "rigel/core/rays.h"

#include <gtest/gtest.h>

#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/test/core/pinhole.h"

namespace rigel {
namespace {

using Eigen::Vector3d;

Ray RandomRay(Random* random) {
  Ray ray;
  ray.x = random->UnitVector3();
  ray.s = random->NormalVector3();
  return ray;
}

TEST(Rays, MomentIsTheSameAtEveryPointOfTheRay) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Ray ray = RandomRay(&random);
    const Vector3d point = ray.s + random.Uniform(-20.0, 20.0) * ray.x;
    EXPECT_LT((point.cross(ray.x) - ray.Moment()).norm(), 1e-13);
  }
}

TEST(Rays, FootIsThePointOfTheRayNearestToTheOrigin) {
  Random random(2);
  for (int k = 0; k < 100; ++k) {
    const Ray ray = RandomRay(&random);
    const Vector3d foot = ray.Foot();
    EXPECT_LT((foot - ray.s).cross(ray.x).norm(), 1e-14) << "on the ray";
    EXPECT_LT(std::abs(foot.dot(ray.x)), 1e-14) << "perpendicular";
    // d = l - s.x, what cheirality has to test.
    const double l = random.Uniform(-20.0, 20.0);
    const double d = l - ray.s.dot(ray.x);
    EXPECT_LT((foot + l * ray.x - (ray.s + d * ray.x)).norm(), 1e-13);
  }
}

TEST(Rays, MakeRayPairPassesThroughThePointInBothFrames) {
  for (int seed = 0; seed < 100; ++seed) {
    Random random = Random::Stream(3, seed);
    Rig rig;
    for (int k = 0; k < 3; ++k) {
      RigCamera camera;
      camera.intrinsics = Camera::Pinhole(300.0 + 100.0 * k, 450.0, 320.0, 200.0 + k, 640, 480);
      camera.Q = ExpSO3(random.NormalVector3());
      camera.s = random.NormalVector3();
      rig.cameras.push_back(camera);
    }
    // Points of the two cameras' frames: the match's first ray is camera 2's, the second camera
    // 0's.
    const Vector3d point1 = {random.Normal(), random.Normal(), random.Uniform(1.0, 20.0)};
    const Vector3d point2 = {random.Normal(), random.Normal(), random.Uniform(1.0, 20.0)};
    Match match;
    match.camera1 = 2;
    match.camera2 = 0;
    match.pixel1 = ProjectPinhole(rig.cameras[2].intrinsics, point1);
    match.pixel2 = ProjectPinhole(rig.cameras[0].intrinsics, point2);
    const RayPair rays = MakeRayPair(rig, match);
    const Vector3d body1 = rig.cameras[2].Q * point1 + rig.cameras[2].s;
    const Vector3d body2 = rig.cameras[0].Q * point2 + rig.cameras[0].s;
    EXPECT_NEAR(rays.ray1.x.norm(), 1.0, 1e-15);
    EXPECT_NEAR(rays.ray2.x.norm(), 1.0, 1e-15);
    // In front, at the point's distance: not only parallel.
    EXPECT_LT((rays.ray1.s + point1.norm() * rays.ray1.x - body1).norm(), 1e-12);
    EXPECT_LT((rays.ray2.s + point2.norm() * rays.ray2.x - body2).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace rigel
