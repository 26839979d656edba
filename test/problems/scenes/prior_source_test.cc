// Where a prior comes from, and the errors that experiments add to it.
#include "rigel/problems/scenes/prior_source.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

FramePair Applied(const PriorSourceOptions& options, int index, FramePair pair) {
  std::string error;
  EXPECT_TRUE(ApplyPriorSource(options, index, &pair, &error)) << error;
  return pair;
}

FramePair PairWithTruth() {
  FramePair pair;
  Pose truth;
  truth.R = ExpSO3(DegToRad(20.0) * Eigen::Vector3d(1, 2, -1).normalized());
  truth.t = {0.5, -0.2, 2.0};
  pair.truth = truth;
  return pair;
}

TEST(PriorSource, Names) {
  PriorSource source = PriorSource::kFile;
  EXPECT_TRUE(ParsePriorSource("body", &source));
  EXPECT_EQ(source, PriorSource::kBody);
  EXPECT_TRUE(ParsePriorSource("truth", &source));
  EXPECT_EQ(source, PriorSource::kTruth);
  EXPECT_TRUE(ParsePriorSource("file", &source));
  EXPECT_EQ(source, PriorSource::kFile);
  EXPECT_FALSE(ParsePriorSource("imu", &source));
  PriorNoiseAxis axis = PriorNoiseAxis::kPitch;
  EXPECT_TRUE(ParsePriorNoiseAxis("roll", &axis));
  EXPECT_EQ(axis, PriorNoiseAxis::kRoll);
  EXPECT_TRUE(ParsePriorNoiseAxis("random", &axis));
  EXPECT_EQ(axis, PriorNoiseAxis::kRandom);
  EXPECT_TRUE(ParsePriorNoiseAxis("pitch", &axis));
  EXPECT_EQ(axis, PriorNoiseAxis::kPitch);
  EXPECT_FALSE(ParsePriorNoiseAxis("yaw", &axis));
}

TEST(PriorSource, FileLeavesThePriorAsItIs) {
  FramePair pair = PairWithTruth();
  pair.prior.axis = Eigen::Vector3d::UnitZ();
  pair.prior.axis_sigma = 0.02;
  const MotionPrior prior = Applied(PriorSourceOptions(), 0, pair).prior;
  EXPECT_EQ(*prior.axis, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(*prior.axis_sigma, 0.02);
  EXPECT_FALSE(prior.gravity1 || prior.gravity2 || prior.normal);
}

// A rig of a body with x forward, y left, z up: cameras ahead and at the back.
Rig ZUpRig() {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].Q << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  rig.cameras[1].Q << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  return rig;
}

