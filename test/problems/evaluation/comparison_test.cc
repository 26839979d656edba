// Raw against refined over many pairs: selection, summaries, failures, threads, and what the issue
// asks of a noisy prior.
#include "rigel/problems/evaluation/comparison.h"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

PairResult Solved(double raw_deg, double refined_deg) {
  PairResult result;
  result.failed = false;
  result.status = EstimateStatus::kSuccess;
  result.raw = MotionErrors{DegToRad(raw_deg), {}, {}, {}};
  result.refined = MotionErrors{DegToRad(refined_deg), {}, {}, {}};
  result.inlier_ratio = 0.5;
  result.iterations = 100;
  result.ransac_ms = 2.0;
  result.refine_ms = 1.0;
  return result;
}

TEST(Comparison, SelectMatchesKeepsAKindInItsOrder) {
  SceneOptions scene;
  scene.inter_share = 0.3;
  FramePair pair = ScenePair(scene, 1);
  // A column goes with its match.
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    pair.columns.landmark.push_back(static_cast<int64_t>(k));
  }
  for (const MatchUse use : {MatchUse::kAll, MatchUse::kIntra, MatchUse::kInter}) {
    FramePair selected = pair;
    SelectMatches(use, &selected);
    EXPECT_EQ(selected.matches.size(), use == MatchUse::kAll     ? 200u
                                       : use == MatchUse::kIntra ? 140u
                                                                 : 60u);
    size_t k = 0;
    for (size_t i = 0; i < pair.matches.size(); ++i) {
      const Match& m = pair.matches[i];
      if (use != MatchUse::kAll && m.IsIntra() != (use == MatchUse::kIntra)) continue;
      ASSERT_LT(k, selected.matches.size());
      EXPECT_EQ(selected.matches[k].pixel2, m.pixel2);
      EXPECT_EQ(selected.columns.landmark[k], static_cast<int64_t>(i));
      ++k;
    }
  }
  MatchUse use = MatchUse::kAll;
  EXPECT_TRUE(ParseMatchUse("intra", &use));
  EXPECT_EQ(use, MatchUse::kIntra);
  EXPECT_TRUE(ParseMatchUse("inter", &use));
  EXPECT_EQ(use, MatchUse::kInter);
  EXPECT_TRUE(ParseMatchUse("all", &use));
  EXPECT_EQ(use, MatchUse::kAll);
  EXPECT_FALSE(ParseMatchUse("both", &use));
}

TEST(Comparison, SummaryOfNothing) {
  const SolverSummary s = Summarize("4pt", "all", {});
  EXPECT_EQ(s.pairs, 0);
  EXPECT_EQ(s.failures, 0);
  EXPECT_FALSE(s.raw_rotation_deg || s.refined_rotation_deg || s.inlier_ratio || s.ransac_ms ||
               s.raw_direction_deg || s.bound_rotation_deg);
}

TEST(Comparison, AFailureCountsAndEntersNoStatistic) {
  std::vector<PairResult> results = {Solved(1.0, 0.1), Solved(3.0, 0.3), PairResult()};
  results[2].iterations = 10000;
  results[2].ransac_ms = 500;
  const SolverSummary s = Summarize("4pt", "loop", results);
  EXPECT_EQ(s.solver, "4pt");
  EXPECT_EQ(s.sequence, "loop");
  EXPECT_EQ(s.pairs, 3);
  EXPECT_EQ(s.failures, 1);
  EXPECT_NEAR(s.raw_rotation_deg->median, 2.0, 1e-12);
  EXPECT_NEAR(s.refined_rotation_deg->mean, 0.2, 1e-12);
  EXPECT_EQ(s.iterations->mean, 100);
  EXPECT_EQ(s.ransac_ms->mean, 2.0);
  EXPECT_EQ(s.refine_ms->mean, 1.0);
  EXPECT_EQ(s.inlier_ratio->mean, 0.5);

  const SolverSummary none = Summarize("4pt", "all", {PairResult(), PairResult()});
  EXPECT_EQ(none.failures, 2);
  EXPECT_FALSE(none.raw_rotation_deg || none.iterations || none.bound_rotation_deg ||
               none.raw_direction_deg);
}

