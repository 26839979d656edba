// The noise of each camera pair from the errors of its matches, and what it does for an estimate.
#include "rigel/refine/search/noise_model.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr double kThresholdPx = 1.5;

// Errors that are drawn, in place of those of a motion: normal ones of a sigma for each camera
// pair, and outliers that are uniform up to kFarPx.
struct Drawn {
  static constexpr double kFarPx = 300.0;
  GroupedMatches matches;
  MatchErrors errors;

  // `per_group` matches in each of the four camera pairs of two cameras.
  Drawn(int per_group, const std::vector<double>& sigma_of, double outlier_share, int index) {
    Random random = Random::Stream(31, index);
    Rig rig = MixedRig(&random);
    rig.cameras.resize(2);
    matches = GroupedMatches(rig, UnrelatedMatches(rig, 4 * per_group, &random));
    errors.in_front.assign(matches.size(), 1);
    errors.squared.resize(matches.size());
    for (size_t g = 0; g < matches.groups().size(); ++g) {
      const MatchGroup& group = matches.groups()[g];
      for (int k = group.begin; k < group.begin + group.size; ++k) {
        const bool is_outlier = random.Uniform() < outlier_share;
        errors.squared[k] =
            std::pow(is_outlier ? random.Uniform(0, kFarPx) : sigma_of[g] * random.Normal(), 2);
      }
    }
  }
  NoiseModel Estimate(const NoiseOptions& options) const {
    return EstimateNoise(options, matches, errors, 0, nullptr);
  }
};

// Mean and root mean square of log(estimate / truth).
struct LogError {
  double sum = 0.0, squares = 0.0;
  int n = 0;
  void Add(double estimate, double truth) {
    const double error = std::log(estimate / truth);
    sum += error;
    squares += error * error;
    ++n;
  }
  double mean() const { return sum / n; }
  double rms() const { return std::sqrt(squares / n); }
};

// From a fifteenth of the first gate to more than the gate itself. Half of a normal sample's errors
// say what an estimate of its sigma is worth: the logarithm has a variance of 0.7 / n, if not less.
TEST(NoiseModel, FindsTheNoiseWithOutliers) {
  for (const double sigma : {0.1, 0.3, 0.5, 1.0, 2.0}) {
    LogError all, own;
    constexpr int kPerGroup = 200;
    for (int index = 0; index < 100; ++index) {
      const Drawn drawn(kPerGroup, std::vector<double>(4, sigma), 0.2, index);
      NoiseOptions options;
      options.threshold_px = kThresholdPx;
      const NoiseModel noise = drawn.Estimate(options);
      all.Add(noise.sigma_px, sigma);
      for (size_t g = 0; g < noise.sigma_of.size(); ++g) {
        own.Add(noise.sigma_of[g], sigma);
        EXPECT_NEAR(noise.gate_of[g], kGateSigmas * noise.sigma_of[g], 1e-12);
      }
    }
    const double scatter = std::sqrt(0.7 / (0.8 * 4 * kPerGroup));
    std::printf("[ measured ] sigma %.1f: log error %.4f, rms %.4f (%.4f); of a camera pair %.4f\n",
                sigma, all.mean(), all.rms(), scatter, own.rms());
    EXPECT_LT(std::abs(all.mean()), 0.01) << sigma;
    EXPECT_LT(all.rms(), 1.2 * scatter) << sigma;
    // Drawn to the noise of all: no worse than alone.
    EXPECT_LT(own.rms(), 2.0 * scatter) << sigma;
  }
}

TEST(NoiseModel, EachCameraPairHasItsOwn) {
  const std::vector<double> sigma_of = {0.2, 0.5, 0.5, 1.0};
  LogError own[4];
  for (int index = 0; index < 100; ++index) {
    const Drawn drawn(200, sigma_of, 0.2, index);
    NoiseOptions options;
    options.threshold_px = kThresholdPx;
    const NoiseModel noise = drawn.Estimate(options);
    for (int g = 0; g < 4; ++g) own[g].Add(noise.sigma_of[g], sigma_of[g]);
  }
  for (const LogError& error : own) {
    std::printf("[ measured ] log error %.4f, rms %.4f\n", error.mean(), error.rms());
    EXPECT_LT(std::abs(error.mean()), 0.03);
    EXPECT_LT(error.rms(), 1.2 * std::sqrt(0.7 / 160));
  }
}

