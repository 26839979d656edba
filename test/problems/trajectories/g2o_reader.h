// Reads a pose graph as g2o does, but refuses what g2o would let pass.
#ifndef RIGEL_TEST_PROBLEMS_TRAJECTORIES_G2O_READER_H_
#define RIGEL_TEST_PROBLEMS_TRAJECTORIES_G2O_READER_H_

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "rigel/core/pose.h"

namespace rigel {

struct G2oGraph {
  struct Edge {
    int from = -1;
    int to = -1;
    Pose measurement;
    Eigen::Matrix<double, 6, 6> information;
  };
  std::vector<Pose> vertices;  // world_from_body, by id
  std::vector<Edge> edges;
  std::vector<std::string> comments;
};

// Expects ids 0, 1, ..., vertices before edges, unit quaternions, 21 numbers of information that
// are positive semidefinite, one edge at most into and out of each vertex, from a vertex to the
// next, vertices that the edges lead to, and at least one edge a vertex.
inline G2oGraph ParseG2o(const std::string& text) {
  G2oGraph graph;
  EXPECT_TRUE(text.empty() || text.back() == '\n');
  std::istringstream lines(text);
  std::string line;
  const auto read_pose = [&](std::istringstream* row) {
    Pose pose;
    Eigen::Quaterniond q;
    *row >> pose.t.x() >> pose.t.y() >> pose.t.z() >> q.x() >> q.y() >> q.z() >> q.w();
    EXPECT_NEAR(q.norm(), 1.0, 1e-14) << line;
    return Pose::FromQuaternion(q, pose.t);
  };
  while (std::getline(lines, line)) {
    if (line.substr(0, 2) == "# ") {
      graph.comments.push_back(line.substr(2));
      continue;
    }
    std::istringstream row(line);
    std::string tag;
    row >> tag;
    if (tag == "VERTEX_SE3:QUAT") {
      int id = -1;
      row >> id;
      EXPECT_EQ(id, static_cast<int>(graph.vertices.size())) << line;
      EXPECT_TRUE(graph.edges.empty()) << "vertex after an edge: " << line;
      graph.vertices.push_back(read_pose(&row));
    } else if (tag == "EDGE_SE3:QUAT") {
      G2oGraph::Edge edge;
      row >> edge.from >> edge.to;
      edge.measurement = read_pose(&row);
      for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) {
          row >> edge.information(i, j);
          edge.information(j, i) = edge.information(i, j);
        }
      }
      graph.edges.push_back(edge);
    } else {
      ADD_FAILURE() << "unknown tag: " << line;
    }
    EXPECT_FALSE(row.fail()) << "numbers are missing: " << line;
    std::string more;
    EXPECT_FALSE(row >> more) << "more than there should be: " << line;
  }
  std::vector<bool> connected(graph.vertices.size(), false);
  int last = 0;
  for (const G2oGraph::Edge& edge : graph.edges) {
    EXPECT_EQ(edge.to, edge.from + 1);
    EXPECT_GE(edge.from, last);
    last = edge.to;
    if (edge.from < 0 || edge.to >= static_cast<int>(graph.vertices.size())) {
      ADD_FAILURE() << "edge between vertices that are not there: " << edge.from << " " << edge.to;
      continue;
    }
    connected[edge.from] = connected[edge.to] = true;
    const Pose to = graph.vertices[edge.from] * edge.measurement;
    EXPECT_LT((to.R - graph.vertices[edge.to].R).norm(), 1e-12);
    EXPECT_LT((to.t - graph.vertices[edge.to].t).norm(), 1e-12 * (1.0 + to.t.norm()));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(edge.information);
    EXPECT_GT(eigen.eigenvalues()(5), 0.0);
    EXPECT_GT(eigen.eigenvalues()(0), -1e-12 * eigen.eigenvalues()(5));
  }
  for (size_t k = 0; k < connected.size(); ++k) EXPECT_TRUE(connected[k]) << "no edge: " << k;
  return graph;
}

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_TRAJECTORIES_G2O_READER_H_
