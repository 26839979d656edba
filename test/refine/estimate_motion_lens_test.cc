// The whole estimate with raw pixels of lenses that are no pinholes.
#include <gtest/gtest.h>

#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/scene_matches.h"
#include "rigel/problems/scenes/street.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

// Looks ahead, to the right, back and to the left from a body with z forward and y down: in turns a
// fisheye of 95 degrees to its left and right border, and `other`.
Rig CarOf(const Camera& other) {
  const Camera wide = {
      CameraModel::kOpencvFisheye, {418, 418, 640, 483, -0.03, -6e-4, 5e-4, 0}, 1280, 966};
  Rig rig;
  for (int k = 0; k < 4; ++k) {
    RigCamera camera;
    camera.intrinsics = k % 2 == 0 ? wide : other;
    camera.Q = RotationY(0.5 * kPi * k);
    camera.s = camera.Q * Eigen::Vector3d(0.0, 0.0, k % 2 == 0 ? 1.9 : 0.9);
    rig.cameras.push_back(camera);
  }
  return rig;
}

Rig FisheyeCar() {
  return CarOf({CameraModel::kDoubleSphere, {-0.17, 0.59, 320, 320, 640, 480}, 1280, 960});
}

FramePair StreetPair(const Rig& rig, int index) {
  StreetOptions options;
  options.rig = rig;
  options.ground_m = 0.9;
  options.num_matches = 300;
  options.inter_share = 0.2;
  options.outlier_share = 0.15;
  options.noise_px = 0.5;
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeStreetPair(options, index, &pair, &error)) << error;
  return pair;
}

// Wrong parameters leave pixels without rays: that is said, with and without a motion.
TEST(EstimateMotion, ManyPixelsWithoutARayAreSaid) {
  FramePair pair = StreetPair(FisheyeCar(), 0);
  // Beyond its largest image circle a lens has no rays.
  Camera& camera = pair.rig.cameras[0].intrinsics;
  camera.parameters[0] = camera.parameters[1] = 60.0;
  const auto says = [](const std::string& text) {
    return text.find(" matches have a pixel without a ray; are the parameters") !=
           std::string::npos;
  };
  const MotionEstimate e = EstimateMotion({}, pair);
  ASSERT_EQ(e.status, EstimateStatus::kSuccess) << e.message;
  ASSERT_FALSE(e.rig_doubts.empty());
  EXPECT_TRUE(says(e.rig_doubts.back().message)) << e.rig_doubts.back().message;
  for (RigCamera& c : pair.rig.cameras) {
    c.intrinsics.parameters[0] = c.intrinsics.parameters[1] = 1e-3;
  }
  const MotionEstimate none = EstimateMotion({}, pair);
  EXPECT_NE(none.status, EstimateStatus::kSuccess);
  EXPECT_TRUE(says(none.message)) << none.message;
}

TEST(EstimateMotion, FisheyesAndMixedRigsReachTheMotion) {
  for (const bool mixed : {false, true}) {
    const Rig rig =
        mixed ? CarOf(Camera::Pinhole(369.5, 369.5, 640, 483, 1280, 966)) : FisheyeCar();
    for (const ResidualKind residual : {ResidualKind::kSampson, ResidualKind::kAngular}) {
      for (const RefineForm form : {RefineForm::kFull, RefineForm::kBundle}) {
        std::vector<double> rotation, direction;
        for (int index = 0; index < 5; ++index) {
          const FramePair pair = StreetPair(rig, index);
          EstimateOptions options;
          options.refine.form = form;
          options.refine.residual = residual;
          const MotionEstimate estimate = EstimateMotion(options, pair);
          ASSERT_EQ(estimate.status, EstimateStatus::kSuccess) << estimate.message;
          rotation.push_back(RotationErrorDeg(*pair.truth, estimate.pose));
          direction.push_back(DirectionErrorDeg(*pair.truth, estimate.pose));
          int num_beyond_90 = 0;
          for (size_t k = 0; k < pair.matches.size(); ++k) {
            const Match& m = pair.matches[k];
            const Camera& camera = pair.rig.cameras[m.camera1].intrinsics;
            num_beyond_90 +=
                estimate.refine.inliers[k] != 0 && AlongRay(camera, m.pixel1).z() < 0 ? 1 : 0;
          }
          EXPECT_GT(num_beyond_90, 5);
        }
        EXPECT_LT(MedianOf(rotation), 0.05) << mixed << RefineFormName(form);
        EXPECT_LT(MedianOf(direction), 0.5) << mixed << RefineFormName(form);
      }
    }
  }
}

// Beyond 180 degrees. Such a match counts nowhere: the estimate is that without it.
TEST(EstimateMotion, AMatchWithoutARayIsNoMatch) {
  FramePair pair = StreetPair(FisheyeCar(), 3);
  pair.columns = MatchColumns();
  FramePair without = pair;
  without.matches.clear();
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    Match& m = pair.matches[k];
    if (k % 7 == 0 && m.camera2 % 2 == 0) {
      m.pixel2.x() += 1e5;
    } else {
      without.matches.push_back(m);
    }
  }
  ASSERT_LT(without.matches.size(), pair.matches.size());
  const MotionEstimate estimate = EstimateMotion(EstimateOptions(), pair);
  const MotionEstimate expected = EstimateMotion(EstimateOptions(), without);
  ASSERT_EQ(estimate.status, EstimateStatus::kSuccess) << estimate.message;
  EXPECT_EQ(estimate.pose.R, expected.pose.R);
  EXPECT_EQ(estimate.pose.t, expected.pose.t);
  EXPECT_EQ(estimate.num_inliers, expected.num_inliers);
  EXPECT_EQ(estimate.inlier_ratio, expected.inlier_ratio);
  ASSERT_EQ(estimate.refine.inliers.size(), pair.matches.size());
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    if (pair.matches[k].pixel2.x() > 9e4) {
      EXPECT_EQ(estimate.refine.inliers[k], 0);
    }
  }
}

TEST(EstimateMotion, MatchesWithoutRaysAreTooFew) {
  FramePair pair = StreetPair(FisheyeCar(), 4);
  pair.columns = MatchColumns();
  for (Match& m : pair.matches) m.pixel1.x() += 1e5;
  const MotionEstimate estimate = EstimateMotion(EstimateOptions(), pair);
  EXPECT_EQ(estimate.status, EstimateStatus::kTooFewMatches) << estimate.message;
  Pose pose = *pair.truth;
  EXPECT_FALSE(RefinePair(RefineOptions(), pair, &pose).IsSolutionUsable());
}

TEST(EstimateMotion, RandomMatchesOfFisheyesAreNoConsensus) {
  for (const int num_matches : {60, 400}) {
    for (int seed = 0; seed < 10; ++seed) {
      Random random(seed);
      FramePair pair;
      pair.rig = FisheyeCar();
      pair.matches.resize(num_matches);
      for (Match& m : pair.matches) {
        m.camera1 = random.Index(4);
        m.camera2 = random.Index(5) > 0 ? m.camera1 : random.Index(4);
        m.pixel1 = DrawPixel(pair.rig.cameras[m.camera1].intrinsics, &random);
        m.pixel2 = DrawPixel(pair.rig.cameras[m.camera2].intrinsics, &random);
      }
      const MotionEstimate estimate = EstimateMotion(EstimateOptions(), pair);
      EXPECT_FALSE(estimate.HasMotion()) << num_matches << " " << seed << ": " << estimate.message;
    }
  }
}

}  // namespace
}  // namespace rigel
