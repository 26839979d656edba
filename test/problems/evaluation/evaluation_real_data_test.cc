// Accuracy on recorded data. The data is no part of the project: RIGEL_REAL_DATA names its folder,
// and without it these tests are skipped.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/problems/evaluation/comparison.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"

namespace rigel {
namespace {

constexpr int kThreads = 2;

class RealData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RIGEL_REAL_DATA");
    if (folder == nullptr || *folder == '\0') {
      GTEST_SKIP() << "RIGEL_REAL_DATA is not set: the folder of recorded match files";
    }
    folder_ = folder;
  }

  std::vector<FramePair> Read(const std::string& set, MatchUse use, PriorSource source) {
    std::vector<std::string> errors;
    std::vector<FramePair> pairs;
    for (const std::string& path : ListMatchFiles(folder_ + "/" + set, &errors)) {
      FramePair pair;
      std::string error;
      EXPECT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
      SelectMatches(use, &pair);
      PriorSourceOptions options;
      options.source = source;
      EXPECT_TRUE(ApplyPriorSource(options, static_cast<int>(pairs.size()), &pair, &error))
          << error;
      pairs.push_back(pair);
    }
    for (const std::string& error : errors) ADD_FAILURE() << error;
    return pairs;
  }

  SolverSummary Run(const std::vector<FramePair>& pairs, const std::string& solver) {
    EstimateOptions options;
    options.solver = solver;
    const SolverSummary s = Summarize(solver, "all", RunSolver(pairs, options, kThreads, {}));
    std::printf(
        "[ measured ] %-24s rotation %.4f deg, direction %.3f deg, scale %.3f %%, %d of %d\n",
        solver.c_str(), s.refined_rotation_deg ? s.refined_rotation_deg->median : -1.0,
        s.refined_direction_deg ? s.refined_direction_deg->median : -1.0,
        s.refined_scale ? 100 * s.refined_scale->median : -1.0, s.pairs - s.failures, s.pairs);
    return s;
  }

  std::string folder_;
};

const char* const kSolvers[] = {"4pt-axis-approx", "4pt-axis-approx-polished", "4pt-axis",
                                "3pt-approx", "3pt"};

struct Limits {
  double rotation_deg;
  double direction_deg;
  double scale;  // negative: need not be observable
};

void ExpectWithin(const SolverSummary& s, const Limits& limits) {
  EXPECT_EQ(s.failures, 0) << s.solver;
  ASSERT_TRUE(s.refined_rotation_deg && s.refined_direction_deg) << s.solver;
  EXPECT_LE(s.refined_rotation_deg->median, limits.rotation_deg) << s.solver;
  EXPECT_LE(s.refined_direction_deg->median, limits.direction_deg) << s.solver;
  if (limits.scale < 0) return;
  ASSERT_TRUE(s.refined_scale.has_value()) << s.solver;
  EXPECT_LE(s.refined_scale->median, limits.scale) << s.solver;
}

TEST_F(RealData, KittiStereoOfAllMatchesWithoutASensor) {
  const std::vector<FramePair> pairs = Read("kitti_stereo_06", MatchUse::kAll, PriorSource::kBody);
  ASSERT_EQ(pairs.size(), 50u);
  for (const char* solver : kSolvers) ExpectWithin(Run(pairs, solver), {0.036, 0.27, 0.0033});
}

TEST_F(RealData, KittiStereoOfIntraCameraMatchesWithoutASensor) {
  const std::vector<FramePair> pairs =
      Read("kitti_stereo_06", MatchUse::kIntra, PriorSource::kBody);
  for (const char* solver : kSolvers) {
    const SolverSummary s = Run(pairs, solver);
    ExpectWithin(s, {0.024, 0.28, -1});
    EXPECT_FALSE(s.refined_scale.has_value()) << "next to no rotation: scale is not observable";
  }
}

TEST_F(RealData, KittiTracksWithoutASensor) {
  const std::vector<FramePair> pairs = Read("kitti_tracks_00", MatchUse::kAll, PriorSource::kBody);
  ASSERT_EQ(pairs.size(), 62u);
  for (const char* solver : kSolvers) ExpectWithin(Run(pairs, solver), {0.033, 0.72, 0.007});
}

TEST_F(RealData, EurocLoopOfLargeRotationWithGravity) {
  const std::vector<FramePair> pairs = Read("euroc_loop", MatchUse::kAll, PriorSource::kFile);
  ASSERT_EQ(pairs.size(), 4u);
  EstimateOptions options;
  options.solver = "4pt";
  for (const PairResult& result : RunSolver(pairs, options, kThreads, {})) {
    SCOPED_TRACE(result.name);
    EXPECT_FALSE(result.failed) << result.message;
    if (!result.refined.has_value()) continue;
    std::printf("[ measured ] rotation %.4f deg, direction %.3f deg, scale %.3f %%\n",
                RadToDeg(result.refined->rotation),
                result.refined->direction ? RadToDeg(*result.refined->direction) : -1.0,
                result.refined->scale ? 100 * *result.refined->scale : -1.0);
    EXPECT_LE(RadToDeg(result.refined->rotation), 0.23);
    ASSERT_TRUE(result.refined->direction && result.refined->scale);
    EXPECT_LE(RadToDeg(*result.refined->direction), 2.6);
    EXPECT_LE(*result.refined->scale, 0.025);
  }
}

// Standing on the ground: the rotation is told, a direction is not.
TEST_F(RealData, EurocStillHasNoObservableDirection) {
  const std::vector<FramePair> pairs = Read("euroc_still", MatchUse::kAll, PriorSource::kFile);
  ASSERT_EQ(pairs.size(), 8u);
  for (const FramePair& pair : pairs) {
    EstimateOptions options;
    options.solver = "4pt";
    const MotionEstimate estimate = EstimateMotion(options, pair);
    EXPECT_EQ(estimate.status, EstimateStatus::kSuccess) << pair.name << estimate.message;
    EXPECT_FALSE(estimate.refine.translation_observable) << pair.name;
    EXPECT_FALSE(estimate.refine.scale_observable) << pair.name;
    EXPECT_TRUE(estimate.refine.rotation_observable) << pair.name;
    EXPECT_LT(RadToDeg(RotationError(pair.truth->R, estimate.pose.R)), 0.1) << pair.name;
  }
}

}  // namespace
}  // namespace rigel
