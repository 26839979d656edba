// The second motion of a plane: that it fits as the first does, and that an estimate tells it.
#include "rigel/refine/search/plane_twin.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

// One camera that looks at points X with n'X = 1, turns by a degree and moves by a metre.
FramePair PlanePair(double noise_px, int index) {
  Random random = Random::Stream(41, index);
  FramePair pair;
  RigCamera camera;
  camera.intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
  pair.rig.cameras = {camera};
  const Pose truth = {ExpSO3(DegToRad(1.0) * random.UnitVector3()), random.UnitVector3()};
  const double distance = random.Uniform(8.0, 15.0);
  const double tilt_x = random.Uniform(-0.5, 0.5), tilt_y = random.Uniform(-0.5, 0.5);
  const Eigen::Vector3d n = Eigen::Vector3d(tilt_x, tilt_y, 1.0) / distance;
  const auto noisy = [&](const Pixel& p) {
    const double u = noise_px * random.Normal(), v = noise_px * random.Normal();
    return Pixel(p.x() + u, p.y() + v);
  };
  while (pair.matches.size() < 150) {
    const double x = random.Uniform(-0.7, 0.7), y = random.Uniform(-0.5, 0.5);
    const Eigen::Vector3d ray(x, y, 1.0);
    const Eigen::Vector3d X = ray / n.dot(ray), Y = truth * X;
    if (!(X.z() > 0) || !(Y.z() > 1.0)) continue;
    Match m;
    m.pixel1 = noisy(ProjectPinhole(camera.intrinsics, X));
    m.pixel2 = noisy(ProjectPinhole(camera.intrinsics, Y));
    pair.matches.push_back(m);
  }
  pair.truth = truth;
  return pair;
}

double LargestError(const FramePair& pair, const Pose& pose) {
  double largest = 0.0;
  for (const Match& m : pair.matches) {
    largest = std::max(largest, std::abs(SampsonError(pose, pair.rig, m)));
  }
  return largest;
}

TEST(PlaneTwin, FitsExactPointsOfAPlaneAsTheTruthDoes) {
  for (int index = 0; index < 50; ++index) {
    const FramePair pair = PlanePair(0.0, index);
    const GroupedMatches matches(pair.rig, pair.matches);
    const std::optional<Pose> twin = PlaneTwin(matches, *pair.truth, 0.1);
    ASSERT_TRUE(twin.has_value()) << index;
    EXPECT_TRUE(IsRotation(twin->R));
    EXPECT_LT(LargestError(pair, *twin), 1e-6) << index;
    EXPECT_GT(RotationErrorDeg(*pair.truth, *twin), 0.1) << index;
    // The twin of the twin is the truth, up to the length.
    const std::optional<Pose> back = PlaneTwin(matches, *twin, 0.1);
    ASSERT_TRUE(back.has_value()) << index;
    EXPECT_LT(RotationErrorDeg(*pair.truth, *back), 1e-4) << index;
    EXPECT_LT(DirectionErrorDeg(*pair.truth, *back), 1e-3) << index;
  }
}

TEST(PlaneTwin, PointsInABoxHaveNone) {
  for (int index = 0; index < 20; ++index) {
    const FramePair pair = ScenePair(SceneOptions(), index);
    EXPECT_FALSE(PlaneTwin(GroupedMatches(pair.rig, pair.matches), *pair.truth, 0.5).has_value());
  }
  Rig rig;
  rig.cameras.resize(1);
  EXPECT_FALSE(PlaneTwin(GroupedMatches(rig, {}), Pose(), 0.5).has_value());
}

// What an estimate claims to know of a plane that one camera sees is true.
TEST(PlaneTwin, AnEstimateTellsTheOtherMotion) {
  constexpr int kPairs = 200;
  int wrong = 0, told = 0, claimed = 0;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = PlanePair(0.5, index);
    const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
    ASSERT_EQ(e.status, EstimateStatus::kSuccess);
    const double angle = RotationErrorDeg(*pair.truth, e.pose);
    claimed += e.refine.rotation_observable;
    wrong += e.refine.rotation_observable && angle > 1.0;
    if (!e.refine.other_motion.has_value()) continue;
    EXPECT_FALSE(e.refine.translation_observable && e.refine.rotation_observable);
    if (!e.refine.translation_observable) {
      EXPECT_THAT(e.refine.ObservabilityReport(), testing::HasSubstr("another motion fits"));
    }
    told += std::min(angle, RotationErrorDeg(*pair.truth, *e.refine.other_motion)) < 1.0;
  }
  std::printf("[ measured ] of %d: rotation claimed %d, wrong %d; one of two motions right %d\n",
              kPairs, claimed, wrong, told);
  EXPECT_LE(wrong, 2);
  EXPECT_GE(claimed + told, 190);
  EXPECT_GE(told, 40);
}

// The scene has one motion, and nothing else is told.
TEST(PlaneTwin, TheSceneHasNoOtherMotion) {
  SceneOptions scene;
  scene.inter_share = 0.5;
  scene.outlier_share = 0.2;
  for (int index = 0; index < 50; ++index) {
    const MotionEstimate e = EstimateMotion(EstimateOptions(), ScenePair(scene, index));
    EXPECT_FALSE(e.refine.other_motion.has_value()) << index;
    EXPECT_TRUE(e.refine.scale_observable) << index;
  }
}

// Points on a line in space, which all cameras see on a line, or in a cube of 0.1 m.
TEST(Observability, PointsOnALineOrInOnePlaceDetermineNothing) {
  for (int index = 0; index < 40; ++index) {
    FramePair pair = ScenePair(SceneOptions(), index);
    Random random = Random::Stream(42, index);
    pair.matches.clear();
    pair.columns = {};
    for (RigCamera& camera : pair.rig.cameras) camera.Q.setIdentity();
    pair.truth = Pose{ExpSO3(DegToRad(1.0) * random.UnitVector3()), random.UnitVector3()};
    const Eigen::Vector3d middle(0.5, 0.3, 10.0), along = random.UnitVector3();
    while (pair.matches.size() < 200) {
      const Eigen::Vector3d offset = index % 2 == 0
                                         ? Eigen::Vector3d(random.Uniform(-15.0, 15.0) * along)
                                         : Eigen::Vector3d(0.03 * random.NormalVector3());
      const Eigen::Vector3d X = middle + offset, Y = *pair.truth * X;
      Match m;
      m.camera1 = m.camera2 = static_cast<int>(pair.matches.size() % 2);
      const RigCamera& camera = pair.rig.cameras[m.camera1];
      const Eigen::Vector3d P = camera.Q.transpose() * (X - camera.s);
      const Eigen::Vector3d Q = camera.Q.transpose() * (Y - camera.s);
      if (!(P.z() > 1.0) || !(Q.z() > 1.0)) continue;
      m.pixel1 = ProjectPinhole(camera.intrinsics, P) + 0.5 * random.NormalVector3().head<2>();
      m.pixel2 = ProjectPinhole(camera.intrinsics, Q) + 0.5 * random.NormalVector3().head<2>();
      pair.matches.push_back(m);
    }
    const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
    EXPECT_FALSE(e.refine.rotation_observable) << index;
    EXPECT_FALSE(e.refine.RigDirectionKnown()) << index;
    EXPECT_FALSE(e.refine.covariance_valid) << index;
    const double sigma_deg = RadToDeg(e.refine.rotation_sigma);
    if (!e.refine.other_motion && sigma_deg <= kRotationObservableDeg) {
      EXPECT_THAT(e.refine.ObservabilityReport(), testing::HasSubstr("on a line or in one place"));
    }
  }
}

}  // namespace
}  // namespace rigel