TEST(PriorSource, BodyIsDownAsTheRigSuggestsIt) {
  PriorSourceOptions options;
  options.source = PriorSource::kBody;
  FramePair pair;
  pair.rig = ZUpRig();
  std::string error;
  AppliedAxes applied;
  ASSERT_TRUE(ApplyPriorSource(options, 0, &pair, &error, &applied)) << error;
  const Eigen::Vector3d down(0, 0, -1);
  EXPECT_TRUE(*pair.prior.gravity1 == down && *pair.prior.gravity2 == down &&
              *pair.prior.axis == down && *pair.prior.normal == down);
  EXPECT_EQ(pair.prior.forward, Eigen::Vector3d(1, 0, 0));
  EXPECT_TRUE(applied.down_suggested && applied.forward_suggested);
  EXPECT_EQ(applied.axes.down, down);
  EXPECT_EQ(applied.axes.forward, Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(applied.cameras_off_down, 0.0, 1e-12);
}

TEST(PriorSource, WhatIsStatedOfTheBodyWinsAndIsNotSuggested) {
  PriorSourceOptions options;
  options.source = PriorSource::kBody;
  options.down = Eigen::Vector3d(0, 1, 0);
  options.forward = Eigen::Vector3d(0, 0, 1);
  FramePair pair;
  pair.rig = ZUpRig();
  pair.prior.forward = Eigen::Vector3d(-1, 0, 0);
  std::string error;
  AppliedAxes applied;
  FramePair flags = pair;
  ASSERT_TRUE(ApplyPriorSource(options, 0, &flags, &error, &applied)) << error;
  EXPECT_EQ(*flags.prior.normal, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(*flags.prior.forward, Eigen::Vector3d(0, 0, 1));
  EXPECT_FALSE(applied.down_suggested || applied.forward_suggested);
  // The file's line, over what the rig suggests.
  FramePair file = pair;
  ASSERT_TRUE(ApplyPriorSource(PriorSourceOptions(), 0, &file, &error, &applied)) << error;
  EXPECT_EQ(*file.prior.forward, Eigen::Vector3d(-1, 0, 0));
  EXPECT_FALSE(file.prior.normal || applied.down_suggested || applied.forward_suggested);
  // Both along one line.
  pair.name = "a.matches";
  options.forward.reset();
  options.down = Eigen::Vector3d(1, 0, 0);
  EXPECT_FALSE(ApplyPriorSource(options, 0, &pair, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("a.matches: forward -x is within 30 degrees"));
  EXPECT_THAT(error, ::testing::HasSubstr("--forward"));
}

TEST(PriorSource, NoiseTurnsAboutTheBodysRightAndForward) {
  const auto turned = [](PriorNoiseAxis axis) {
    PriorSourceOptions options;
    options.source = PriorSource::kBody;
    options.noise = 0.1;
    options.noise_axis = axis;
    FramePair pair;
    pair.rig = ZUpRig();
    return *Applied(options, 0, pair).prior.gravity2;
  };
  // Right is -y of this body, forward x: down, -z, moves along x, along y.
  const Eigen::Vector3d pitch = turned(PriorNoiseAxis::kPitch);
  EXPECT_NEAR(std::abs(pitch.x()), std::sin(0.1), 1e-12);
  EXPECT_NEAR(pitch.y(), 0.0, 1e-12);
  const Eigen::Vector3d roll = turned(PriorNoiseAxis::kRoll);
  EXPECT_NEAR(std::abs(roll.y()), std::sin(0.1), 1e-12);
  EXPECT_NEAR(roll.x(), 0.0, 1e-12);
}

TEST(PriorSource, BodyOfNoCamerasIsBodyYAndNeedsNoTruth) {
  PriorSourceOptions options;
  options.source = PriorSource::kBody;
  FramePair pair;
  pair.prior.gravity1 = Eigen::Vector3d::UnitX();
  const MotionPrior prior = Applied(options, 0, pair).prior;
  const Eigen::Vector3d y(0, 1, 0);
  EXPECT_TRUE(*prior.gravity1 == y && *prior.gravity2 == y && *prior.axis == y &&
              *prior.normal == y);
  EXPECT_FALSE(prior.gravity_sigma || prior.axis_sigma || prior.normal_sigma);
}

TEST(PriorSource, TruthIsExact) {
  PriorSourceOptions options;
  options.source = PriorSource::kTruth;
  FramePair pair = PairWithTruth();
  MotionPrior prior = Applied(options, 0, pair).prior;
  const Pose& truth = *pair.truth;
  EXPECT_EQ(*prior.gravity1, Eigen::Vector3d(0, 1, 0));
  EXPECT_LT((truth.R * *prior.gravity1 - *prior.gravity2).norm(), 1e-12);
  EXPECT_LT(AngleDeg(*prior.axis, Eigen::Vector3d(1, 2, -1)), 1e-6);
  EXPECT_NEAR(prior.normal->norm(), 1.0, 1e-12);
  EXPECT_NEAR(prior.normal->dot(truth.t), 0.0, 1e-12);
  // The nearest of those to the axis: in the plane of axis and t.
  EXPECT_NEAR(prior.normal->dot(prior.axis->cross(truth.t)), 0.0, 1e-12);
  EXPECT_GT(prior.normal->dot(*prior.axis), 0.0);

  // A file's own gravity1 stays.
  pair.prior.gravity1 = Eigen::Vector3d(0, 0.6, 0.8);
  prior = Applied(options, 0, pair).prior;
  EXPECT_EQ(*prior.gravity1, Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_LT((truth.R * *prior.gravity1 - *prior.gravity2).norm(), 1e-12);

  // No rotation: body Y. No translation: the axis.
  pair.truth->R = ExpSO3(Eigen::Vector3d(0, 0, 1e-7));
  EXPECT_EQ(*Applied(options, 0, pair).prior.axis, Eigen::Vector3d(0, 1, 0));
  pair = PairWithTruth();
  pair.truth->t.setZero();
  prior = Applied(options, 0, pair).prior;
  EXPECT_EQ(*prior.normal, *prior.axis);
  // A screw: the axis is along t and any plane is as near.
  pair.truth->t = 3.0 * *prior.axis;
  prior = Applied(options, 0, pair).prior;
  EXPECT_NEAR(prior.normal->norm(), 1.0, 1e-12);
  EXPECT_NEAR(prior.normal->dot(pair.truth->t), 0.0, 1e-9);
}

TEST(PriorSource, TruthOfAPairWithoutOneIsAnErrorThatNamesThePair) {
  PriorSourceOptions options;
  options.source = PriorSource::kTruth;
  FramePair pair;
  pair.name = "a.matches";
  std::string error;
  EXPECT_FALSE(ApplyPriorSource(options, 0, &pair, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("a.matches"));
  EXPECT_THAT(error, ::testing::HasSubstr("truth"));
}

TEST(PriorSource, NoiseIsExactlyThatAngleOfEitherSign) {
  for (const PriorNoiseAxis axis :
       {PriorNoiseAxis::kPitch, PriorNoiseAxis::kRoll, PriorNoiseAxis::kRandom}) {
    PriorSourceOptions exact, noisy;
    exact.source = noisy.source = PriorSource::kTruth;
    noisy.noise = DegToRad(1.0);
    noisy.noise_axis = axis;
    int positive = 0;
    constexpr int kPairs = 400;
    for (int index = 0; index < kPairs; ++index) {
      const FramePair pair = PairWithTruth();
      const MotionPrior clean = Applied(exact, index, pair).prior;
      const MotionPrior prior = Applied(noisy, index, pair).prior;
      EXPECT_EQ(*prior.gravity1, *clean.gravity1) << "only the second gravity is disturbed";
      // About one and the same axis, so what lies along it is not turned.
      const Eigen::Vector3d about =
          axis == PriorNoiseAxis::kPitch ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(0, 0, 1);
      const std::pair<const Eigen::Vector3d*, const Eigen::Vector3d*> directions[] = {
          {&*clean.gravity2, &*prior.gravity2},
          {&*clean.axis, &*prior.axis},
          {&*clean.normal, &*prior.normal}};
      for (const auto& [before, after] : directions) {
        EXPECT_NEAR(after->norm(), 1.0, 1e-12);
        if (axis == PriorNoiseAxis::kRandom) {
          EXPECT_LE(AngleDeg(*before, *after), 1.0 + 1e-9);
          continue;
        }
        EXPECT_NEAR(before->dot(about), after->dot(about), 1e-12);
        const Eigen::Vector3d b = *before - about * about.dot(*before);
        const Eigen::Vector3d a = *after - about * about.dot(*after);
        EXPECT_NEAR(AngleDeg(b, a), 1.0, 1e-9);
      }
      positive += prior.gravity2->cross(*clean.gravity2).dot(about) > 0;
      // The same number, the same error.
      EXPECT_EQ(*Applied(noisy, index, pair).prior.gravity2, *prior.gravity2);
    }
    EXPECT_GT(positive, kPairs / 2 - 50);
    EXPECT_LT(positive, kPairs / 2 + 50);
  }
}

TEST(PriorSource, TheSignsDependOnTheSeedNotOnTheSizeOfTheNoise) {
  PriorSourceOptions options;
  options.source = PriorSource::kBody;
  int differ = 0;
  for (int index = 0; index < 50; ++index) {
    options.seed = 1;
    options.noise = DegToRad(1.0);
    const double z1 = Applied(options, index, FramePair()).prior.gravity2->z();
    options.noise = DegToRad(0.2);
    const double z2 = Applied(options, index, FramePair()).prior.gravity2->z();
    EXPECT_GT(z1 * z2, 0);
    options.seed = 2;
    differ += z2 * Applied(options, index, FramePair()).prior.gravity2->z() < 0;
  }
  EXPECT_GT(differ, 10);
  EXPECT_LT(differ, 40);
}

TEST(PriorSource, AStatedSigmaReplacesThatOfThePair) {
  PriorSourceOptions options;
  options.sigma = 0.01;
  FramePair pair;
  pair.prior.axis_sigma = 0.5;
  const MotionPrior prior = Applied(options, 0, pair).prior;
  EXPECT_EQ(*prior.gravity_sigma, 0.01);
  EXPECT_EQ(*prior.axis_sigma, 0.01);
  EXPECT_EQ(*prior.normal_sigma, 0.01);
}

}  // namespace
}  // namespace rigel
