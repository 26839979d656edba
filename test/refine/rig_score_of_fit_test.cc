// The test of a rig: its score against numeric differentiation, what it says of a right rig and of
// a wrong one, and sums over runs.
#include "rigel/refine/rig_score_of_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "rigel/core/epipolar.h"
#include "rigel/refine/rig_doubts.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

FramePair PairOfTwoKinds(int index, double inter_share = 0.4) {
  SceneOptions scene;
  scene.inter_share = inter_share;
  return ScenePair(scene, index);
}

// Turns camera 1 in its own frame.
FramePair Turned(FramePair pair, const Eigen::Vector3d& turn_deg) {
  Eigen::Matrix3d& Q = pair.rig.cameras[1].Q;
  Q = Q * ExpSO3(turn_deg * DegToRad(1.0));
  return pair;
}

RigScore ScoreOf(const FramePair& pair) {
  Pose pose = *pair.truth;
  RefineOptions options;
  options.score_rig = true;
  return RefinePair(options, pair, &pose).rig_score;
}

std::vector<RigScore> ScoresOfScenes(int count, const Eigen::Vector3d& turn_deg) {
  std::vector<RigScore> scores;
  for (int k = 0; k < count; ++k) scores.push_back(ScoreOf(Turned(PairOfTwoKinds(k), turn_deg)));
  return scores;
}

int CountBelow(const std::vector<double>& p, double limit) {
  return static_cast<int>(std::count_if(p.begin(), p.end(), [&](double x) { return x < limit; }));
}

// Normal equations of the motion (six) and of the turns of camera 1, from numeric derivatives of
// the residuals.
TEST(RigScore, AgreesWithNumericDifferentiation) {
  constexpr double kSigma = 0.5;
  for (int index = 0; index < 5; ++index) {
    const FramePair pair = PairOfTwoKinds(index);
    const GroupedMatches matches(pair.rig, pair.matches);
    const int n = matches.size();
    const auto residuals = [&](const Eigen::Matrix<double, 9, 1>& step) {
      const Pose pose = Perturbed(*pair.truth, step.head<6>());
      const Rig rig = Turned(pair, RadToDeg(1.0) * step.tail<3>()).rig;
      Eigen::VectorXd r(n);
      for (int k = 0; k < n; ++k) r(k) = SampsonError(pose, rig, matches.matches()[k]) / kSigma;
      return r;
    };
    Eigen::MatrixXd J(n, 9);
    for (int c = 0; c < 9; ++c) {
      J.col(c) = CentralDifference(
          [&](double h) { return residuals(h * Eigen::Matrix<double, 9, 1>::Unit(c)); }, 1e-4);
    }
    const Eigen::MatrixXd H = J.transpose() * J;
    const Eigen::VectorXd g = J.transpose() * residuals(Eigen::Matrix<double, 9, 1>::Zero());
    const Eigen::MatrixXd by_motion =
        H.topLeftCorner(6, 6).ldlt().solve(Eigen::MatrixXd(H.topRightCorner(6, 3)));
    const Eigen::VectorXd gradient = g.tail(3) - by_motion.transpose() * g.head(6);
    const Eigen::MatrixXd information =
        H.bottomRightCorner(3, 3) - H.bottomLeftCorner(3, 6) * by_motion;

    FittedInliers fit;
    fit.factors.assign(n, 1.0);
    NoiseModel noise;
    noise.sigma_of.assign(matches.groups().size(), kSigma);
    const std::vector<double> psi2_of(matches.groups().size(), 1.0);
    const RigScore score = RigScoreOfFit(fit, matches, noise, psi2_of, *pair.truth);
    ASSERT_EQ(score.num_pairs, 1);
    EXPECT_LT((score.gradient - gradient).norm(), 1e-6 * gradient.norm());
    EXPECT_LT((score.information - information).norm(), 1e-6 * information.norm());
    // The residuals are those of noise of this size.
    const double ratio = information.ldlt().solve(score.variance).trace() / 3.0;
    EXPECT_GT(ratio, 0.7);
    EXPECT_LT(ratio, 1.4);
  }
}

TEST(RigScore, OneCameraHasNothingToTest) {
  SceneOptions scene;
  scene.num_cameras = 1;
  const RigScore score = ScoreOf(ScenePair(scene, 0));
  EXPECT_TRUE(score.empty());
  EXPECT_EQ(TestRig(score).degrees_of_freedom, 0);
  EXPECT_TRUE(ScoreOfRun({}).empty());
}

// Matches within the cameras do not say how the cameras are turned against each other.
TEST(RigScore, WhatIsNotDeterminedIsNotTested) {
  const RigTest test = TestRig(ScoreOf(PairOfTwoKinds(0, 0.0)));
  EXPECT_LT(test.degrees_of_freedom, 3);
  for (const CameraTurn& camera : test.cameras) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(camera.turn[axis].has_value(), camera.sigma[axis].has_value());
    }
  }
}

