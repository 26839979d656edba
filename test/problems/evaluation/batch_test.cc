// Many files at once: the same results in the same order whatever runs when, and nothing kept of
// what was worked on.
#include "rigel/problems/evaluation/batch.h"

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/minimal/catalogue.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Batch : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "/rigel_batch_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
    std::string error;
    for (int k = 0; k < 8; ++k) {
      SceneOptions scene;
      scene.num_matches = 60 + k;
      paths_.push_back(directory_ + "/" + std::to_string(k) + ".matches");
      ASSERT_TRUE(WriteMatchFile(paths_.back(), ScenePair(scene, k), &error)) << error;
    }
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  void Rewrite(int k, const std::function<void(FramePair*)>& change) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(paths_[k], &pair, &error)) << error;
    change(&pair);
    ASSERT_TRUE(WriteMatchFile(paths_[k], pair, &error)) << error;
  }

  static int Count(const FileComparison& comparison, PriorKind kind) {
    int n = 0;
    for (const SolverResults& s : comparison.solvers) n += FindSolver(s.solver)->prior == kind;
    return n;
  }

  std::string directory_;
  std::vector<std::string> paths_;
};

TEST_F(Batch, ItemsAreInOrderAndForgetTheirMatches) {
  std::ofstream(paths_[2]) << "rubbish";
  const std::function<size_t(const FramePair&)> work = [](const FramePair& pair) {
    return pair.matches.size();
  };
  for (const int threads : {1, 2, 8}) {
    ComparisonOptions options;
    options.num_threads = threads;
    std::atomic<int> progress{0};
    const auto items = RunBatch(options, paths_, 100, work, [&] { ++progress; });
    ASSERT_EQ(items.size(), 8u);
    EXPECT_EQ(progress, 8);
    for (int k = 0; k < 8; ++k) {
      EXPECT_EQ(items[k].position, 100 + k);
      if (k == 2) {
        EXPECT_THAT(items[k].error, HasSubstr("2.matches:1: "));
        continue;
      }
      EXPECT_EQ(items[k].error, "");
      EXPECT_EQ(items[k].pair.name, paths_[k]);
      EXPECT_EQ(items[k].result, 60u + k);
      EXPECT_TRUE(items[k].pair.matches.empty());
      EXPECT_EQ(items[k].pair.matches.capacity(), 0u);
      EXPECT_EQ(items[k].pair.rig.size(), 0);
      EXPECT_TRUE(items[k].pair.truth && items[k].pair.prior.axis);
    }
  }
}

TEST_F(Batch, NoiseOfAPriorFollowsThePositionAmongAllFiles) {
  ComparisonOptions options;
  options.prior.noise = 0.1;
  options.prior.noise_axis = PriorNoiseAxis::kRandom;
  FramePair whole, part, elsewhere;
  std::string error;
  ASSERT_TRUE(LoadPair(options, paths_[5], 5, &whole, &error)) << error;
  ASSERT_TRUE(LoadPair(options, paths_[5], 5, &part, &error)) << error;
  ASSERT_TRUE(LoadPair(options, paths_[5], 1, &elsewhere, &error)) << error;
  EXPECT_EQ(*whole.prior.axis, *part.prior.axis);
  EXPECT_NE(*whole.prior.axis, *elsewhere.prior.axis);
  const std::function<Eigen::Vector3d(const FramePair&)> axis = [](const FramePair& pair) {
    return *pair.prior.axis;
  };
  EXPECT_EQ(RunBatch(options, {paths_[4], paths_[5]}, 4, axis, {})[1].result, *whole.prior.axis);
}

TEST_F(Batch, SolversAreThoseWhosePriorEveryPairHas) {
  ComparisonOptions options;
  options.estimate.ransac.max_iterations = 2;
  options.num_threads = 2;
  const FileComparison both = CompareFiles(options, paths_, 0, {});
  EXPECT_GE(Count(both, PriorKind::kVertical), 3);
  EXPECT_GE(Count(both, PriorKind::kAxis), 3);
  EXPECT_EQ(Count(both, PriorKind::kPlanar), 0);
  EXPECT_GT(Count(both, PriorKind::kNone), 0);
  Rewrite(6, [](FramePair* pair) { pair->prior.gravity2.reset(); });
  const FileComparison fewer = CompareFiles(options, paths_, 0, {});
  EXPECT_EQ(Count(fewer, PriorKind::kVertical), 0);
  EXPECT_EQ(Count(fewer, PriorKind::kAxis), Count(both, PriorKind::kAxis));
  for (const SolverResults& s : fewer.solvers) {
    ASSERT_EQ(s.pairs.size(), 8u);
    for (int k = 0; k < 8; ++k) EXPECT_EQ(s.pairs[k].name, paths_[k]);
  }
  // Solvers without a prior cannot hold one exact; no files, no limits.
  options.estimate.refine.form = RefineForm::kPrior;
  const FileComparison none = CompareFiles(options, {}, 0, {});
  EXPECT_EQ(Count(none, PriorKind::kNone), 0);
  EXPECT_GT(Count(none, PriorKind::kPlanar), 0);
}

TEST_F(Batch, FilesWithoutTruthAreToldAndDoNotChooseSolvers) {
  Rewrite(1, [](FramePair* pair) {
    pair->truth.reset();
    pair->prior = MotionPrior();
  });
  std::ofstream(paths_[3]) << "rubbish";
  ComparisonOptions options;
  options.estimate.ransac.max_iterations = 2;
  const FileComparison comparison = CompareFiles(options, paths_, 0, {});
  EXPECT_THAT(comparison.errors, ElementsAre(HasSubstr("3.matches:1: ")));
  EXPECT_THAT(comparison.without_truth, ElementsAre(HasSubstr("1.matches: has no truth line")));
  EXPECT_EQ(comparison.pairs.size(), 6u);
  EXPECT_GT(Count(comparison, PriorKind::kVertical), 0);
  options.solvers = {"3pt", "4pt"};
  const FileComparison named = CompareFiles(options, paths_, 0, {});
  ASSERT_EQ(named.solvers.size(), 2u);
  EXPECT_EQ(named.solvers[0].solver, "3pt");
  for (const PairResult& result : named.solvers[0].pairs) {
    EXPECT_EQ(result.status, EstimateStatus::kInvalidInput);
  }
}

}  // namespace
}  // namespace rigel