TEST(Comparison, WhatMostPairsLackIsLeftOut) {
  // 4 pairs: a direction in 3, a scale in 2, a bound in all or all but one.
  std::vector<PairResult> results(4, Solved(1.0, 0.1));
  for (int k = 0; k < 3; ++k) results[k].raw->direction = results[k].refined->direction = 0.01 * k;
  for (int k = 0; k < 2; ++k) results[k].raw->scale = results[k].refined->scale = 0.1;
  for (PairResult& r : results) {
    r.bound = MotionBound();
    r.bound->rotation = DegToRad(0.02);
    r.bound->direction = DegToRad(0.3);
    r.bound->rig_direction = DegToRad(0.2);
    r.refined->rig_direction = DegToRad(0.1);
  }
  SolverSummary s = Summarize("4pt", "all", results);
  ASSERT_TRUE(s.raw_direction_deg && s.refined_direction_deg);
  EXPECT_NEAR(s.refined_direction_deg->median, RadToDeg(0.01), 1e-12);
  EXPECT_EQ(s.direction_pairs, 3);
  EXPECT_FALSE(s.raw_scale || s.refined_scale);  // half is not most
  ASSERT_TRUE(s.bound_rotation_deg && s.bound_direction_deg);
  EXPECT_NEAR(s.bound_rotation_deg->rms, 0.02, 1e-12);
  EXPECT_NEAR(s.bound_direction_deg->rms, 0.3, 1e-12);
  EXPECT_NEAR(s.bound_rig_direction_deg->rms, 0.2, 1e-12);
  EXPECT_NEAR(s.refined_rig_direction_deg->rms, 0.1, 1e-12);

  // The bound of the direction is over the pairs whose errors it is held against.
  results[3].bound->direction = DegToRad(90.0);
  EXPECT_NEAR(Summarize("4pt", "all", results).bound_direction_deg->rms, 0.3, 1e-12);
  results[1].bound->direction.reset();
  results[0].bound->direction.reset();
  EXPECT_FALSE(Summarize("4pt", "all", results).bound_direction_deg.has_value());

  results[2].raw->scale = results[2].refined->scale = 0.3;
  results[3].bound.reset();
  s = Summarize("4pt", "all", results);
  ASSERT_TRUE(s.refined_scale.has_value());
  EXPECT_NEAR(s.refined_scale->median, 0.1, 1e-12);
  EXPECT_FALSE(s.bound_rotation_deg || s.bound_direction_deg);
  // Failures do not count towards "most".
  results.resize(6);
  results[3].raw->scale.reset();
  s = Summarize("4pt", "all", results);
  EXPECT_EQ(s.failures, 2);
  EXPECT_TRUE(s.refined_scale.has_value());
}

TEST(Comparison, RunSolverFillsResultsInTheOrderOfTheInput) {
  std::vector<FramePair> pairs;
  for (int index = 0; index < 6; ++index) {
    SceneOptions scene;
    scene.inter_share = index % 2 == 0 ? 0.5 : 0.0;
    scene.outlier_share = 0.2;
    pairs.push_back(ScenePair(scene, index));
    pairs.back().sequence = "s" + std::to_string(index);
  }
  pairs[3].matches.resize(2);
  pairs[3].columns = MatchColumns();
  pairs[4].prior = MotionPrior();
  pairs[5].truth.reset();
  EstimateOptions options;
  options.solver = "4pt";
  std::atomic<int> progress{0};
  const std::vector<PairResult> results = RunSolver(pairs, options, 2, [&] { ++progress; });
  ASSERT_EQ(results.size(), 6u);
  EXPECT_EQ(progress, 6);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(results[k].name, pairs[k].name);
    EXPECT_EQ(results[k].sequence, pairs[k].sequence);
  }
  for (const int k : {0, 1, 2}) {
    EXPECT_EQ(results[k].status, EstimateStatus::kSuccess);
    EXPECT_FALSE(results[k].failed);
    ASSERT_TRUE(results[k].raw && results[k].refined && results[k].bound);
    EXPECT_LT(RadToDeg(results[k].refined->rotation), 0.2);
    EXPECT_TRUE(results[k].refined->direction.has_value());
    // A scale is reported where it is observable, for raw and refined alike.
    EXPECT_EQ(results[k].refined->scale.has_value(), k % 2 == 0);
    EXPECT_EQ(results[k].raw->scale.has_value(), k % 2 == 0);
    EXPECT_GT(results[k].inlier_ratio, 0.7);
    EXPECT_GT(results[k].ransac_ms, 0);
  }
  EXPECT_EQ(results[3].status, EstimateStatus::kTooFewMatches);
  EXPECT_EQ(results[4].status, EstimateStatus::kInvalidInput);
  for (const int k : {3, 4}) {
    EXPECT_TRUE(results[k].failed);
    EXPECT_FALSE(results[k].raw || results[k].refined || results[k].bound);
    EXPECT_FALSE(results[k].message.empty());
  }
  EXPECT_FALSE(results[5].raw || results[5].refined);  // no truth, nothing to compare with
}

