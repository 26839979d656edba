// What Refine() says of the length and the direction of t, and what holds them.
#include "rigel/refine/refine.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/parallel.h"
#include "rigel/core/rig_centre.h"
#include "rigel/problems/scenes/scene_matches.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

TEST(RefineScale, ScaleIsObservableWhereMatchesBetweenCamerasSayIt) {
  int half_inter = 0, pure_intra = 0;
  constexpr int kPairs = 200;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions scene;
    scene.num_matches = 100;
    scene.inter_share = 0.5;
    FramePair pair = ScenePair(scene, index);
    Random random = Random::Stream(6, index);
    Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
    RefineSummary summary = RefinePair(RefineOptions(), pair, &pose);
    half_inter += summary.scale_observable && summary.IsSolutionUsable() &&
                  ScaleError(pair.truth->t, pose.t) < 0.05;

    scene.inter_share = 0.0;
    scene.rotation_deg = 0.0;
    pair = ScenePair(scene, index);
    pose = StartNear(*pair.truth, 0.05, 0.02, &random);
    summary = RefinePair(RefineOptions(), pair, &pose);
    EXPECT_TRUE(summary.IsSolutionUsable()) << index << ": " << summary.message;
    pure_intra += summary.scale_observable;
  }
  RecordProperty("half_inter", half_inter);
  RecordProperty("pure_intra", pure_intra);
  EXPECT_GE(half_inter, 198);
  EXPECT_LE(pure_intra, 2);
}

// Of 200 whole estimates: those that call the direction of t observable.
int CountObservable(double inter_share, const Pose* truth) {
  constexpr int kPairs = 200;
  std::vector<char> observable(kPairs);
  ParallelFor(kPairs, 2, [&](int index) {
    SceneOptions scene;
    scene.num_matches = 100;
    scene.inter_share = inter_share;
    scene.motion = MotionPattern::kRandom;
    FramePair pair;
    std::string error;
    const bool made = truth != nullptr ? MakeScenePair(scene, index, *truth, &pair, &error)
                                       : MakeScenePair(scene, index, &pair, &error);
    EstimateOptions options;
    options.solver = "4pt";
    observable[index] = made && EstimateMotion(options, pair).refine.translation_observable;
  });
  return static_cast<int>(std::count(observable.begin(), observable.end(), 1));
}

TEST(RefineScale, DirectionIsObservableOnlyWhereThereIsTranslation) {
  Pose turn;
  turn.R = ExpSO3(DegToRad(1.0) * Eigen::Vector3d::UnitY());
  for (const double inter_share : {0.0, 0.5}) {
    const int still = CountObservable(inter_share, &turn);
    const int moving = CountObservable(inter_share, nullptr);
    std::printf("[ measured ] inter %.1f: observable %d of 200 still, %d of 200 moving\n",
                inter_share, still, moving);
    EXPECT_LE(still, 4) << inter_share;
    EXPECT_GE(moving, 198) << inter_share;
  }
}

// Matches between cameras alone: at zero translation they leave t along the line of the cameras
// undetermined, so that the motion found may be long and is yet consistent with none.
TEST(RefineScale, DirectionIsNotObservableAtRestFromInterCameraMatchesAlone) {
  Pose turn;
  turn.R = ExpSO3(DegToRad(1.0) * Eigen::Vector3d::UnitY());
  const int still = CountObservable(1.0, &turn);
  const int moving = CountObservable(1.0, nullptr);
  std::printf("[ measured ] inter 1.0: observable %d of 200 still, %d of 200 moving\n", still,
              moving);
  EXPECT_LE(still, 4);
  EXPECT_GE(moving, 198);
}

TEST(RefineScale, AHeldLengthStays) {
  for (const RefineForm form :
       {RefineForm::kFull, RefineForm::kPrior, RefineForm::kDepths, RefineForm::kPriorDepths}) {
    for (const double inter_share : {0.0, 0.5}) {
      SCOPED_TRACE(RefineFormName(form));
      SceneOptions scene;
      scene.inter_share = inter_share;
      const FramePair pair = ScenePair(scene, 4);
      Random random(4);
      Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
      const double length = pose.t.norm();
      RefineOptions options;
      options.form = form;
      options.prior_kind = PriorKind::kAxis;
      options.hold_distance = true;
      options.threshold_px = 3.0;
      const RefineSummary summary = RefinePair(options, pair, &pose);
      ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
      EXPECT_NEAR(pose.t.norm(), length, 1e-9);
      ASSERT_TRUE(summary.covariance.has_value());
      EXPECT_LT((summary.covariance->block<3, 3>(3, 3) * pose.t).norm(), 1e-10);
    }
  }
}