// Of few errors a noise of their own would be chance, and so would the weights.
TEST(NoiseModel, ACameraPairOfFewMatchesHasTheNoiseOfAll) {
  for (int index = 0; index < 20; ++index) {
    const Drawn drawn(12, std::vector<double>(4, 0.5), 0.0, index);
    NoiseOptions options;
    options.threshold_px = kThresholdPx;
    const NoiseModel noise = drawn.Estimate(options);
    for (const double sigma : noise.sigma_of) EXPECT_EQ(sigma, noise.sigma_of[0]);
  }
}

// A threshold that is kept cuts a part of the errors off: at 1.5 sigma 13 percent of them.
TEST(NoiseModel, IsCorrectedForTheErrorsThatAKeptThresholdCutsOff) {
  LogError all;
  for (int index = 0; index < 100; ++index) {
    constexpr double kSigma = 1.0;
    const Drawn drawn(200, std::vector<double>(4, kSigma), 0.2, index);
    NoiseOptions options;
    options.threshold_px = kThresholdPx;
    options.keep_threshold = true;
    const NoiseModel noise = drawn.Estimate(options);
    EXPECT_EQ(noise.gate_of, std::vector<double>(4, kThresholdPx));
    all.Add(noise.sigma_px, kSigma);
  }
  std::printf("[ measured ] log error %.4f, rms %.4f\n", all.mean(), all.rms());
  EXPECT_LT(std::abs(all.mean()), 0.03);
  EXPECT_LT(all.rms(), 0.15);
}

TEST(NoiseModel, AGivenNoiseIsThatOfAllCameraPairs) {
  const Drawn drawn(50, {0.2, 0.5, 0.5, 1.0}, 0.2, 0);
  NoiseOptions options;
  options.threshold_px = kThresholdPx;
  options.noise_px = 0.7;
  const std::vector<double> given(4, 0.7), six_sigma(4, kGateSigmas * 0.7);
  for (const bool keep : {false, true}) {
    options.keep_threshold = keep;
    const NoiseModel noise = drawn.Estimate(options);
    EXPECT_EQ(noise.sigma_px, 0.7);
    EXPECT_EQ(noise.sigma_of, given);
    // A threshold below that would cut inliers off.
    EXPECT_EQ(noise.gate_of, six_sigma);
  }
  options.threshold_px = 9.0;
  EXPECT_EQ(drawn.Estimate(options).gate_of, std::vector<double>(4, 9.0));
}

TEST(NoiseModel, CountsTheOutliersOfAPixel) {
  for (const double sigma : {0.1, 0.5}) {
    double per_px = 0.0;
    constexpr int kDraws = 50, kPerGroup = 500;
    for (int index = 0; index < kDraws; ++index) {
      const Drawn drawn(kPerGroup, std::vector<double>(4, sigma), 0.4, index);
      NoiseOptions options;
      options.threshold_px = kThresholdPx;
      for (const double n : drawn.Estimate(options).outliers_per_px) per_px += n / (4 * kDraws);
    }
    const double expected = 0.4 * kPerGroup / Drawn::kFarPx;
    EXPECT_NEAR(per_px, expected, 0.1 * expected) << sigma;
  }
}

// Without an inlier, without noise, without matches: nothing is found, and nothing is not finite.
TEST(NoiseModel, IsFiniteWhateverTheErrors) {
  NoiseOptions options;
  options.threshold_px = kThresholdPx;
  options.min_noise_px = 1e-6;
  Drawn drawn(50, std::vector<double>(4, 0.5), 0.0, 0);
  for (const double error : {0.0, 1e9}) {
    drawn.errors.squared.assign(drawn.matches.size(), error * error);
    const NoiseModel noise = drawn.Estimate(options);
    for (size_t g = 0; g < noise.sigma_of.size(); ++g) {
      EXPECT_GE(noise.sigma_of[g], options.min_noise_px);
      EXPECT_LE(noise.sigma_of[g], kThresholdPx);
      EXPECT_GT(noise.gate_of[g], 0.0);
    }
  }
  drawn.errors.in_front.assign(drawn.matches.size(), 0);
  EXPECT_TRUE(std::isfinite(drawn.Estimate(options).sigma_px));
}

