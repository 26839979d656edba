// The whole estimate: its statuses, its determinism, and the sign of t.
#include "rigel/refine/estimate_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/parallel.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/scenes/prior_source.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;

EstimateOptions With(const std::string& solver) {
  EstimateOptions options;
  options.solver = solver;
  return options;
}

bool SameBits(const Pose& a, const Pose& b) {
  return std::memcmp(a.R.data(), b.R.data(), sizeof(double) * 9) == 0 &&
         std::memcmp(a.t.data(), b.t.data(), sizeof(double) * 3) == 0;
}

TEST(EstimateMotion, IsBornPessimistic) {
  const MotionEstimate estimate;
  EXPECT_EQ(estimate.status, EstimateStatus::kNotRun);
  EXPECT_FALSE(estimate.HasMotion());
  for (const EstimateStatus status :
       {EstimateStatus::kNotRun, EstimateStatus::kSuccess, EstimateStatus::kInvalidInput,
        EstimateStatus::kTooFewMatches, EstimateStatus::kNoSolution, EstimateStatus::kNotRefined,
        EstimateStatus::kNoConsensus}) {
    EXPECT_STRNE(EstimateStatusName(status), "unknown");
  }
  EXPECT_STREQ(EstimateStatusName(EstimateStatus::kSuccess), "ok");
}

TEST(EstimateMotion, EverySolverOfTheCatalogueRefinesToTheSameAccuracy) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    // Takes the motion for the arc of a car, which the scene's is not.
    if (std::string(solver.name) == "2pt-ackermann") continue;
    std::vector<double> rotation, direction;
    for (int index = 0; index < 10; ++index) {
      SceneOptions scene;
      scene.inter_share = 0.5;
      scene.outlier_share = 0.2;
      scene.motion = MotionPattern::kPlanar;
      const FramePair pair = ScenePair(scene, index);
      const MotionEstimate estimate = EstimateMotion(With(solver.name), pair);
      ASSERT_EQ(estimate.status, EstimateStatus::kSuccess)
          << solver.name << ": " << estimate.message;
      EXPECT_TRUE(estimate.HasMotion());
      EXPECT_GE(estimate.num_inliers, 140);
      EXPECT_NEAR(estimate.inlier_ratio, estimate.num_inliers / 200.0, 1e-12);
      EXPECT_GT(estimate.iterations, 0);
      EXPECT_GT(estimate.hypotheses, 0);
      EXPECT_TRUE(estimate.refine.IsSolutionUsable());
      rotation.push_back(RotationErrorDeg(*pair.truth, estimate.pose));
      direction.push_back(DirectionErrorDeg(*pair.truth, estimate.pose));
    }
    EXPECT_LT(MedianOf(rotation), 0.08) << solver.name;
    EXPECT_LT(MedianOf(direction), 0.6) << solver.name;
  }
}

// A car's turn, X_new = B X: of a body with x forward, y left and z up.
TEST(EstimateMotion, AckermannMotionGoesWhereTheFrontIs) {
  Eigen::Matrix3d B;
  B << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  std::vector<double> rig, stated, wrong;
  for (int index = 0; index < 10; ++index) {
    Pose truth;
    truth.R = RotationY(DegToRad(10.0));
    truth.t = -(RotationY(DegToRad(5.0)) * Eigen::Vector3d::UnitZ());
    SceneOptions scene;
    scene.inter_share = 0.5;
    scene.noise_px = 0.1;
    FramePair pair = ScenePair(scene, index, truth);
    for (RigCamera& camera : pair.rig.cameras) {
      camera.Q = B * camera.Q;
      camera.s = B * camera.s;
    }
    truth.R = B * truth.R * B.transpose();
    truth.t = B * truth.t;
    pair.prior = MotionPrior();
    pair.prior.normal = Eigen::Vector3d::UnitZ();
    const auto raw_error = [&] {
      const MotionEstimate estimate = EstimateMotion(With("2pt-ackermann"), pair);
      EXPECT_TRUE(estimate.HasMotion()) << estimate.message;
      return DirectionErrorDeg(truth, estimate.raw);
    };
    rig.push_back(raw_error());
    pair.prior.forward = Eigen::Vector3d::UnitX();
    stated.push_back(raw_error());
    // As if the car drove sideways.
    pair.prior.forward = Eigen::Vector3d::UnitY();
    wrong.push_back(raw_error());
  }
  EXPECT_LT(MedianOf(rig), 0.2);
  EXPECT_EQ(stated, rig);
  EXPECT_GT(MedianOf(wrong), 1.0);
}