TEST(RefineScale, HoldDistanceHoldsTheDistanceOfThePrior) {
  SceneOptions scene;
  FramePair pair = ScenePair(scene, 4);
  Random random(4);
  RefineOptions options;
  options.hold_distance = true;
  for (const double distance : {1.0, 2.5}) {
    pair.prior.distance = distance;
    Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
    ASSERT_TRUE(RefinePair(options, pair, &pose).IsSolutionUsable());
    EXPECT_NEAR(pose.t.norm(), distance, 1e-12);
  }
  // No direction can be held at a distance of zero: |t| stays as at the start.
  pair.prior.distance = 0.0;
  Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
  const double length = pose.t.norm();
  ASSERT_TRUE(RefinePair(options, pair, &pose).IsSolutionUsable());
  EXPECT_NEAR(pose.t.norm(), length, 1e-12);
}

// Wheel odometry of two percent on matches that say nothing of |t|: it enters, and the length is
// then known to two percent. That the matches say it is another thing.
TEST(RefineScale, ADistanceWithASigmaIsAMeasurementOfTheLength) {
  SceneOptions scene;
  double error2 = 0.0;
  constexpr int kPairs = 50;
  for (int index = 0; index < kPairs; ++index) {
    FramePair pair = ScenePair(scene, index);
    Random random = Random::Stream(9, index);
    const double sigma = 0.02;
    pair.prior.distance = 1.0 + sigma * random.Normal();
    pair.prior.distance_sigma = sigma;
    Pose pose = StartNear(*pair.truth, 0.05, 0.1, &random);
    const RefineSummary summary = RefinePair(RefineOptions(), pair, &pose);
    ASSERT_TRUE(summary.IsSolutionUsable());
    EXPECT_NEAR(summary.length_sigma, sigma, 0.1 * sigma);
    EXPECT_FALSE(summary.length_held);
    EXPECT_FALSE(summary.scale_observable) << index;
    EXPECT_GT(summary.relative_scale_sigma, 2 * sigma);
    error2 += std::pow(ScaleError(pair.truth->t, pose.t) / sigma, 2);
  }
  EXPECT_NEAR(std::sqrt(error2 / kPairs), 1.0, 0.3);
}

// Whatever the matches say, and from any start: not beyond 100 times the largest length that is
// known. Straight ahead they say nothing of |t|, and where it ends at the limit its direction is
// not observable.
TEST(RefineScale, NoLengthIsBeyondAHundredTimesTheLargestKnown) {
  int far = 0, solved = 0;
  for (const double typical : {0.1, 1.0, 5.0}) {
    for (int index = 0; index < 100; ++index) {
      SceneOptions scene;
      scene.num_matches = 100;
      scene.rotation_deg = index % 2 == 0 ? 0.0 : 2.0;
      scene.motion = MotionPattern::kRandom;
      const FramePair pair = ScenePair(scene, index);
      double largest = typical;
      for (const RigCamera& a : pair.rig.cameras) {
        for (const RigCamera& b : pair.rig.cameras) largest = std::max(largest, (a.s - b.s).norm());
      }
      Random random = Random::Stream(10, index);
      RefineOptions options;
      options.typical_length = typical;
      for (const double factor : {0.2, 1.0, 1e9}) {
        Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
        pose.t *= factor;
        const RefineSummary summary = RefinePair(options, pair, &pose);
        if (!summary.IsSolutionUsable()) continue;
        ++solved;
        // Of the rig's centre. That of the body differs by the turn of the centre's arm.
        const double length = MotionOfPoint(pose, summary.rig_center).t.norm();
        EXPECT_LE(length, 100.0 * largest * (1 + 1e-9)) << index;
        far += length > 30.0 * typical;
        if (length > 99.5 * largest) {
          EXPECT_FALSE(summary.translation_observable) << index;
        }
        EXPECT_FALSE(summary.scale_observable && length > 3.0) << index;
      }
    }
  }
  std::printf("[ measured ] %d of 900 refined, |t| beyond 30 times the typical length in %d\n",
              solved, far);
  EXPECT_GE(solved, 880);
  EXPECT_LE(far, 9);
}

