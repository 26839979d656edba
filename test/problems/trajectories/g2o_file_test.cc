// Pose graphs of g2o: what is chained, where a trajectory ends, and that all numbers survive.
#include "rigel/problems/trajectories/g2o_file.h"

#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/random.h"
#include "rigel/core/rig_centre.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/between_factor.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/problems/trajectories/g2o_reader.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

// Pairs "0", "1", ... with motions and covariances of any kind.
struct Drive {
  std::vector<FramePair> pairs;
  std::vector<MotionEstimate> estimates;
  std::vector<int> positions;
  std::vector<std::string> notes;

  G2oGraph Graph() {
    notes.clear();
    const G2oGraph graph = ParseG2o(FormatG2o(pairs, estimates, positions, &notes));
    EXPECT_EQ(graph.comments, notes);
    return graph;
  }
};

Drive RandomDrive(int size) {
  Drive drive;
  Random random(1);
  for (int k = 0; k < size; ++k) {
    FramePair pair;
    pair.name = std::to_string(k);
    drive.pairs.push_back(pair);
    MotionEstimate e;
    e.status = EstimateStatus::kSuccess;
    e.pose.R = ExpSO3(RandomVector3(0.0, 1.0, &random));
    e.pose.t = random.NormalVector3();
    Matrix6d root;
    for (int c = 0; c < 6; ++c) root.col(c) << random.NormalVector3(), random.NormalVector3();
    e.refine.termination = Termination::kConverged;
    e.refine.covariance = 1e-4 * root * root.transpose();
    e.refine.length_sigma = 0.01;
    e.refine.rotation_observable = true;
    e.refine.translation_observable = true;
    e.refine.scale_observable = true;
    drive.estimates.push_back(e);
  }
  return drive;
}

