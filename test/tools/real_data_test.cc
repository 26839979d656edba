// The programs on real match files, which are no part of the project: skipped where the environment
// variable RIGEL_REAL_DATA does not name them.
#include <cstdlib>
#include <string>
#include <vector>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/test/problems/trajectories/g2o_reader.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::HasSubstr;

class RealDataTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RIGEL_REAL_DATA");
    if (folder == nullptr || *folder == '\0') {
      GTEST_SKIP() << "RIGEL_REAL_DATA is not set: no real match files to test with";
    }
    folder_ = folder;
  }

  std::string folder_;
};

TEST_F(RealDataTest, StandingStillIsReportedAsSuch) {
  for (const char* solver : {"--solver=4pt-axis", "--solver=4pt"}) {
    const Args args = {"--matches=" + folder_ + "/euroc_still", "--prior=body", solver};
    const Outcome table = RunTool("estimate", args);
    EXPECT_EXIT_CODE(table, 0);
    int lines = 0;
    for (const std::string& line : Lines(table.out)) {
      if (line.find("|t| is consistent with zero: ") != std::string::npos) ++lines;
    }
    EXPECT_EQ(lines, 8) << table.out;

    const Outcome run = RunTool("estimate", args + Args{"--json=-"});
    EXPECT_EXIT_CODE(run, 0);
    const Json report = ParseReport(run.out);
    ASSERT_EQ(report["pairs"].size(), 8u);
    for (const Json& pair : report["pairs"]) {
      EXPECT_EQ(pair["status"], "ok") << pair["pair"];
      ASSERT_TRUE(pair.contains("translation_observable")) << pair["pair"];
      EXPECT_FALSE(pair["translation_observable"].get<bool>()) << pair["pair"];
      EXPECT_FALSE(pair.contains("translation_dir_sd_deg")) << pair["pair"];
    }
  }
}

TEST_F(RealDataTest, StandingStillHasNoDirectionErrors) {
  const Outcome run = RunTool("compare", {"--matches=" + folder_ + "/euroc_still", "--prior=body",
                                          "--solvers=4pt-axis", "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  const Json entry = ParseReport(run.out)["results"][0];
  EXPECT_EQ(entry["pairs"], 8);
  EXPECT_EQ(entry["failures"], 0);
  EXPECT_EQ(entry["direction_pairs"], 0);
  for (const char* stage : {"raw", "refined"}) {
    EXPECT_FALSE(entry[stage].contains("translation_dir_deg"));
    EXPECT_FALSE(entry[stage].contains("scale"));
  }
}

TEST_F(RealDataTest, DrivingIsAsAccurateAsTheBestPublicEstimator) {
  // The medians of PoseLib 3.0 on these files, README.md beside them.
  const Outcome run =
      RunTool("compare", {"--matches=" + folder_ + "/kitti_stereo_06", "--prior=body",
                          "--solvers=4pt-axis", "--threads=2", "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  const Json entry = ParseReport(run.out)["results"][0];
  EXPECT_EQ(entry["pairs"], 50);
  EXPECT_EQ(entry["failures"], 0);
  EXPECT_LE(entry["refined"]["rotation_deg"]["median"], 0.0340 * 1.05);
  EXPECT_LE(entry["refined"]["translation_dir_deg"]["median"], 0.258 * 1.05);
  EXPECT_LE(entry["refined"]["scale"]["median"], 0.0030 * 1.1);
}

TEST_F(RealDataTest, ReportIsTheSameForAnyNumberOfThreads) {
  for (const char* tool : {"compare", "estimate"}) {
    std::string first;
    for (const char* threads : {"--threads=1", "--threads=2", "--threads=8"}) {
      Args args = {"--matches=" + folder_ + "/kitti_stereo_06", "--prior=body", "--no_times",
                   "--json=-", threads};
      if (tool == std::string("compare"))
        args = args + Args{"--solvers=4pt-axis,3pt", "--per_pair"};
      const Outcome run = RunTool(tool, args);
      EXPECT_EXIT_CODE(run, 0);
      if (first.empty()) first = run.out;
      EXPECT_EQ(run.out, first) << run.command;
    }
  }
}

TEST_F(RealDataTest, PoseGraphOfADriveEndsNearTheTruth) {
  const Outcome run =
      RunTool("estimate", {"--matches=" + folder_ + "/kitti_stereo_06", "--prior=body", "--g2o=-"});
  EXPECT_EXIT_CODE(run, 0);
  const G2oGraph graph = ParseG2o(run.out);
  EXPECT_THAT(graph.comments, testing::IsEmpty());
  std::vector<std::string> errors;
  const std::vector<std::string> paths = ListMatchFiles(folder_ + "/kitti_stereo_06", &errors);
  ASSERT_EQ(graph.edges.size(), paths.size());
  Pose last_from_first;
  double length = 0.0;
  for (const std::string& path : paths) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    ASSERT_TRUE(pair.truth.has_value());
    last_from_first = *pair.truth * last_from_first;
    length += pair.truth->t.norm();
  }
  const Pose off = last_from_first * graph.vertices.back();
  // Measured: 0.35 m of 60 m, 0.021 rad, a bias of 0.02 degrees a pair against KITTI's truth.
  EXPECT_LT(off.t.norm(), 0.01 * length);
  EXPECT_LT(LogSO3(off.R).norm(), 0.03);
  RecordProperty("end_error_m", std::to_string(off.t.norm()));
  RecordProperty("end_error_rad", std::to_string(LogSO3(off.R).norm()));
  RecordProperty("length_m", std::to_string(length));
}

TEST_F(RealDataTest, PoseGraphOfStandingStillHasEdgesOfNoTranslation) {
  const Outcome run =
      RunTool("estimate", {"--matches=" + folder_ + "/euroc_still", "--prior=body", "--g2o=-"});
  EXPECT_EXIT_CODE(run, 0);
  const G2oGraph graph = ParseG2o(run.out);
  // Eight pairs of a clip with gaps between them.
  EXPECT_EQ(graph.edges.size(), 8u);
  for (const G2oGraph::Edge& edge : graph.edges) EXPECT_LT(edge.measurement.t.norm(), 0.01);
}

}  // namespace
}  // namespace rigel