// The weak prior keeps what the matches do not say near the typical length, with the standard
// deviation of its logarithm, 1.
TEST(RefineScale, TheTypicalLengthHoldsWhatNothingSays) {
  SceneOptions scene;
  scene.rotation_deg = 0.0;
  for (const double typical : {0.2, 1.0, 5.0}) {
    double sum = 0.0;
    constexpr int kPairs = 30;
    for (int index = 0; index < kPairs; ++index) {
      const FramePair pair = ScenePair(scene, index);
      Random random = Random::Stream(11, index);
      Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
      RefineOptions options;
      options.typical_length = typical;
      const RefineSummary summary = RefinePair(options, pair, &pose);
      ASSERT_TRUE(summary.covariance.has_value());
      sum += std::log(MotionOfPoint(pose, summary.rig_center).t.norm() / typical) / kPairs;
      EXPECT_GT(summary.length_sigma, 0.5);
      // That of the prior, and at most four times as much where the noise makes the curvature small
      // (kMinShare).
      EXPECT_LT(summary.length_sigma, 4.01);
      EXPECT_FALSE(summary.scale_observable);
    }
    std::printf("[ measured ] typical length %.1f: mean of log(|b| / length) %.3f\n", typical, sum);
    EXPECT_NEAR(sum, 0.0, 0.3) << typical;
  }
}

// It is sought among the axes of the body: a car's motion is along one of them. One that is far
// from all is found, or it is said that few matches fit.
TEST(RefineScale, AStartWithoutTranslationFindsADirectionAlongAnAxis) {
  for (const MotionPattern motion :
       {MotionPattern::kForward, MotionPattern::kSideways, MotionPattern::kRandom}) {
    for (const double inter_share : {0.0, 0.5}) {
      int right = 0, refused = 0;
      constexpr int kPairs = 40;
      for (int index = 0; index < kPairs; ++index) {
        SceneOptions scene;
        scene.inter_share = inter_share;
        scene.motion = motion;
        const FramePair pair = ScenePair(scene, index);
        Random random = Random::Stream(13, index);
        Pose pose = StartNear(*pair.truth, 0.05, 0.02, &random);
        pose.t.setZero();
        const RefineSummary summary = RefinePair(RefineOptions(), pair, &pose);
        refused += !summary.IsSolutionUsable();
        right += summary.IsSolutionUsable() && DirectionErrorDeg(*pair.truth, pose) < 5.0;
        if (!summary.IsSolutionUsable()) {
          EXPECT_EQ(summary.termination, Termination::kDegenerate) << summary.message;
          EXPECT_EQ(pose.t.norm(), 0.0);
        }
      }
      std::printf("[ measured ] motion %d, inter %.1f: found in %d of %d, refused %d\n",
                  static_cast<int>(motion), inter_share, right, kPairs, refused);
      if (motion != MotionPattern::kRandom) {
        EXPECT_GE(right, kPairs - 1);
      }
    }
  }
}

// One camera 1.7 m ahead of the rear axle, a quarter circle of 4.8 m radius in 18 steps of 5
// degrees. The matches hardly say |t|; without it they say the motion of the camera, not that of
// the axle.
class QuarterCircle {
 public:
  static constexpr int kSteps = 18;
  static constexpr double kRadius = 4.8;

  QuarterCircle() {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(1260, 1260, 800, 450, 1600, 900);
    camera.Q << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    camera.s = {1.7, 0, 1.5};
    rig_.cameras = {camera};
    const double turn = DegToRad(5.0);
    // X_2 = R X_1 + t of a left turn about the point (0, kRadius, 0).
    truth_.R = ExpSO3(Eigen::Vector3d(0, 0, -turn));
    const Eigen::Vector3d centre(0, kRadius, 0);
    truth_.t = centre - truth_.R * centre;
  }