TEST(Comparison, AnyNumberOfThreadsGivesTheSameResults) {
  std::vector<FramePair> pairs;
  for (int index = 0; index < 8; ++index) pairs.push_back(ScenePair(SceneOptions(), index));
  const std::vector<PairResult> one = RunSolver(pairs, EstimateOptions(), 1, {});
  for (const int threads : {2, 5}) {
    const std::vector<PairResult> more = RunSolver(pairs, EstimateOptions(), threads, {});
    for (size_t k = 0; k < pairs.size(); ++k) {
      EXPECT_EQ(one[k].raw->rotation, more[k].raw->rotation);
      EXPECT_EQ(one[k].refined->rotation, more[k].refined->rotation);
      EXPECT_EQ(one[k].refined->direction, more[k].refined->direction);
      EXPECT_EQ(one[k].iterations, more[k].iterations);
    }
  }
}

TEST(Comparison, WithoutRefinementThereIsRawAlone) {
  std::vector<FramePair> pairs = {ScenePair(SceneOptions(), 1)};
  EstimateOptions options;
  options.refine_motion = false;
  const std::vector<PairResult> results = RunSolver(pairs, options, 1, {});
  EXPECT_FALSE(results[0].failed);
  EXPECT_TRUE(results[0].raw.has_value());
  EXPECT_FALSE(results[0].refined || results[0].bound);
  const SolverSummary s = Summarize("4pt-axis", "all", results);
  EXPECT_TRUE(s.raw_rotation_deg.has_value());
  EXPECT_FALSE(s.refined_rotation_deg || s.bound_rotation_deg);
}

// Then nothing has measured that the scale is determined; only the kind of the matches speaks for
// it.
TEST(Comparison, WithoutRefinementTheScaleNeedsMatchesBetweenCameras) {
  SceneOptions inter;
  inter.inter_share = 0.5;
  const std::vector<FramePair> pairs = {ScenePair(SceneOptions(), 1), ScenePair(inter, 1)};
  EXPECT_FALSE(HasInterCameraMatches(pairs[0]));
  EXPECT_TRUE(HasInterCameraMatches(pairs[1]));
  EstimateOptions options;
  options.refine_motion = false;
  const std::vector<PairResult> results = RunSolver(pairs, options, 1, {});
  for (const PairResult& result : results) {
    ASSERT_TRUE(result.raw.has_value()) << result.message;
    EXPECT_TRUE(result.raw->direction.has_value());
  }
  EXPECT_FALSE(results[0].raw->scale.has_value());
  EXPECT_TRUE(results[1].raw->scale.has_value());
  EXPECT_FALSE(Summarize("4pt-axis", "all", {results[0]}).raw_scale.has_value());
}