TEST(EstimateMotion, WithoutRefinementTheMotionIsRansacs) {
  SceneOptions scene;
  scene.outlier_share = 0.2;
  const FramePair pair = ScenePair(scene, 1);
  EstimateOptions options = With("4pt");
  const MotionEstimate refined = EstimateMotion(options, pair);
  options.refine_motion = false;
  const MotionEstimate raw = EstimateMotion(options, pair);
  EXPECT_EQ(raw.status, EstimateStatus::kSuccess);
  EXPECT_EQ(raw.refine.termination, Termination::kNotRun);
  EXPECT_TRUE(SameBits(raw.raw, refined.raw));
  EXPECT_EQ(raw.iterations, refined.iterations);
  EXPECT_FALSE(SameBits(raw.pose, refined.pose));
  // `raw` is before local optimization, so the pose differs from it.
  EXPECT_FALSE(SameBits(raw.pose, raw.raw));
  options.ransac.local_optimization = false;
  const MotionEstimate minimal = EstimateMotion(options, pair);
  EXPECT_TRUE(SameBits(minimal.pose, minimal.raw));
}

TEST(EstimateMotion, RefusesWrongOptionsWithAMessage) {
  const FramePair pair = ScenePair(SceneOptions(), 1);
  const auto expect_invalid = [&](const EstimateOptions& options, const FramePair& input,
                                  const char* part) {
    const MotionEstimate estimate = EstimateMotion(options, input);
    EXPECT_EQ(estimate.status, EstimateStatus::kInvalidInput) << part;
    EXPECT_FALSE(estimate.HasMotion());
    EXPECT_THAT(estimate.message, HasSubstr(part));
  };
  expect_invalid(With("5pt"), pair, "'5pt'");
  expect_invalid(With("5pt"), pair, "4pt-axis");  // names those that there are
  expect_invalid(With(""), pair, "solver");
  EstimateOptions options;
  options.ransac.threshold_px = -1;
  expect_invalid(options, pair, "threshold_px");
  options = EstimateOptions();
  options.ransac.confidence = 1.0;
  expect_invalid(options, pair, "confidence");
  options = EstimateOptions();
  options.refine.loss_scale_sigmas = -1;
  expect_invalid(options, pair, "loss_scale_sigmas");
  // What is not run is not looked at.
  options.refine_motion = false;
  EXPECT_EQ(EstimateMotion(options, pair).status, EstimateStatus::kSuccess);
}

TEST(EstimateMotion, RefusesAPairThatItCannotUse) {
  const FramePair good = ScenePair(SceneOptions(), 1);
  const auto status_of = [](const char* solver, const FramePair& pair, const char* part) {
    const MotionEstimate estimate = EstimateMotion(With(solver), pair);
    EXPECT_THAT(estimate.message, HasSubstr(part));
    EXPECT_FALSE(estimate.HasMotion());
    return estimate.status;
  };
  FramePair pair = good;
  pair.prior = MotionPrior();
  EXPECT_EQ(status_of("4pt", pair, "gravity1"), EstimateStatus::kInvalidInput);
  EXPECT_EQ(status_of("4pt-axis", pair, "axis"), EstimateStatus::kInvalidInput);
  EXPECT_EQ(status_of("3pt", pair, "normal"), EstimateStatus::kInvalidInput);
  EXPECT_EQ(status_of("4pt", pair, "4pt"), EstimateStatus::kInvalidInput);
  pair.prior.axis = Eigen::Vector3d(0, 2, 0);
  EXPECT_EQ(status_of("4pt-axis", pair, "unit"), EstimateStatus::kInvalidInput);
  pair.prior.axis = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(status_of("4pt-axis", pair, "unit"), EstimateStatus::kInvalidInput);

  pair = good;
  pair.matches[5].camera1 = 2;
  EXPECT_EQ(status_of("4pt", pair, "camera"), EstimateStatus::kInvalidInput);
  pair.matches[5].camera1 = -1;
  EXPECT_EQ(status_of("4pt", pair, "camera"), EstimateStatus::kInvalidInput);
  pair = good;
  pair.matches[5].pixel2.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status_of("4pt", pair, "5"), EstimateStatus::kInvalidInput);
  pair = good;
  pair.rig.cameras[0].Q *= 2.0;
  EXPECT_EQ(status_of("4pt", pair, "camera 0"), EstimateStatus::kInvalidInput);

  pair = good;
  pair.matches.resize(3);
  pair.columns = MatchColumns();
  EXPECT_EQ(status_of("4pt", pair, "3 matches"), EstimateStatus::kTooFewMatches);
  pair.matches.clear();
  EXPECT_EQ(status_of("4pt", pair, "0 matches"), EstimateStatus::kTooFewMatches);
  FramePair empty;
  empty.prior = good.prior;
  EXPECT_EQ(status_of("4pt-axis", empty, "0 matches"), EstimateStatus::kTooFewMatches);
}