  FramePair Pair(int step) const {
    FramePair pair;
    pair.rig = rig_;
    pair.truth = truth_;
    pair.prior.axis = Eigen::Vector3d::UnitZ();
    Random random = Random::Stream(17, step);
    const RigCamera& camera = rig_.cameras[0];
    while (pair.matches.size() < 120) {
      const double z = random.Uniform(0, 8);
      const double y = random.Uniform(-20, 20);
      const double x = random.Uniform(6, 40);
      const Eigen::Vector3d X(x, y, z);
      Match m;
      if (!Sees(camera, X, &m.pixel1) || !Sees(camera, truth_ * X, &m.pixel2)) continue;
      for (Pixel* pixel : {&m.pixel1, &m.pixel2}) {
        const double v = pixel->y() + 0.5 * random.Normal();
        const double u = pixel->x() + 0.5 * random.Normal();
        *pixel = Pixel(u, v);
      }
      pair.matches.push_back(m);
    }
    return pair;
  }
  const Pose& truth() const { return truth_; }

 private:
  Rig rig_;
  Pose truth_;
};

TEST(RefineScale, ADriveInTurnsEndsWhereItsDistancesSay) {
  const QuarterCircle drive;
  for (const bool hold : {false, true}) {
    Pose end, truth;
    for (int step = 0; step < QuarterCircle::kSteps; ++step) {
      FramePair pair = drive.Pair(step);
      pair.prior.distance = drive.truth().t.norm();
      pair.prior.distance_sigma = 0.005;
      EstimateOptions options;
      options.refine.hold_distance = hold;
      const MotionEstimate e = EstimateMotion(options, pair);
      ASSERT_EQ(e.status, EstimateStatus::kSuccess);
      EXPECT_EQ(e.refine.length_held, hold);
      EXPECT_TRUE(e.refine.translation_observable) << step;
      end = e.pose * end;
      truth = drive.truth() * truth;
    }
    const Eigen::Vector3d at = end.Inverse().t;
    const double off = (at - truth.Inverse().t).norm() / (0.5 * kPi * QuarterCircle::kRadius);
    std::printf("[ measured ] distance %s: end (%.3f, %.3f, %.3f), off by %.2f percent\n",
                hold ? "held" : "measured", at.x(), at.y(), at.z(), 100 * off);
    EXPECT_LT(off, 0.005);
  }
}

TEST(RefineScale, WithoutADistanceATurnSaysTheMotionOfTheCameraOnly) {
  const QuarterCircle drive;
  double squares = 0.0;
  for (int step = 0; step < QuarterCircle::kSteps; ++step) {
    const FramePair pair = drive.Pair(step);
    const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
    ASSERT_EQ(e.status, EstimateStatus::kSuccess);
    // |t| may be a factor of e off, which turns the body's t by this much.
    EXPECT_GT(RadToDeg(e.refine.direction_sigma), 5.0);
    EXPECT_LT(TranslationDirectionError(drive.truth().t, e.pose.t), 3 * e.refine.direction_sigma);
    EXPECT_EQ(e.refine.translation_observable, RadToDeg(e.refine.direction_sigma) <= 10.0);
    EXPECT_TRUE(e.refine.rig_translation_observable);
    const Pose truth = MotionOfPoint(drive.truth(), e.refine.rig_center);
    squares += std::pow(TranslationDirectionError(truth.t, e.refine.rig_direction) /
                            e.refine.rig_direction_sigma,
                        2) /
               QuarterCircle::kSteps;
    const Eigen::Vector3d b = MotionOfPoint(e.pose, e.refine.rig_center).t.normalized();
    EXPECT_LT((b - e.refine.rig_direction).norm(), 1e-9);
  }
  std::printf("[ measured ] direction of the camera: error over sigma %.2f\n", std::sqrt(squares));
  // 18 steps of two degrees of freedom: one in a hundred below or above.
  EXPECT_GT(std::sqrt(squares), 0.7);
  EXPECT_LT(std::sqrt(squares), 1.3);
}

// Where nothing lets the length come down: the refinement is stopped at once.
TEST(RefineScale, ALengthThatStaysIsCutAtTheLimit) {
  const FramePair pair = ScenePair(SceneOptions(), 1);
  RefineOptions options;
  const std::atomic<bool> cancel{true};
  options.cancel = &cancel;
  Pose pose = *pair.truth;
  pose.t *= 1e6;
  const RefineSummary summary = RefinePair(options, pair, &pose);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  // The baseline of the rig is about 1 m, as the typical length is.
  EXPECT_LT(MotionOfPoint(pose, summary.rig_center).t.norm(), 120.0);
  EXPECT_FALSE(summary.scale_observable);
}

}  // namespace
}  // namespace rigel
