#include "rigel/core/camera.h"

#include <gtest/gtest.h>

#include "rigel/core/random.h"

namespace rigel {
namespace {

// Different fx and fy, centre off the middle: swapped or shared parameters show.
constexpr PinholeCamera kCamera = {400.0, 500.0, 310.0, 250.0, 640, 480};

TEST(Camera, ProjectsTheOpticalAxisToThePrincipalPoint) {
  EXPECT_EQ(kCamera.Project({0.0, 0.0, 7.0}), Eigen::Vector2d(310.0, 250.0));
}

TEST(Camera, XIsToTheRightAndYIsDown) {
  EXPECT_EQ(kCamera.Project({1.0, 0.0, 2.0}), Eigen::Vector2d(510.0, 250.0));
  EXPECT_EQ(kCamera.Project({0.0, 1.0, 2.0}), Eigen::Vector2d(310.0, 500.0));
}

TEST(Camera, NormalizeInvertsProject) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector2d pixel{random.Uniform(-100.0, 740.0), random.Uniform(-100.0, 580.0)};
    const Eigen::Vector3d u = kCamera.Normalize(pixel);
    EXPECT_EQ(u.z(), 1.0);
    const double depth = random.Uniform(0.1, 50.0);
    EXPECT_LT((kCamera.Project(depth * u) - pixel).norm(), 1e-11);
  }
}

TEST(Camera, InImageExcludesTheFarBorders) {
  EXPECT_TRUE(kCamera.InImage({0.0, 0.0}));
  EXPECT_TRUE(kCamera.InImage({639.9, 479.9}));
  EXPECT_FALSE(kCamera.InImage({640.0, 100.0}));
  EXPECT_FALSE(kCamera.InImage({100.0, 480.0}));
  EXPECT_FALSE(kCamera.InImage({-0.1, 100.0}));
  EXPECT_FALSE(kCamera.InImage({100.0, -0.1}));
}

}  // namespace
}  // namespace rigel