TEST(EstimateMotion, OneMatchManyTimesOverHasNoSolution) {
  for (const bool still : {false, true}) {
    FramePair pair = ScenePair(SceneOptions(), 1);
    if (still) pair.matches[0].pixel2 = pair.matches[0].pixel1;
    pair.matches.assign(20, pair.matches[0]);
    pair.columns = MatchColumns();
    EstimateOptions options = With("4pt");
    options.ransac.max_iterations = 500;
    const MotionEstimate estimate = EstimateMotion(options, pair);
    EXPECT_NE(estimate.status, EstimateStatus::kSuccess) << still;
    EXPECT_TRUE(estimate.pose.AllFinite());
    EXPECT_LE(estimate.iterations, 500);
    EXPECT_FALSE(estimate.message.empty());
  }
}

// Four matches agree on a motion of four whatever they are.
TEST(EstimateMotion, WhatOneSampleAgreesOnIsNoConsensus) {
  SceneOptions scene;
  scene.noise_px = 0.0;
  scene.num_matches = 4;
  scene.inter_share = 1.0;
  int seen = 0;
  for (int index = 0; index < 20; ++index) {
    const FramePair pair = ScenePair(scene, index);
    for (const bool refined : {true, false}) {
      EstimateOptions options = With("4pt");
      options.refine_motion = refined;
      const MotionEstimate estimate = EstimateMotion(options, pair);
      if (estimate.status == EstimateStatus::kNoSolution) continue;
      ++seen;
      EXPECT_EQ(estimate.status, EstimateStatus::kNoConsensus) << estimate.message;
      EXPECT_FALSE(estimate.HasMotion());
      EXPECT_THAT(estimate.message, HasSubstr("4 of 4 matches"));
      EXPECT_TRUE(estimate.pose.AllFinite());
      EXPECT_EQ(estimate.num_inliers, 4);
    }
  }
  EXPECT_GE(seen, 30);
}

// Standing still there is no reference match: RANSAC's motion is handed out, and said to be so.
TEST(EstimateMotion, AMotionThatCannotBeRefinedIsRansacs) {
  SceneOptions scene;
  scene.noise_px = 1e-5;

  FramePair pair;
  std::string error;
  ASSERT_TRUE(MakeScenePair(scene, 0, Pose(), &pair, &error)) << error;
  EstimateOptions options = With("4pt-axis");
  options.refine.form = RefineForm::kDepths;
  const MotionEstimate estimate = EstimateMotion(options, pair);
  EXPECT_EQ(estimate.status, EstimateStatus::kNotRefined) << estimate.message;
  EXPECT_TRUE(estimate.HasMotion());
  EXPECT_THAT(estimate.message, HasSubstr("not refined"));
  EXPECT_TRUE(estimate.pose.AllFinite());
}

TEST(EstimateMotion, TheSeedFixesTheResult) {
  SceneOptions scene;
  scene.outlier_share = 0.3;
  int raw_differs = 0;
  for (int index = 0; index < 5; ++index) {
    const FramePair pair = ScenePair(scene, index);
    EstimateOptions options = With("4pt");
    const MotionEstimate a = EstimateMotion(options, pair);
    const MotionEstimate b = EstimateMotion(options, pair);
    EXPECT_TRUE(SameBits(a.pose, b.pose) && SameBits(a.raw, b.raw));
    EXPECT_EQ(a.iterations, b.iterations);
    EXPECT_EQ(a.hypotheses, b.hypotheses);
    options.ransac.seed = 2;
    const MotionEstimate c = EstimateMotion(options, pair);
    raw_differs += !SameBits(a.raw, c.raw);
    // Another sample, the same minimum.
    EXPECT_LT(RadToDeg(RotationError(a.pose.R, c.pose.R)), 0.1);
  }
  EXPECT_GE(raw_differs, 3);
}