TEST(RigScore, OfARightRigTheProbabilitiesAreUniform) {
  constexpr int kPairs = 300;
  std::vector<double> p;
  for (const RigScore& score : ScoresOfScenes(kPairs, Eigen::Vector3d::Zero())) {
    p.push_back(TestRig(score).p);
  }
  EXPECT_LE(CountBelow(p, 0.01), 9);
  EXPECT_GE(CountBelow(p, 0.1), 12);
  EXPECT_LE(CountBelow(p, 0.1), 48);
  EXPECT_GE(CountBelow(p, 0.5), 120);
  EXPECT_LE(CountBelow(p, 0.5), 180);
}

TEST(RigScore, ATurnOfACameraIsFound) {
  const Eigen::Vector3d turn_deg(0.1, 0.0, -0.2);
  const std::vector<RigScore> scores = ScoresOfScenes(20, turn_deg);
  for (const RigScore& score : scores) EXPECT_LT(TestRig(score).p, 0.01);
  const RigTest run = TestRig(ScoreOfRun(scores));
  EXPECT_EQ(run.num_pairs, 20);
  EXPECT_LT(run.p, 1e-9);
  ASSERT_EQ(run.cameras.size(), 1u);
  for (int axis = 0; axis < 3; ++axis) {
    ASSERT_TRUE(run.cameras[0].turn[axis].has_value());
    const double sigma = *run.cameras[0].sigma[axis];
    EXPECT_LT(RadToDeg(sigma), 0.03);
    // The files state the turned rig: the camera is turned the other way against it.
    EXPECT_LT(std::abs(*run.cameras[0].turn[axis] + DegToRad(turn_deg[axis])), 4.0 * sigma) << axis;
  }
}

TEST(RigScore, AStatedErrorOfTheCalibrationExplainsATurn) {
  FramePair pair = Turned(PairOfTwoKinds(0), {0.2, 0.0, 0.0});
  EXPECT_LT(TestRig(ScoreOf(pair)).p_with_calibration, 1e-4);
  for (RigCamera& camera : pair.rig.cameras) camera.rotation_sigma = DegToRad(0.2);
  const RigTest test = TestRig(ScoreOf(pair));
  EXPECT_LT(test.p, 1e-4);
  EXPECT_GT(test.p_with_calibration, 0.01);
}

// Scores of a run, drawn with `variance` times what they state, for turns (radians).
std::vector<RigScore> DrawnScores(int count, const Eigen::VectorXd& turns, double variance,
                                  Random* random) {
  const long size = turns.size();
  const auto normal = [&](long rows, long columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random->Normal(); }));
  };
  std::vector<RigScore> scores(count);
  for (RigScore& score : scores) {
    const Eigen::MatrixXd A = 1e3 * normal(size, 4 * size);
    score.num_pairs = 1;
    score.information = A * A.transpose();
    score.variance = score.information;
    score.gradient = std::sqrt(variance) * A * normal(4 * size, 1) - score.information * turns;
    score.by_calibration.resize(size, 0);
  }
  return scores;
}

TEST(RigScore, ScoresOfOtherRigsAreLeftOut) {
  Random random(1);
  std::vector<RigScore> scores = DrawnScores(3, Eigen::VectorXd::Zero(3), 1.0, &random);
  scores.push_back(DrawnScores(1, Eigen::VectorXd::Zero(6), 1.0, &random)[0]);
  scores.emplace_back();
  EXPECT_EQ(ScoreOfRun(scores).num_pairs, 3);
}

// Also if the scores scatter by more than they state.
TEST(RigScore, OfRunsWithARightRigTheProbabilitiesAreUniform) {
  constexpr int kRuns = 400, kPairs = 50;
  Random random(1);
  for (const int size : {3, 15}) {
    for (const double variance : {1.0, 4.0}) {
      std::vector<double> p;
      for (int run = 0; run < kRuns; ++run) {
        p.push_back(
            TestRig(ScoreOfRun(DrawnScores(kPairs, Eigen::VectorXd::Zero(size), variance, &random)))
                .p);
      }
      EXPECT_LE(CountBelow(p, 0.001), 4) << size << " " << variance;
      EXPECT_LE(CountBelow(p, 0.1), 70) << size << " " << variance;
      EXPECT_GE(CountBelow(p, 0.5), 120) << size << " " << variance;
    }
  }
}

TEST(RigScore, PairsThatAreFarOffHardlyCount) {
  Random random(1);
  const Eigen::Vector3d turns(0.001, 0.0, 0.0);
  std::vector<RigScore> scores = DrawnScores(50, turns, 1.0, &random);
  for (const int k : {3, 20, 21}) scores[k].gradient *= 100.0;
  const RigTest test = TestRig(ScoreOfRun(scores));
  ASSERT_EQ(test.cameras.size(), 1u);
  EXPECT_LT(test.p, 1e-3);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(*test.cameras[0].turn[axis], turns[axis], 4.0 * *test.cameras[0].sigma[axis]);
  }
}

}  // namespace
}  // namespace rigel
