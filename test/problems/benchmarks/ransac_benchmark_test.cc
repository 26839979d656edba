// The RANSAC benchmark: what its rows say of easy and of hopeless scenes.
#include "rigel/problems/benchmarks/ransac_benchmark.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

RansacBenchmarkOptions Few(RansacExperiment experiment, const std::string& solver) {
  RansacBenchmarkOptions options;
  options.experiment = experiment;
  options.solvers = {solver};
  options.pairs = 10;
  return options;
}

TEST(RansacBenchmark, NamesOfExperiments) {
  for (const RansacExperiment e : {RansacExperiment::kSpeed, RansacExperiment::kOutliers,
                                   RansacExperiment::kAblation, RansacExperiment::kMoving}) {
    RansacExperiment parsed = RansacExperiment::kFiles;
    EXPECT_TRUE(ParseRansacExperiment(RansacExperimentName(e), &parsed));
    EXPECT_EQ(parsed, e);
  }
  RansacExperiment untouched = RansacExperiment::kMoving;
  EXPECT_FALSE(ParseRansacExperiment("files", &untouched));
  EXPECT_FALSE(ParseRansacExperiment("", &untouched));
  EXPECT_EQ(untouched, RansacExperiment::kMoving);
}

TEST(RansacBenchmark, SpeedRowsAreNearTheBoundWithBothForms) {
  const RansacBenchmarkOptions options = Few(RansacExperiment::kSpeed, "4pt-approx");
  int steps = 0;
  const auto rows = BenchmarkRansac(options, [&] { ++steps; });
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(CountRansacRows(options), 2);
  EXPECT_EQ(steps, 2);
  EXPECT_EQ(rows[0].form, "full");
  EXPECT_EQ(rows[1].form, "prior");
  for (const RansacBenchmarkRow& row : rows) {
    EXPECT_EQ(row.pairs, 10);
    EXPECT_EQ(row.failures, 0);
    EXPECT_EQ(row.num_matches, 626);
    ASSERT_TRUE(row.time_ms && row.success && row.rotation_deg && row.clean_rotation_deg);
    EXPECT_GT(row.time_ms->median, 0.0);
    EXPECT_GE(*row.success, 0.8);
    EXPECT_LT(*row.rotation_deg, 0.1);
    EXPECT_LT(*row.clean_rotation_deg, 0.1);
    EXPECT_NE(*row.rotation_deg, *row.clean_rotation_deg);
    EXPECT_NEAR(*row.efficiency_rotation, 1.0, 0.6);
    EXPECT_NEAR(row.inlier_ratio, 0.7, 0.05);
  }
  // The exact prior leaves two rotational degrees of freedom out.
  EXPECT_LT(*rows[1].rotation_deg, *rows[0].rotation_deg);
}

TEST(RansacBenchmark, SweepKeepsThreeHundredInliers) {
  RansacBenchmarkOptions options = Few(RansacExperiment::kOutliers, "4pt-approx");
  options.pairs = 1;
  const auto rows = BenchmarkRansac(options, {});
  ASSERT_EQ(rows.size(), 8u);
  for (size_t k = 0; k < rows.size(); ++k) {
    EXPECT_NEAR(rows[k].outlier_share, 0.1 * static_cast<double>(k + 1), 2e-3);
    EXPECT_NEAR(rows[k].num_matches * (1.0 - rows[k].outlier_share), 300.0, 1e-9);
  }
}

TEST(RansacBenchmark, AblationNamesItsVariants) {
  RansacBenchmarkOptions options = Few(RansacExperiment::kAblation, "4pt-approx");
  options.pairs = 1;
  const auto rows = BenchmarkRansac(options, {});
  ASSERT_GE(rows.size(), 8u);
  EXPECT_EQ(rows[0].variant, "default");
  EXPECT_NE(rows[1].variant, rows[0].variant);
  EXPECT_DOUBLE_EQ(rows.front().outlier_share, 0.3);
  EXPECT_DOUBLE_EQ(rows.back().outlier_share, 0.7);
}

TEST(RansacBenchmark, FilesWithoutNoiseHaveNoSuccessAndNoPriorNoRow) {
  SceneOptions scene;
  FramePair pair;
  std::string error;
  ASSERT_TRUE(MakeScenePair(scene, 0, &pair, &error)) << error;
  pair.noise_px.reset();
  pair.prior.gravity2.reset();
  RansacBenchmarkOptions options;
  options.experiment = RansacExperiment::kFiles;
  const auto rows = BenchmarkRansacOnFiles(options, {pair});
  std::vector<std::string> solvers;
  for (const RansacBenchmarkRow& row : rows) {
    solvers.push_back(row.solver);
    EXPECT_EQ(row.pairs, 1);
    EXPECT_TRUE(row.rotation_deg.has_value());
    EXPECT_FALSE(row.success.has_value());
    EXPECT_FALSE(row.static_wins.has_value());
  }
  EXPECT_THAT(solvers, testing::ElementsAre("4pt-axis-approx", "17pt-li", "6pt-ventura", "5pt+1"));
}

TEST(RansacBenchmark, JsonLeavesOutWhatDoesNotExist) {
  RansacBenchmarkOptions options;
  RansacBenchmarkRow row;
  row.solver = "4pt";
  row.pairs = row.failures = 1;
  const auto report = nlohmann::json::parse(RansacBenchmarkJson({row}, options));
  EXPECT_EQ(report["format"], "rigel-ransac-benchmark 1");
  EXPECT_EQ(report["experiment"], "speed");
  const auto& entry = report["results"][0];
  EXPECT_EQ(entry["failures"], 1);
  for (const char* key : {"time_ms", "rotation_deg", "success", "missed", "variant"}) {
    EXPECT_FALSE(entry.contains(key)) << key;
  }
}

}  // namespace
}  // namespace rigel
