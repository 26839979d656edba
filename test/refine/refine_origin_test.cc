// Nothing depends on where the body's origin is, how its axes point and how large a pixel is, but
// for rounding; and a rig that stands still is one.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/rig_centre.h"
#include "rigel/refine/between_factor.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

FramePair Pair(double inter_share, int index) {
  SceneOptions scene;
  scene.inter_share = inter_share;
  scene.outlier_share = 0.2;
  return ScenePair(scene, index);
}

// X -> A X + shift of the body frame.
FramePair InOtherFrame(FramePair pair, const Eigen::Matrix3d& A, const Eigen::Vector3d& shift) {
  for (RigCamera& camera : pair.rig.cameras) {
    camera.Q = A * camera.Q;
    camera.s = A * camera.s + shift;
  }
  for (auto* direction :
       {&pair.prior.gravity1, &pair.prior.gravity2, &pair.prior.axis, &pair.prior.normal}) {
    if (*direction) **direction = A * **direction;
  }
  return pair;
}

TEST(Origin, TheRigsMotionIsTheSameInEveryBodyFrame) {
  Eigen::Matrix3d z_up;
  z_up << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  struct Frame {
    Eigen::Vector3d shift;
    Eigen::Matrix3d axes;
    double tolerance;
  };
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  // Standard deviations are 7e-4 rad here. The noise from which weights come is a step function of
  // the errors, and is settled within a percent: the ways to it differ by rounding.
  constexpr double kConverged = 5e-6;
  constexpr double kSigmas = 5e-3;
  const std::vector<Frame> frames = {{{1.7, 0, 0.5}, same, kConverged},
                                     {{0, 0, 0}, z_up, kConverged},
                                     {{100, 50, 3}, z_up, kConverged},
                                     {{4e6, 5e5, 100}, same, kConverged},
                                     {{4e6, 5e5, 100}, z_up, kConverged}};
  for (const double inter_share : {0.0, 0.5}) {
    for (int index = 0; index < 5; ++index) {
      const FramePair pair = Pair(inter_share, index);
      EstimateOptions options;
      const MotionEstimate reference = EstimateMotion(options, pair);
      ASSERT_EQ(reference.status, EstimateStatus::kSuccess);
      const Pose b = MotionOfPoint(reference.pose, RigCentre(pair.rig));
      const Matrix6d information = InformationMatrix(reference.refine, reference.pose);
      for (const Frame& frame : frames) {
        const FramePair other = InOtherFrame(pair, frame.axes, frame.shift);
        const MotionEstimate e = EstimateMotion(options, other);
        ASSERT_EQ(e.status, EstimateStatus::kSuccess);
        const RefineSummary& r = e.refine;
        EXPECT_TRUE(r.rotation_observable);
        EXPECT_EQ(r.RigDirectionKnown(), reference.refine.RigDirectionKnown());
        EXPECT_NEAR(r.length_sigma, reference.refine.length_sigma,
                    kSigmas * reference.refine.length_sigma);
        EXPECT_EQ(e.num_inliers, reference.num_inliers);
        const Pose moved = MotionOfPoint(e.pose, RigCentre(other.rig));
        const Eigen::Matrix3d R = frame.axes.transpose() * moved.R * frame.axes;
        const Eigen::Vector3d direction = frame.axes.transpose() * moved.t.normalized();
        EXPECT_LT((R - b.R).norm(), frame.tolerance) << frame.shift.transpose();
        EXPECT_LT((direction - b.t.normalized()).norm(), 10 * frame.tolerance);
        EXPECT_NEAR(r.rotation_sigma, reference.refine.rotation_sigma,
                    kSigmas * reference.refine.rotation_sigma);
        EXPECT_NEAR(r.rig_direction_sigma, reference.refine.rig_direction_sigma,
                    kSigmas * reference.refine.rig_direction_sigma);
        EXPECT_NEAR(moved.t.norm(), b.t.norm(), kSigmas * r.length_sigma * b.t.norm());
        // The information of an edge is that of the reference in the other frame.
        Matrix6d turn = Matrix6d::Zero();
        turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = frame.axes.transpose();
        const Matrix6d to_body = BodyFromPointJacobian(e.pose.R, r.rig_center);
        const Matrix6d of_rig = to_body.transpose() * InformationMatrix(r, e.pose) * to_body;
        const Matrix6d to_centre =
            BodyFromPointJacobian(reference.pose.R, reference.refine.rig_center);
        const Matrix6d expected =
            turn.transpose() * to_centre.transpose() * information * to_centre * turn;
        const double share = 2e-2;
        EXPECT_LT((of_rig - expected).norm(), share * expected.norm()) << frame.shift.transpose();
      }
    }
  }
}