// Half of the matches inter-camera, with `ratio` times the noise of the others.
FramePair PairWithNoisyInterMatches(int index, double ratio) {
  constexpr double kNoisePx = 0.1;
  SceneOptions options;
  options.num_matches = 400;
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

// Against the same matches weighed alike, which a stated noise makes them.
TEST(NoiseModel, EstimatesAndCovarianceGainFromThatOfEachCameraPair) {
  double squared[2] = {0.0, 0.0}, nees = 0.0;
  LogError intra, inter;
  constexpr int kPairs = 100;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = PairWithNoisyInterMatches(index, 4.0);
    Random random = Random::Stream(29, index);
    const Pose start = StartNear(*pair.truth, 0.1, 0.05, &random);
    for (const bool stated : {false, true}) {
      RefineOptions options;
      if (stated) options.noise_px = 0.2;
      Pose pose = start;
      const RefineSummary summary = Refine(options, pair.rig, pair.matches, MotionPrior(), &pose);
      ASSERT_TRUE(summary.IsSolutionUsable());
      const double error = RotationError(pair.truth->R, pose.R);
      squared[stated] += error * error;
      if (stated) continue;
      for (const CameraPairFit& fit : summary.camera_pairs) {
        (fit.camera1 == fit.camera2 ? intra : inter).Add(fit.noise_px, 0.1);
      }
      ASSERT_TRUE(summary.covariance.has_value());
      const Vector6d d = Difference(*pair.truth, pose);
      nees += d.dot(summary.covariance->ldlt().solve(d)) / 6.0 / kPairs;
    }
  }
  std::printf("[ measured ] rotation %.3f times that of equal weights, NEES %.3f\n",
              std::sqrt(squared[0] / squared[1]), nees);
  EXPECT_NEAR(intra.mean(), 0.0, 0.05);
  EXPECT_NEAR(inter.mean(), std::log(4.0), 0.05);
  EXPECT_LT(std::sqrt(squared[0] / squared[1]), 0.85);
  EXPECT_GT(nees, 0.85);
  EXPECT_LT(nees, 1.2);
}

// The gate follows the noise, up and down, from the same first threshold.
TEST(NoiseModel, TheGateFollowsTheNoise) {
  for (const double noise_px : {0.1, 0.3, 0.5, 1.0, 2.0}) {
    double squared = 0.0, oracle2 = 0.0, nees = 0.0;
    std::vector<double> all_nees;
    LogError sigma;
    constexpr int kPairs = 100;
    for (int index = 0; index < kPairs; ++index) {
      SceneOptions scene;
      scene.num_matches = 400;
      scene.inter_share = 0.5;
      scene.outlier_share = 0.2;
      scene.noise_px = noise_px;
      const FramePair pair = ScenePair(scene, index);
      FramePair inliers = pair;
      inliers.matches.clear();
      for (size_t k = 0; k < pair.matches.size(); ++k) {
        if (pair.columns.inlier[k]) inliers.matches.push_back(pair.matches[k]);
      }
      Random random = Random::Stream(30, index);
      const Pose start = StartNear(*pair.truth, 0.05, 0.02, &random);
      RefineOptions options;
      Pose pose = start, oracle = start;
      const RefineSummary summary = RefinePair(options, pair, &pose);
      ASSERT_TRUE(summary.covariance.has_value());
      sigma.Add(summary.noise_px, noise_px);
      options.noise_px = noise_px;
      options.loss = LossKind::kNone;
      ASSERT_TRUE(RefinePair(options, inliers, &oracle).IsSolutionUsable());
      squared += std::pow(RotationError(pair.truth->R, pose.R), 2);
      oracle2 += std::pow(RotationError(pair.truth->R, oracle.R), 2);
      const Vector6d d = Difference(*pair.truth, pose);
      all_nees.push_back(d.dot(summary.covariance->ldlt().solve(d)) / 6.0);
      nees += all_nees.back() / kPairs;
    }
    std::printf(
        "[ measured ] noise %.1f px: log error %.3f, rotation %.3f times that of the inliers with "
        "their noise, NEES %.3f, median %.3f\n",
        noise_px, sigma.mean(), std::sqrt(squared / oracle2), nees, MedianOf(all_nees));
    EXPECT_LT(std::abs(sigma.mean()), 0.05) << noise_px;
    EXPECT_LT(std::sqrt(squared / oracle2), 1.12) << noise_px;
    // 0.85 to 1.2 in the mean of many pairs; of 100 its standard error is 0.06.
    EXPECT_GT(nees, 0.85 - 0.17) << noise_px;
    EXPECT_LT(nees, 1.2 + 0.17) << noise_px;
    EXPECT_NEAR(MedianOf(all_nees), 0.89, 0.2) << noise_px;
  }
}

}  // namespace
}  // namespace rigel
