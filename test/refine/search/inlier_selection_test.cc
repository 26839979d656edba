// Which matches are inliers: all of them without outliers, and with outliers those that fit by
// chance are left out where their parallax gives them away.
#include "rigel/refine/search/inlier_selection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "rigel/refine/between_factor.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/refine.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr int kPairs = 100;

// Matches of a known noise at their true motion: what the gate selects, and what is left of it if
// the outliers that fit by chance are excluded.
struct Selection {
  MatchErrors errors;
  std::vector<char> by_gate, plausible;
  int in_gate = 0, left = 0;

  Selection(const GroupedMatches& matches, const Pose& truth, double noise_px) {
    NoiseOptions options;
    options.noise_px = noise_px;
    errors.Set(matches, truth, options.threshold_px);
    const NoiseModel noise = EstimateNoise(options, matches, errors, 6, nullptr);
    in_gate = SelectWithinGate(matches, errors, noise, &by_gate);
    InlierFit fit;
    fit.weights.assign(matches.size(), 1.0 / noise_px);
    fit.members = by_gate;
    std::vector<double> weights(matches.size());
    for (int k = 0; k < matches.size(); ++k) weights[k] = by_gate[k] / noise_px;
    EXPECT_TRUE(CovarianceOfBasis(SampsonInformation(matches, weights, truth),
                                  FullBasis(truth, true), &fit.covariance));
    plausible = by_gate;
    left = ExcludeImplausible(matches, truth, errors, noise, fit, &plausible);
  }
};

TEST(InlierSelection, WithoutOutliersItIsTheGateAlone) {
  for (const double inter_share : {0.0, 0.5}) {
    int lost = 0, total = 0;
    for (int index = 0; index < kPairs; ++index) {
      SceneOptions options;
      options.inter_share = inter_share;
      const FramePair pair = ScenePair(options, index);
      const GroupedMatches matches(pair.rig, pair.matches);
      const Selection s(matches, *pair.truth, options.noise_px);
      total += s.in_gate;
      lost += s.in_gate - s.left;
      EXPECT_EQ(s.in_gate, std::count(s.by_gate.begin(), s.by_gate.end(), 1));
      EXPECT_EQ(s.left, std::count(s.plausible.begin(), s.plausible.end(), 1));
      for (size_t k = 0; k < s.plausible.size(); ++k) EXPECT_LE(s.plausible[k], s.by_gate[k]);
    }
    EXPECT_LE(lost, total / 2000);
  }
}

// What the outliers that fit by chance cost: the direction of t without this selection.
TEST(InlierSelection, ChanceOutliersCostNextToNothing) {
  double with2 = 0.0, oracle2 = 0.0;
  int good_lost = 0, good = 0, bad_kept = 0, bad_in_gate = 0;
  for (int index = 0; index < kPairs; ++index) {
    SceneOptions options;
    options.num_matches = 600;
    options.motion = MotionPattern::kRandom;
    const FramePair clean = ScenePair(options, index);
    options.outlier_share = 0.3;
    const FramePair pair = ScenePair(options, index);
    const GroupedMatches matches(pair.rig, pair.matches);
    std::vector<Match> inliers;
    std::vector<char> is_good(matches.size());
    for (int k = 0; k < matches.size(); ++k) {
      // The same seed: outliers take the place of the first matches of the clean pair.
      const Match& m = matches.matches()[k];
      for (const Match& other : clean.matches) {
        if (m.pixel1 == other.pixel1 && m.pixel2 == other.pixel2) is_good[k] = 1;
      }
      if (is_good[k]) inliers.push_back(m);
    }
    ASSERT_EQ(inliers.size(), 420u);
    const Selection s(matches, *pair.truth, options.noise_px);
    for (int k = 0; k < matches.size(); ++k) {
      good += is_good[k] && s.by_gate[k];
      good_lost += is_good[k] && s.by_gate[k] && !s.plausible[k];
      bad_in_gate += !is_good[k] && s.by_gate[k];
      bad_kept += !is_good[k] && s.plausible[k];
    }
    RefineOptions refine;
    refine.noise_px = options.noise_px;
    Random random = Random::Stream(5, index);
    Pose with = StartNear(*pair.truth, 0.05, 0.02, &random), oracle = with;
    ASSERT_TRUE(Refine(refine, pair.rig, pair.matches, pair.prior, &with).IsSolutionUsable());
    ASSERT_TRUE(Refine(refine, pair.rig, inliers, pair.prior, &oracle).IsSolutionUsable());
    with2 += std::pow(DirectionErrorDeg(*pair.truth, with), 2);
    oracle2 += std::pow(DirectionErrorDeg(*pair.truth, oracle), 2);
  }
  std::printf(
      "[ measured ] direction RMS %.3f, of the inliers alone %.3f; kept %d of %d chance "
      "outliers, lost %d of %d inliers\n",
      std::sqrt(with2 / kPairs), std::sqrt(oracle2 / kPairs), bad_kept, bad_in_gate, good_lost,
      good);
  EXPECT_LT(std::sqrt(with2 / oracle2), 1.06);
  EXPECT_LT(bad_kept, bad_in_gate / 2);
  EXPECT_LT(good_lost, good / 1000);
}