TEST(Origin, PixelsMayBeOfAnySize) {
  for (int index = 0; index < 5; ++index) {
    FramePair pair = Pair(0.5, index);
    pair.noise_px.reset();
    EstimateOptions options;
    const MotionEstimate reference = EstimateMotion(options, pair);
    FramePair small = pair;
    const double unit = 1.0 / 400.0;  // to fx = 1
    for (RigCamera& camera : small.rig.cameras) {
      Camera& c = camera.intrinsics;
      c = Camera::Pinhole(unit * c.fx(), unit * c.fy(), unit * c.cx(), unit * c.cy(), 2, 2);
    }
    for (Match& m : small.matches) {
      m.pixel1 *= unit;
      m.pixel2 *= unit;
    }
    const MotionEstimate e = EstimateMotion(options, small);
    ASSERT_EQ(e.status, EstimateStatus::kSuccess);
    EXPECT_EQ(e.num_inliers, reference.num_inliers);
    // See above: the same but for a small part of the standard deviation.
    const double angle = RotationError(e.pose.R, reference.pose.R);
    EXPECT_LT(angle, 0.05 * reference.refine.rotation_sigma);
    EXPECT_LT(TranslationDirectionError(reference.pose.t, e.pose.t),
              0.05 * reference.refine.direction_sigma);
    EXPECT_TRUE(e.refine.translation_observable);
    EXPECT_EQ(e.refine.scale_observable, reference.refine.scale_observable);
    EXPECT_NEAR(e.refine.noise_px / unit, reference.refine.noise_px, 1e-3);
    EXPECT_NEAR(e.refine.parallax_limit_px / unit, reference.refine.parallax_limit_px, 5e-3);
  }
}

// No pair of a parked stereo rig is without a rotation, however near to zero t ends.
TEST(Origin, AParkedStereoRigHasARotation) {
  SceneOptions scene;
  scene.num_matches = 200;
  scene.inter_share = 0.5;
  scene.noise_px = 0.4;
  EstimateOptions options;
  for (int index = 0; index < 200; ++index) {
    FramePair pair = ScenePair(scene, index, Pose());
    pair.prior.axis = Eigen::Vector3d::UnitY();
    const MotionEstimate e = EstimateMotion(options, pair);
    ASSERT_EQ(e.status, EstimateStatus::kSuccess) << index << e.message;
    EXPECT_TRUE(e.refine.rotation_observable) << index;
    EXPECT_FALSE(e.refine.RigDirectionKnown()) << index;
    EXPECT_LT(RadToDeg(LogSO3(e.pose.R).norm()), 0.3) << index;
    EXPECT_LT(e.refine.parallax_px, e.refine.parallax_limit_px) << index;
  }
  // And where t is zero but for rounding, whatever the search would have found.
  const FramePair pair = ScenePair(scene, 0, Pose());
  for (const double length : {1e-3, 1e-8, 1e-14}) {
    Pose pose;
    pose.t = {0, 0, length};
    const RefineSummary summary = RefinePair(RefineOptions(), pair, &pose);
    EXPECT_TRUE(summary.rotation_observable) << length;
    EXPECT_FALSE(summary.RigDirectionKnown()) << length;
  }
}

}  // namespace
}  // namespace rigel