TEST(G2oFile, ChainsTheMotionsAndKeepsEveryDigit) {
  Drive drive = RandomDrive(20);
  const G2oGraph graph = drive.Graph();
  EXPECT_THAT(drive.notes, IsEmpty());
  ASSERT_THAT(graph.vertices, SizeIs(21));
  ASSERT_THAT(graph.edges, SizeIs(20));
  EXPECT_EQ(graph.vertices[0].t.norm(), 0.0);
  EXPECT_EQ(graph.vertices[0].R, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  // The last frame from the first, X_last = R X_first + t.
  Pose last_from_first;
  for (const MotionEstimate& e : drive.estimates) last_from_first = e.pose * last_from_first;
  const Pose expected = last_from_first.Inverse();
  EXPECT_LT((graph.vertices[20].t - expected.t).norm(), 1e-12);
  EXPECT_LT((graph.vertices[20].R - expected.R).norm(), 1e-12);
  for (int k = 0; k < 20; ++k) {
    const BetweenFactor edge = G2oEdge(drive.estimates[k].pose, drive.estimates[k].refine);
    EXPECT_EQ(graph.edges[k].information, edge.information);
    EXPECT_EQ(graph.edges[k].measurement.t, edge.measurement.t);
    EXPECT_LT((graph.edges[k].measurement.R - edge.measurement.R).norm(), 1e-15);
  }
}

TEST(G2oFile, PairWithoutAnEdgeEndsTheTrajectory) {
  Drive drive = RandomDrive(9);
  drive.estimates[0].status = EstimateStatus::kNoSolution;
  drive.estimates[3].refine.translation_observable = false;
  drive.estimates[4].refine.rotation_observable = false;
  drive.estimates[6].refine.termination = Termination::kDegenerate;
  drive.estimates[8].refine.covariance.reset();
  const G2oGraph graph = drive.Graph();
  // 1-2, 5, 7.
  ASSERT_THAT(graph.vertices, SizeIs(7));
  ASSERT_THAT(graph.edges, SizeIs(4));
  for (const int start : {0, 3, 5}) {
    EXPECT_EQ(graph.vertices[start].t.norm(), 0.0);
    EXPECT_EQ(graph.vertices[start].R, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  }
  EXPECT_EQ(graph.edges[2].from, 3);
  EXPECT_EQ(graph.edges[3].from, 5);
  EXPECT_THAT(
      drive.notes,
      ElementsAre(
          "0: no solution: no edge",
          "3: direction of translation not observable: no edge, the trajectory ends at vertex 2",
          "4: rotation not observable: no edge",
          "6: no refined motion: no edge, the trajectory ends at vertex 4",
          "8: no refined motion: no edge, the trajectory ends at vertex 6"));
}

TEST(G2oFile, GapStartsANewTrajectory) {
  Drive drive = RandomDrive(5);
  const double times[] = {0, 1, 2.5, 3.5, 4.5};
  for (int k = 0; k < 5; ++k) {
    drive.pairs[k].time1 = times[k];
    drive.pairs[k].time2 = times[k] + 1;
  }
  drive.pairs[3].time1 = 3.5 + 1e-7;  // the same but for its last digits
  G2oGraph graph = drive.Graph();
  EXPECT_THAT(graph.vertices, SizeIs(7));
  EXPECT_THAT(drive.notes, ElementsAre("2: starts at 2.5 s, the pair before ends at 2 s: the "
                                       "trajectory ended before it, at vertex 2"));

  // One that states no times is taken as the next.
  drive.pairs[2].time1.reset();
  drive.pairs[2].time2.reset();
  graph = drive.Graph();
  EXPECT_THAT(graph.vertices, SizeIs(6));
  EXPECT_THAT(drive.notes, IsEmpty());

  drive.positions = {0, 1, 2, 3, 5};
  graph = drive.Graph();
  EXPECT_THAT(graph.vertices, SizeIs(7));
  EXPECT_THAT(drive.notes, ElementsAre(StartsWith("4: a pair is missing before it: ")));

  drive.positions.clear();
  drive.pairs[3].sequence = drive.pairs[4].sequence = "second";
  graph = drive.Graph();
  EXPECT_THAT(graph.vertices, SizeIs(7));
  EXPECT_THAT(drive.notes, ElementsAre(StartsWith("3: another sequence: ")));
}

// The information of the rotation and of the direction of t, whatever the length: 5 x 5.
Eigen::Matrix<double, 5, 5> DirectionInformation(const G2oGraph::Edge& edge) {
  const Pose pose = edge.measurement.Inverse();
  MotionBasis basis = FullBasis(pose, false);
  basis.bottomRows<3>() *= pose.t.norm();
  const Matrix6d J = G2oJacobian(pose);
  return basis.transpose() * J.transpose() * edge.information * J * basis;
}

TEST(G2oFile, EdgesWithoutScaleHaveAStatedOrUnitLength) {
  Drive drive = RandomDrive(5);
  // The relative standard deviation of the length: independent of the rest, for simplicity.
  const auto drop_scale = [&](int k, double length, double sigma) {
    MotionEstimate& e = drive.estimates[k];
    const Matrix6d information = PseudoInformation(*e.refine.covariance);
    e.pose.t *= length / e.pose.t.norm();
    Matrix6d covariance;
    ASSERT_TRUE(CovarianceOfBasis(information, FullBasis(e.pose, false), &covariance));
    Vector6d along = Vector6d::Zero();
    along.tail<3>() = sigma * e.pose.t;
    e.refine.covariance = covariance + along * along.transpose();
    e.refine.length_sigma = sigma;
    e.refine.scale_observable = false;
    e.refine.relative_scale_sigma = std::numeric_limits<double>::infinity();
  };
  drop_scale(0, 5.0, 0.3);  // roughly known
  drop_scale(1, 5.0, 0.6);
  drop_scale(2, 100.0, 1.0);
  drop_scale(3, 100.0, 1.0);
  drive.pairs[3].prior.distance = 2.5;
  const G2oGraph graph = drive.Graph();
  const double lengths[] = {5.0, 1.0, 1.0, 2.5, drive.estimates[4].pose.t.norm()};
  for (int k = 0; k < 5; ++k) {
    const G2oGraph::Edge& edge = graph.edges[k];
    EXPECT_NEAR(edge.measurement.t.norm(), lengths[k], 1e-13);
    if (k == 4) continue;
    Eigen::Matrix<double, 6, 1> along = Eigen::Matrix<double, 6, 1>::Zero();
    along.tail<3>() = edge.measurement.Inverse().t;
    along = G2oJacobian(edge.measurement.Inverse()) * along;
    if (k == 0) {
      // As roughly as it is known.
      EXPECT_NEAR(along.dot(edge.information * along), 1.0 / (0.3 * 0.3), 1e-6);
    } else {
      EXPECT_LT((edge.information * along).norm(), 1e-13 * edge.information.norm());
    }
    // The rest is as it was at the length of the estimate.
    G2oGraph::Edge before;
    const BetweenFactor factor = G2oEdge(drive.estimates[k].pose, drive.estimates[k].refine);
    before.measurement = factor.measurement;
    before.information = factor.information;
    const auto expected = DirectionInformation(before).eval();
    EXPECT_LT((DirectionInformation(edge) - expected).norm(), 1e-6 * expected.norm()) << k;
  }
  EXPECT_THAT(drive.notes,
              ElementsAre("|t| is not determined in 3 of 5 edges and has no information: 1 have "
                          "the distance of their file, 2 are of 1 m"));
}

// A red light.
TEST(G2oFile, AStandingPairHasAnEdge) {
  for (const bool known : {true, false}) {
    Drive drive = RandomDrive(4);
    MotionEstimate& e = drive.estimates[1];
    const Eigen::Vector3d point(1.5, 0.0, 0.3);
    e.pose = MotionOfBody({ExpSO3({1e-4, 2e-4, 0}), {0, 0, 1e-6}}, point);
    e.refine.rig_center = point;
    e.refine.translation_observable = e.refine.scale_observable = false;
    e.refine.parallax_px = 0.5;
    e.refine.parallax_limit_px = 1.0;
    e.refine.relative_scale_sigma = known ? 1e4 : std::numeric_limits<double>::infinity();
    const G2oGraph graph = drive.Graph();
    ASSERT_THAT(graph.vertices, SizeIs(5));
    ASSERT_THAT(graph.edges, SizeIs(4));
    EXPECT_THAT(drive.notes,
                ElementsAre(HasSubstr("stands still in 1 of 4 edges, which have no translation")));
    const Pose motion = graph.edges[1].measurement.Inverse();
    EXPECT_LT(MotionOfPoint(motion, point).t.norm(), 1e-15);
    EXPECT_LT((motion.R - e.pose.R).norm(), 1e-15);
    const Matrix6d J = G2oJacobian(motion);
    const Matrix6d information = J.transpose() * graph.edges[1].information * J;
    Matrix6d expected = PseudoInformation(*e.refine.covariance);
    if (!known) {
      // Of the rotation that of its marginal, of the centre a centimetre.
      Matrix6d covariance = Matrix6d::Zero();
      covariance.topLeftCorner<3, 3>() = e.refine.covariance->topLeftCorner<3, 3>();
      covariance.diagonal().tail<3>().setConstant(1e-4);
      const Matrix6d to_body = BodyFromPointJacobian(motion.R, point);
      expected = PseudoInformation(to_body * covariance * to_body.transpose());
    }
    EXPECT_LT((information - expected).norm(), 1e-6 * expected.norm()) << known;
  }
}

TEST(G2oFile, NothingToChainIsAnEmptyGraph) {
  Drive drive = RandomDrive(1);
  drive.estimates[0].status = EstimateStatus::kTooFewMatches;
  drive.pairs[0].name = "a\nVERTEX_SE3:QUAT 0";
  const G2oGraph graph = drive.Graph();
  EXPECT_THAT(graph.vertices, IsEmpty());
  EXPECT_THAT(drive.notes, ElementsAre(AllOf(StartsWith("a\\x0aVERTEX"), HasSubstr("no edge"))));
  EXPECT_THAT(Drive().Graph().vertices, IsEmpty());
}

}  // namespace
}  // namespace rigel