// Which of the pair's matches are those of the same scene without outliers.
std::vector<char> AreInliers(SceneOptions scene, int index, const FramePair& pair) {
  scene.outlier_share = 0.0;
  const FramePair clean = ScenePair(scene, index);
  std::vector<char> good;
  for (const Match& m : pair.matches) {
    good.push_back(std::any_of(clean.matches.begin(), clean.matches.end(), [&](const Match& other) {
      return m.pixel1 == other.pixel1 && m.pixel2 == other.pixel2;
    }));
  }
  return good;
}

// By leverage, too: few outliers that fit by chance, but then the motion is off by tens of what the
// covariance says. Mean of (error)' C^-1 (error) / 6 over pairs; without outliers it is 1.0.
TEST(InlierSelection, ChanceOutliersHardlySpoilTheCovariance) {
  struct Setting {
    int num_matches;
    double outlier_share, inter_share;
    MotionPattern motion;
  };
  for (const Setting& setting : {Setting{200, 0.2, 0.25, MotionPattern::kForward},
                                 Setting{200, 0.2, 0.5, MotionPattern::kRandom},
                                 Setting{100, 0.5, 0.5, MotionPattern::kForward}}) {
    double sum = 0.0;
    int far_off = 0, good = 0, good_lost = 0;
    for (int index = 0; index < 2 * kPairs; ++index) {
      SceneOptions scene;
      scene.num_matches = setting.num_matches;
      scene.outlier_share = setting.outlier_share;
      scene.inter_share = setting.inter_share;
      scene.motion = setting.motion;
      scene.seed = 7;
      const FramePair pair = ScenePair(scene, index);
      EstimateOptions options;
      options.refine.noise_px = scene.noise_px;
      const MotionEstimate estimate = EstimateMotion(options, pair);
      ASSERT_TRUE(estimate.refine.covariance.has_value());
      const Vector6d error = Difference(*pair.truth, estimate.pose);
      const double nees = error.dot(PseudoInformation(*estimate.refine.covariance) * error) / 6.0;
      sum += nees;
      far_off += nees > 4.0;
      const std::vector<char> is_good = AreInliers(scene, index, pair);
      for (size_t k = 0; k < is_good.size(); ++k) {
        good += is_good[k];
        good_lost += is_good[k] && !estimate.refine.inliers[k];
      }
    }
    std::printf("[ measured ] NEES %.3f, above 4: %d of %d; lost %d of %d inliers\n",
                sum / (2 * kPairs), far_off, 2 * kPairs, good_lost, good);
    EXPECT_GT(sum / (2 * kPairs), 0.85);
    // Of many outliers among few matches some are left in a few pairs, which make the mean.
    EXPECT_LT(sum / (2 * kPairs), setting.outlier_share < 0.5 ? 1.2 : 1.4);
    EXPECT_LE(far_off, 4);
    EXPECT_LT(good_lost, good / 500);
  }
}

// Among few matches all have much leverage: none of them stands out.
TEST(InlierSelection, FewMatchesStayTogether) {
  for (const int num_matches : {12, 20, 40}) {
    int lost = 0, good = 0, failures = 0;
    for (int index = 0; index < 2 * kPairs; ++index) {
      SceneOptions scene;
      scene.num_matches = num_matches;
      scene.outlier_share = 0.2;
      scene.inter_share = 0.3;
      scene.motion = MotionPattern::kRandom;
      const FramePair pair = ScenePair(scene, index);
      RefineOptions options;
      options.noise_px = scene.noise_px;
      Pose pose = *pair.truth;
      const RefineSummary summary = RefinePair(options, pair, &pose);
      failures += !summary.IsSolutionUsable();
      if (!summary.IsSolutionUsable()) continue;
      const std::vector<char> is_good = AreInliers(scene, index, pair);
      for (size_t k = 0; k < is_good.size(); ++k) {
        good += is_good[k];
        lost += is_good[k] && !summary.inliers[k];
      }
    }
    std::printf("[ measured ] %d matches: %d of %d not refined, lost %d of %d inliers\n",
                num_matches, failures, 2 * kPairs, lost, good);
    EXPECT_EQ(failures, 0);
    // With twelve matches each of more than the mean leverage is one of a few.
    EXPECT_LT(lost, good / (num_matches < 20 ? 50 : 80));
  }
}

}  // namespace
}  // namespace rigel