// Errors in units of the stated covariance: 1 a degree of freedom where the noise is what the
// options state, a quarter where they state twice as much.
TEST(Comparison, NeesTestsTheStatedCovariance) {
  for (const double stated : {1.0, 2.0}) {
    std::vector<FramePair> pairs;
    for (int index = 0; index < 200; ++index) {
      SceneOptions scene;
      scene.motion = MotionPattern::kRandom;
      scene.inter_share = 0.5;
      pairs.push_back(ScenePair(scene, index));
    }
    EstimateOptions options;
    options.solver = "4pt";
    options.refine.noise_px = stated * SceneOptions().noise_px;
    const SolverSummary s = Summarize("4pt", "all", RunSolver(pairs, options, 2, {}));
    ASSERT_TRUE(s.nees && s.nees_rotation);
    std::printf(
        "[ measured ] noise stated %.0f times: NEES %.3f of %.2f, %.3f to %.3f; rotation %.3f\n",
        stated, s.nees->ratio, s.nees->dof, s.nees->low, s.nees->high, s.nees_rotation->ratio);
    EXPECT_NEAR(s.nees->ratio * stated * stated, 1.0, 0.12);
    EXPECT_NEAR(s.nees->dof, 6.0, 0.1);
    // 1200 degrees of freedom: 1 +- 2.58 sqrt(2 / 1200).
    EXPECT_NEAR(s.nees->low, 0.898, 0.01);
    EXPECT_NEAR(s.nees->high, 1.108, 0.01);
    EXPECT_NEAR(s.nees_rotation->ratio * stated * stated, 1.0, 0.15);
    EXPECT_EQ(s.nees_rotation->dof, 3.0);
    ASSERT_TRUE(s.nees_rig_direction.has_value());
    EXPECT_NEAR(s.nees_rig_direction->ratio * stated * stated, 1.0, 0.2);
    EXPECT_EQ(s.nees_rig_direction->dof, 2.0);
  }
}

// A truth that stands still has no direction to be held to.
TEST(Comparison, AStillTruthHasNoDirectionError) {
  SceneOptions scene;
  scene.inter_share = 0.5;
  scene.noise_px = 0.001;  // of which there is a bound: the flow is below a pixel
  Pose truth;
  truth.R = ExpSO3(Eigen::Vector3d(0, 0.01, 0));
  truth.t = {0, 0, 0.5 * kMinTrueTranslation};
  const std::vector<FramePair> pairs = {ScenePair(scene, 1, truth)};
  const std::vector<PairResult> results = RunSolver(pairs, EstimateOptions(), 1, {});
  ASSERT_TRUE(results[0].refined.has_value()) << results[0].message;
  EXPECT_FALSE(results[0].refined->direction || results[0].refined->scale);
  ASSERT_TRUE(results[0].bound.has_value());
  EXPECT_FALSE(results[0].bound->direction.has_value());
  EXPECT_LT(RadToDeg(results[0].refined->rotation), 0.1);
}

// The raw motion inherits the error of its prior, the refined one leaves it.
TEST(PriorNoise, TheRefinedMotionDoesNotInheritIt) {
  constexpr int kPairs = 200;
  double raw[4], refined[4];
  const double noise_deg[4] = {0.0, 0.2, 0.5, 1.0};
  for (int n = 0; n < 4; ++n) {
    std::vector<FramePair> pairs;
    for (int index = 0; index < kPairs; ++index) {
      SceneOptions scene;
      scene.motion = MotionPattern::kRandom;
      pairs.push_back(ScenePair(scene, index));
      PriorSourceOptions prior;
      prior.source = PriorSource::kTruth;
      prior.noise = DegToRad(noise_deg[n]);
      std::string error;
      ASSERT_TRUE(ApplyPriorSource(prior, index, &pairs.back(), &error)) << error;
    }
    EstimateOptions options;
    options.solver = "4pt-approx";
    const SolverSummary s = Summarize(options.solver, "all", RunSolver(pairs, options, 2, {}));
    EXPECT_EQ(s.failures, 0);
    ASSERT_TRUE(s.refined_rotation_deg.has_value());
    raw[n] = s.raw_rotation_deg->median;
    refined[n] = s.refined_rotation_deg->median;
    std::printf("[ measured ] prior off by %.1f deg: rotation raw %.4f, refined %.4f deg\n",
                noise_deg[n], raw[n], refined[n]);
  }
  for (int n = 0; n < 4; ++n) {
    EXPECT_LT(refined[n], 0.045) << noise_deg[n];
    EXPECT_LE(refined[n], 1.15 * refined[0]) << noise_deg[n];
  }
  EXPECT_GT(raw[3], 1.0);
  EXPECT_LT(raw[0], 0.3);
}

}  // namespace
}  // namespace rigel
