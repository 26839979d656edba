// Which cameras see the same things, with lenses of all kinds.
#include "rigel/problems/images/view_overlap.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

// z forward and y down; turned to the right, metres to the right.
RigCamera At(double yaw_deg, double x, const Camera& lens) {
  RigCamera camera;
  camera.intrinsics = lens;
  camera.Q = ExpSO3({0, DegToRad(yaw_deg), 0});
  camera.s = {x, 0, 0};
  return camera;
}

// 90 degrees from side to side.
Camera Wide() { return Camera::Pinhole(320, 320, 320, 240, 640, 480); }

// 190 degrees across a circle of 600 pixels.
Camera Fisheye() {
  Camera camera;
  camera.model = CameraModel::kOpencvFisheye;
  const double focal = 300 / DegToRad(95);
  const double parameters[] = {focal, focal, 320, 320, 0, 0, 0, 0};
  std::copy(std::begin(parameters), std::end(parameters), camera.parameters);
  camera.width = camera.height = 640;
  return camera;
}

TEST(ViewOverlap, CamerasBesideEachOtherSeeTheSame) {
  const Rig rig{{At(0, -0.25, Wide()), At(0, 0.25, Wide())}};
  EXPECT_THAT(OverlappingCameras(rig), ElementsAre(Pair(0, 1)));
  // All of what is far.
  EXPECT_GT(ViewShare(rig, 0, 1), 0.99);
}

TEST(ViewOverlap, CamerasBackToBackSeeNothingOfEachOther) {
  EXPECT_THAT(OverlappingCameras({{At(0, 0, Wide()), At(180, 0, Wide())}}), IsEmpty());
  // These fisheyes do, at their borders.
  const Rig fisheyes{{At(0, 0, Fisheye()), At(180, 0, Fisheye())}};
  EXPECT_THAT(OverlappingCameras(fisheyes), ElementsAre(Pair(0, 1)));
  // The circle of 640 pixels reaches to 101 degrees; the corners do not count.
  EXPECT_NEAR(ViewShare(fisheyes, 0, 1), 1 - std::pow(79.0 / 101, 2), 0.03);
}

TEST(ViewOverlap, CornersOfAFisheyeAreBlack) {
  // 170 degrees across the image: in the corners the model goes on to 120.
  Camera lens = Fisheye();
  lens.parameters[0] = lens.parameters[1] = 320 / DegToRad(85);
  EXPECT_THAT(OverlappingCameras({{At(0, 0, lens), At(180, 0, lens)}}), IsEmpty());
  EXPECT_THAT(OverlappingCameras({{At(0, 0, lens), At(90, 0, lens)}}), ElementsAre(Pair(0, 1)));
}

TEST(ViewOverlap, ARingIsNeighbours) {
  Rig rig;
  for (int k = 0; k < 6; ++k) rig.cameras.push_back(At(60 * k, 0, Wide()));
  EXPECT_THAT(OverlappingCameras(rig),
              ElementsAre(Pair(0, 1), Pair(0, 5), Pair(1, 2), Pair(2, 3), Pair(3, 4), Pair(4, 5)));
  // 30 of 90 degrees, on a plane.
  EXPECT_NEAR(ViewShare(rig, 0, 1), (1 - std::tan(DegToRad(15))) / 2, 0.1);
}

TEST(ViewOverlap, WhatIsNearCounts) {
  // Two cameras that look across each other's way: their views meet a few metres ahead only.
  const Camera narrow = Camera::Pinhole(2000, 2000, 320, 240, 640, 480);
  EXPECT_THAT(OverlappingCameras({{At(20, -1, narrow), At(-20, 1, narrow)}}),
              ElementsAre(Pair(0, 1)));
  EXPECT_THAT(OverlappingCameras({{At(-20, -1, narrow), At(20, 1, narrow)}}), IsEmpty());
}

TEST(ViewOverlap, AFisheyeSeesWhatItsNeighboursSee) {
  const Rig rig{{At(0, 0, Wide()), At(90, 0, Fisheye()), At(180, 0, Wide())}};
  EXPECT_THAT(OverlappingCameras(rig), ElementsAre(Pair(0, 1), Pair(1, 2)));
}

}  // namespace
}  // namespace rigel