// It saves time only: of the hypotheses that would win hardly one is lost, also where every other
// match is an outlier.
TEST(EstimateMotion, TheBailOutTestKeepsTheWinners) {
  struct Setting {
    double outlier_share;
    bool alternate;
  };
  for (const Setting& setting : {Setting{0.3, false}, Setting{0.7, false}, Setting{0.5, true}}) {
    int same = 0;
    constexpr int kPairs = 100;
    for (int index = 0; index < kPairs; ++index) {
      SceneOptions scene;
      scene.num_matches = 512;
      scene.outlier_share = setting.outlier_share;
      FramePair pair = ScenePair(scene, index);
      if (setting.alternate) {
        const GroupedMatches matches(pair.rig, pair.matches);
        std::vector<double> errors;
        matches.SquaredErrors(*pair.truth, &errors);
        std::vector<Match> alternating;
        for (const MatchGroup& group : matches.groups()) {
          std::vector<Match> kinds[2];
          for (int k = group.begin; k < group.begin + group.size; ++k) {
            kinds[errors[k] < 4.0].push_back(matches.matches()[k]);
          }
          for (size_t k = 0; k < std::max(kinds[0].size(), kinds[1].size()); ++k) {
            for (const auto& kind : kinds) {
              if (k < kind.size()) alternating.push_back(kind[k]);
            }
          }
        }
        pair.matches = alternating;
      }
      EstimateOptions options = With("4pt-approx");
      options.refine_motion = false;
      const MotionEstimate with = EstimateMotion(options, pair);
      options.ransac.bail_out = false;
      same += SameBits(with.raw, EstimateMotion(options, pair).raw);
    }
    std::printf("[ measured ] the same winner in %d of %d\n", same, kPairs);
    EXPECT_GE(same, 98);
  }
}

// Half of the matches have four times the noise of the others, at one of the times or at both. With
// the columns that say so the motion is as good as their information allows, and its sigma true.
TEST(EstimateMotion, SigmasOfPixelsAreWeights) {
  constexpr int kPairs = 200;
  double squares[2] = {0.0, 0.0}, nees = 0.0, expected = 0.0;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions scene;
    scene.inter_share = 0.5;
    scene.num_matches = 300;
    scene.noise_px = 0.0;
    FramePair pair = ScenePair(scene, index);
    Random random = Random::Stream(8, index);
    MatchColumns columns;
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      Match& m = pair.matches[k];
      columns.sigma1.push_back(k % 4 == 0 ? 1.2 : 0.3);
      columns.sigma2.push_back(k % 4 < 2 ? 1.2 : 0.3);
      m.pixel1 += columns.sigma1[k] * random.NormalVector3().head<2>();
      m.pixel2 += columns.sigma2[k] * random.NormalVector3().head<2>();
    }
    for (const bool stated : {false, true}) {
      pair.columns = stated ? columns : MatchColumns();
      const MotionEstimate e = EstimateMotion(EstimateOptions(), pair);
      ASSERT_EQ(e.status, EstimateStatus::kSuccess);
      const double angle = RotationError(pair.truth->R, e.pose.R);
      squares[stated ? 1 : 0] += angle * angle / kPairs;
      if (!stated) continue;
      ASSERT_TRUE(e.refine.covariance.has_value());
      const Vector6d d = Difference(*pair.truth, e.pose);
      nees += d.dot(e.refine.covariance->ldlt().solve(d)) / 6.0 / kPairs;
      expected += e.refine.rotation_sigma * e.refine.rotation_sigma / kPairs;
    }
  }
  const double gain = std::sqrt(squares[0] / squares[1]);
  const double ratio = std::sqrt(squares[1] / expected);
  std::printf(
      "[ measured ] rotation error without the sigmas %.2f times as large, NEES %.2f, "
      "error over stated sigma %.2f\n",
      gain, nees, ratio);
  EXPECT_GT(gain, 1.1);
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, 1.25);
  EXPECT_NEAR(ratio, 1.0, 0.12);
}

// Two-view bundle adjustment projects points with the cameras as they are mounted.
TEST(EstimateMotion, BundleRefusesCamerasThatFireAtOtherTimes) {
  FramePair pair = ScenePair(SceneOptions(), 0);
  pair.time1 = 0.0;
  pair.time2 = 0.1;
  EstimateOptions options;
  options.refine.form = RefineForm::kBundle;
  EXPECT_EQ(EstimateMotion(options, pair).status, EstimateStatus::kSuccess);
  pair.rig.cameras[1].time_offset = 0.01;
  const MotionEstimate e = EstimateMotion(options, pair);
  EXPECT_EQ(e.status, EstimateStatus::kNotRefined);
  EXPECT_THAT(e.message, HasSubstr("fire at other times"));
  pair.time2.reset();
  EXPECT_EQ(EstimateMotion(EstimateOptions(), pair).status, EstimateStatus::kInvalidInput);
}

