// Matches in a pose graph of Ceres: Refine() picks the inliers of each pair of frames from a start
// of odometry, and cost functions of single matches then move all poses together.
#include <cstdio>
#include <vector>

#include <ceres/ceres.h>

#include "drive.h"
#include "rigel/refine/epipolar_cost.h"
#include "rigel/refine/refine.h"

namespace {

constexpr int kFrames = 5;

// A node: X_world = R(q) X_body + p, q as w x y z.
struct Node {
  double q[4];
  double p[3];

  rigel::Pose Pose() const {
    return rigel::Pose::FromQuaternion({q[0], q[1], q[2], q[3]}, Eigen::Vector3d(p));
  }
};

// Odometry that turns too little and is 5 percent too long.
rigel::Pose Odometry(int frame1, int frame2) {
  rigel::Pose motion = TrueMotion(frame1, frame2);
  motion.R = rigel::ExpSO3(0.9 * rigel::LogSO3(motion.R));
  motion.t *= 1.05;
  return motion;
}

// The inliers of two frames as residuals of their nodes. False with a message if there is no
// motion.
bool AddMatches(int frame1, int frame2, std::vector<Node>* nodes, ceres::Problem* problem) {
  const rigel::FramePair pair = MatchFrames(frame1, frame2);
  rigel::Pose motion = Odometry(frame1, frame2);
  const rigel::RefineSummary summary =
      rigel::Refine(rigel::RefineOptions(), pair.rig, pair.matches, pair.prior, &motion);
  if (!summary.IsSolutionUsable()) {
    std::printf("frames %d and %d: %s\n", frame1, frame2, summary.message.c_str());
    return false;
  }
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    if (!summary.inliers[k]) continue;
    ceres::CostFunction* cost = rigel::MakeAbsoluteEpipolarCost(
        pair.rig, pair.matches[k], summary.noise_px, rigel::QuaternionOrder::kCeres);
    if (cost == nullptr) return false;  // a camera that is not in the rig, a pixel that is NaN
    Node &a = (*nodes)[frame1], &b = (*nodes)[frame2];
    problem->AddResidualBlock(cost, new ceres::CauchyLoss(2.0), a.q, a.p, b.q, b.p);
  }
  return true;
}

double LastPoseError(const std::vector<Node>& nodes) {
  return (nodes.back().Pose().t - WorldFromFrame(kFrames - 1).t).norm();
}

}  // namespace

int main() {
  // The start: odometry, chained. The poses must not be equal, see epipolar_cost.h.
  std::vector<Node> nodes;
  rigel::Pose world_from_body;
  for (int k = 0; k < kFrames; ++k) {
    if (k > 0) world_from_body = world_from_body * Odometry(k - 1, k).Inverse();
    const auto q = world_from_body.Quaternion();
    const Eigen::Vector3d& p = world_from_body.t;
    nodes.push_back({{q.w(), q.x(), q.y(), q.z()}, {p.x(), p.y(), p.z()}});
  }
  const double before = LastPoseError(nodes);

  // Each frame with the next two.
  ceres::Problem problem;
  for (int k = 0; k < kFrames; ++k) {
    for (int next = k + 1; next < kFrames && next <= k + 2; ++next) {
      if (!AddMatches(k, next, &nodes, &problem)) return 1;
    }
  }
  for (Node& node : nodes) problem.SetManifold(node.q, new ceres::QuaternionManifold);
  problem.SetParameterBlockConstant(nodes[0].q);
  problem.SetParameterBlockConstant(nodes[0].p);

  ceres::Solver::Summary summary;
  ceres::Solve(ceres::Solver::Options(), &problem, &summary);
  const double after = LastPoseError(nodes);
  std::printf("last pose: %.3f m off by odometry, %.3f m by %d matches\n", before, after,
              problem.NumResidualBlocks());
  return summary.IsSolutionUsable() && after < 0.05 && after < before ? 0 : 1;
}
