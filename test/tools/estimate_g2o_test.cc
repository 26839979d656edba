// rigel_estimate --g2o: the graph of the files, against the JSON of the same run.
#include <string>
#include <vector>

#include <Eigen/LU>

#include "rigel/test/problems/trajectories/g2o_reader.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

Pose PoseOf(const Json& motion) {
  const std::vector<double> q = motion["q_wxyz"];
  const std::vector<double> t = motion["t"];
  return Pose::FromQuaternion(Eigen::Quaterniond(q.at(0), q.at(1), q.at(2), q.at(3)),
                              Eigen::Vector3d(t.at(0), t.at(1), t.at(2)));
}

class EstimateG2oTest : public ToolsTest {
 protected:
  // Inserts a header line into file `index` of the directory.
  void AddLine(const std::string& directory, int index, const std::string& line) {
    const std::string path = directory + "/00000" + std::to_string(index) + ".matches";
    const std::string text = ReadText(path);
    WriteText(path, "format rigmatch 1\n" + line + "\n" + text.substr(text.find('\n') + 1));
  }
};

TEST_F(EstimateG2oTest, GraphHasTheMotionsOfTheJson) {
  const std::string matches = Simulate("in", {"--pairs=4", "--inter_share=0.5"});
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--g2o=-",
                                           "--json=" + Path("json"), "--csv=" + Path("csv")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, IsEmpty());
  const G2oGraph graph = ParseG2o(run.out);
  EXPECT_THAT(graph.comments, IsEmpty());
  ASSERT_THAT(graph.vertices, SizeIs(5));
  ASSERT_THAT(graph.edges, SizeIs(4));
  // t = (0, 0, 1): the body goes back by a metre a pair.
  EXPECT_NEAR(graph.vertices[4].t.z(), -4.0, 0.2);
  const Json report = ParseReport(ReadText(Path("json")));
  EXPECT_FALSE(report["options"].contains("g2o"));
  for (int k = 0; k < 4; ++k) {
    const Pose pose = PoseOf(report["pairs"][k]["refined"]);
    const Pose inverse = pose.Inverse();
    const G2oGraph::Edge& edge = graph.edges[k];
    EXPECT_LT((edge.measurement.t - inverse.t).norm(), 1e-14);
    EXPECT_LT((edge.measurement.R - inverse.R).norm(), 1e-14);
    // h'Ah of g2o's rotation block is that of the whole over all translations: the Schur
    // complement is the inverse of the rotation's covariance, in half angles.
    const Eigen::Matrix3d tt = edge.information.block<3, 3>(0, 0);
    const Eigen::Matrix3d tr = edge.information.block<3, 3>(0, 3);
    const Eigen::Matrix3d rr = edge.information.block<3, 3>(3, 3);
    const Eigen::Matrix3d marginal = 0.25 * (rr - tr.transpose() * tt.inverse() * tr);
    Eigen::Matrix3d rotation;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation(i, j) = report["pairs"][k]["covariance"][i][j];
    }
    EXPECT_LT((marginal * rotation - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  }
}

TEST_F(EstimateG2oTest, FileAndTableGoTogether) {
  const std::string matches = Simulate("in", {"--pairs=2", "--num_matches=60"});
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--g2o=" + Path("graph.g2o")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.out, HasSubstr("-----"));
  // Without matches between cameras nothing says |t|: it has no information.
  const G2oGraph graph = ParseG2o(ReadText(Path("graph.g2o")));
  ASSERT_THAT(graph.edges, SizeIs(2));
  EXPECT_THAT(graph.comments, ElementsAre(HasSubstr("|t| is not determined in 2 of 2 edges")));
  for (const G2oGraph::Edge& edge : graph.edges) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(edge.information);
    EXPECT_NEAR(edge.measurement.t.norm(), 1.0, 1e-14);
    EXPECT_LT(eigen.eigenvalues()(0), 1e-12 * eigen.eigenvalues()(5));
    EXPECT_GT(eigen.eigenvalues()(1), 1e-9 * eigen.eigenvalues()(5));
  }
}

TEST_F(EstimateG2oTest, GapsAndFailuresEndTrajectoriesAndAreTold) {
  const std::string matches = Simulate("in", {"--pairs=7", "--inter_share=0.5"});
  AddLine(matches, 0, "time 0 1");
  AddLine(matches, 1, "time 1 2");
  AddLine(matches, 2, "time 3 4");  // a gap before it
  const std::string text = ReadText(matches + "/000004.matches");
  WriteText(matches + "/000004.matches", text.substr(0, text.find("matches ")) + "matches 0\n");
  WriteText(matches + "/000005.matches", "broken\n");
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--g2o=-"});
  EXPECT_EXIT_CODE(run, 1);  // one could not be read
  const G2oGraph graph = ParseG2o(run.out);
  EXPECT_THAT(graph.vertices, SizeIs(8));  // 0-1, 2-3, 6
  ASSERT_THAT(graph.edges, SizeIs(5));
  EXPECT_THAT(
      graph.comments,
      ElementsAre(
          HasSubstr("000002.matches: starts at 3 s, the pair before ends at 2 s: the trajectory"),
          HasSubstr("000004.matches: too few matches: no edge, the trajectory ends at vertex 5")));
  for (const std::string& comment : graph.comments) {
    EXPECT_THAT(run.err, HasSubstr("--g2o: " + comment + "\n"));
  }
}

TEST_F(EstimateG2oTest, FileThatCannotBeReadIsAGap) {
  const std::string matches = Simulate("in", {"--pairs=3", "--inter_share=0.5"});
  WriteText(matches + "/000001.matches", "broken\n");
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--g2o=-"});
  EXPECT_EXIT_CODE(run, 1);
  const G2oGraph graph = ParseG2o(run.out);
  EXPECT_THAT(graph.vertices, SizeIs(4));
  EXPECT_THAT(graph.comments, ElementsAre(AllOf(HasSubstr("000002.matches: a pair is missing"),
                                                HasSubstr("at vertex 1"))));
}

}  // namespace
}  // namespace rigel
