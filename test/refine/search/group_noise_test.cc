// Camera pairs whose noise differs: the weights, and what they do for the estimate.
#include "rigel/refine/search/group_noise.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/median.h"
#include "rigel/refine/refine.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr double kNoisePx = 0.1;

// Half of the matches inter-camera, with `ratio` times the noise of the others.
FramePair PairWithNoisyInterMatches(int index, int num_matches, double ratio) {
  SceneOptions options;
  options.num_matches = num_matches;
  options.inter_share = 0.5;
  options.noise_px = 0.0;
  FramePair pair = ScenePair(options, index);
  Random random = Random::Stream(23, index);
  for (Match& match : pair.matches) {
    const double sigma = kNoisePx * (match.IsIntra() ? 1.0 : ratio);
    match.pixel1 += sigma * Eigen::Vector2d{random.Normal(), random.Normal()};
    match.pixel2 += sigma * Eigen::Vector2d{random.Normal(), random.Normal()};
  }
  pair.noise_px.reset();
  return pair;
}

std::vector<double> WeightsAtTruth(const FramePair& pair) {
  const GroupedMatches matches(pair.rig, pair.matches);
  std::vector<double> errors;
  matches.SquaredErrors(*pair.truth, &errors);
  std::vector<double> sorted = errors;
  return GroupNoiseWeights(matches, errors, std::vector<char>(matches.size(), 1),
                           std::sqrt(MedianInPlace(&sorted)));
}

TEST(GroupNoise, WeightsAreInverseToTheNoise) {
  constexpr int kPairs = 20;
  double ratio = 0.0;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = PairWithNoisyInterMatches(index, 2000, 3.0);
    const GroupedMatches matches(pair.rig, pair.matches);
    const std::vector<double> weights = WeightsAtTruth(pair);
    double intra = 0.0, inter = 0.0;
    for (size_t g = 0; g < weights.size(); ++g) {
      const MatchGroup& group = matches.groups()[g];
      (group.camera1 == group.camera2 ? intra : inter) += 0.5 * weights[g];
    }
    ratio += intra / inter / kPairs;
  }
  EXPECT_NEAR(ratio, 3.0, 0.1);
}

TEST(GroupNoise, WeightsAreOneWhereTheNoiseIsTheSame) {
  int unequal = 0;
  for (int index = 0; index < 200; ++index) {
    for (const double weight : WeightsAtTruth(PairWithNoisyInterMatches(index, 100, 1.0))) {
      unequal += weight != 1.0;
    }
  }
  EXPECT_LE(unequal, 4);  // of 800: four standard errors of a median of few
}

TEST(GroupNoise, NothingIsKnownWithoutInliersOrWithoutNoise) {
  const FramePair pair = PairWithNoisyInterMatches(0, 100, 3.0);
  const GroupedMatches matches(pair.rig, pair.matches);
  const std::vector<double> ones(matches.groups().size(), 1.0);
  const std::vector<double> errors(matches.size(), 1.0), zeros(matches.size(), 0.0);
  const std::vector<char> all(matches.size(), 1), none(matches.size(), 0);
  EXPECT_EQ(GroupNoiseWeights(matches, errors, none, -1.0), ones);
  EXPECT_EQ(GroupNoiseWeights(matches, zeros, all, 0.0), ones);
  EXPECT_EQ(GroupNoiseWeights(GroupedMatches(), {}, {}, -1.0), std::vector<double>());
  // A group without any error beside others that have some: no infinite weight.
  std::vector<double> mixed = errors;
  for (int k = 0; k < matches.groups()[0].size; ++k) mixed[k] = 0.0;
  EXPECT_EQ(GroupNoiseWeights(matches, mixed, all, 1.0)[0], 1.0);
}

// Against the same matches weighed alike, which a stated noise level makes them.
TEST(GroupNoise, EstimatesAndCovarianceGainFromIt) {
  double squared[2] = {0.0, 0.0}, nees = 0.0;
  constexpr int kPairs = 100;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = PairWithNoisyInterMatches(index, 400, 4.0);
    Random random = Random::Stream(29, index);
    const Pose start = StartNear(*pair.truth, 0.1, 0.05, &random);
    for (const bool stated : {false, true}) {
      RefineOptions options;
      options.threshold_px = 3.0;
      if (stated) options.noise_px = 2.0 * kNoisePx;
      Pose pose = start;
      const RefineSummary summary = Refine(options, pair.rig, pair.matches, MotionPrior(), &pose);
      ASSERT_TRUE(summary.IsSolutionUsable());
      const double error = RotationError(pair.truth->R, pose.R);
      squared[stated] += error * error;
      if (stated) continue;
      ASSERT_TRUE(summary.covariance.has_value());
      const Vector6d d = Difference(*pair.truth, pose);
      nees += d.dot(summary.covariance->ldlt().solve(d)) / 6.0 / kPairs;
    }
  }
  EXPECT_LT(std::sqrt(squared[0] / squared[1]), 0.85);
  EXPECT_GT(nees, 0.7);
  EXPECT_LT(nees, 1.4);
}

}  // namespace
}  // namespace rigel