TEST(EstimateMotion, ConcurrentCallsGiveTheSameBits) {
  SceneOptions scene;
  scene.inter_share = 0.3;
  scene.outlier_share = 0.2;
  constexpr int kPairs = 4;
  std::vector<FramePair> pairs;
  for (int index = 0; index < kPairs; ++index) pairs.push_back(ScenePair(scene, index));
  for (const RefineForm form : {RefineForm::kFull, RefineForm::kDepths, RefineForm::kBundle}) {
    SCOPED_TRACE(RefineFormName(form));
    EstimateOptions options = With("4pt-axis");
    options.refine.form = form;
    std::vector<MotionEstimate> expected;
    for (const FramePair& pair : pairs) expected.push_back(EstimateMotion(options, pair));
    constexpr int kCalls = 100;
    std::vector<MotionEstimate> estimates(kCalls);
    ParallelFor(kCalls, 8,
                [&](int k) { estimates[k] = EstimateMotion(options, pairs[k % kPairs]); });
    for (int k = 0; k < kCalls; ++k) {
      const MotionEstimate& serial = expected[k % kPairs];
      EXPECT_TRUE(SameBits(estimates[k].pose, serial.pose)) << k;
      EXPECT_TRUE(SameBits(estimates[k].raw, serial.raw)) << k;
      EXPECT_EQ(estimates[k].refine.final_cost, serial.refine.final_cost) << k;
      EXPECT_EQ(estimates[k].refine.inliers, serial.refine.inliers) << k;
    }
  }
}

// Epipolar errors do not see the sign; a prior off by a degree makes hypotheses poor, too.
TEST(EstimateMotion, TheSignOfTIsRightUnderAPoorPrior) {
  constexpr int kPairs = 200;
  std::vector<char> wrong(kPairs), wrong_raw(kPairs), failed(kPairs);
  ParallelFor(kPairs, 2, [&](int index) {
    SceneOptions scene;
    scene.motion = MotionPattern::kRandom;
    FramePair pair;
    std::string error;
    PriorSourceOptions prior;
    prior.source = PriorSource::kTruth;
    prior.noise = DegToRad(1.0);
    if (!MakeScenePair(scene, index, &pair, &error) ||
        !ApplyPriorSource(prior, index, &pair, &error)) {
      failed[index] = 1;
      return;
    }
    const MotionEstimate estimate = EstimateMotion(With("4pt-approx"), pair);
    failed[index] = estimate.status != EstimateStatus::kSuccess;
    wrong[index] = pair.truth->t.dot(estimate.pose.t) <= 0;
    wrong_raw[index] = pair.truth->t.dot(estimate.raw.t) <= 0;
  });
  int count = 0, count_raw = 0;
  for (int index = 0; index < kPairs; ++index) {
    EXPECT_FALSE(failed[index]) << index;
    count += wrong[index];
    count_raw += wrong_raw[index];
  }
  std::printf("[ measured ] wrong signs of 200: refined %d, raw %d\n", count, count_raw);
  EXPECT_LE(count, 2);
}

// What the seed leaves in the refined motion, in units of its stated standard deviations.
TEST(EstimateMotion, AnotherSeedHardlyChangesTheRefinedMotion) {
  int near = 0;
  constexpr int kPairs = 200;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions scene;
    scene.num_matches = 626;
    scene.outlier_share = 0.3;
    scene.motion = MotionPattern::kRandom;
    const FramePair pair = ScenePair(scene, index);
    EstimateOptions options;
    options.solver = "4pt-approx";
    options.refine.noise_px = scene.noise_px;
    const MotionEstimate one = EstimateMotion(options, pair);
    options.ransac.seed = 2;
    const MotionEstimate other = EstimateMotion(options, pair);
    ASSERT_EQ(one.status, EstimateStatus::kSuccess);
    ASSERT_EQ(other.status, EstimateStatus::kSuccess);
    near += RotationError(one.pose.R, other.pose.R) < 0.5 * one.refine.rotation_sigma &&
            TranslationDirectionError(one.pose.t, other.pose.t) < 0.5 * one.refine.direction_sigma;
  }
  std::printf("[ measured ] within half a standard deviation: %d of %d\n", near, kPairs);
  EXPECT_GE(near, kPairs * 9 / 10);
}

}  // namespace
}  // namespace rigel
