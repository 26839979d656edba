// Motions as between factors: g2o's file on stdout, and how GTSAM takes the same.
//
// Every second pair has no match between cameras, so that |t| is not determined: the back end gets
// a length from odometry and no information along it.
#include <cstdio>

#include "drive.h"
#include "rigel/refine/between_factor.h"
#include "rigel/refine/estimate_motion.h"

namespace {

constexpr int kFrames = 5;
constexpr double kOdometryLength = 1.0;  // metres a frame

void PrintEdge(int frame1, int frame2, const rigel::BetweenFactor& edge) {
  const auto q = edge.measurement.Quaternion();
  const Eigen::Vector3d& t = edge.measurement.t;
  std::printf("EDGE_SE3:QUAT %d %d %.9f %.9f %.9f %.9f %.9f %.9f %.9f", frame1, frame2, t.x(),
              t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      std::printf(" %.6g", edge.information(row, column));
    }
  }
  std::printf("\n");
}

// The error of the measurement in g2o's perturbation (v, h), squared, in sigmas.
double SquaredSigmas(const rigel::BetweenFactor& edge, const rigel::Pose& f2_from_f1) {
  const rigel::Pose error = edge.measurement.Inverse() * f2_from_f1.Inverse();
  rigel::Vector6d e;
  e << error.t, error.Quaternion().vec();
  return e.dot(edge.information * e);
}

}  // namespace

int main() {
  bool good = true;
  for (int k = 0; k + 1 < kFrames; ++k) {
    const rigel::FramePair pair = MatchFrames(k, k + 1, k % 2 == 0);
    rigel::MotionEstimate estimate = rigel::EstimateMotion(rigel::EstimateOptions(), pair);
    if (!estimate.HasMotion()) return 1;
    if (!estimate.refine.scale_observable) {
      rigel::SetUndeterminedLength(kOdometryLength, &estimate.pose, &estimate.refine);
    }
    const rigel::BetweenFactor edge = rigel::G2oEdge(estimate.pose, estimate.refine);
    PrintEdge(k, k + 1, edge);

    // GTSAM: BetweenFactor<Pose3>(k, k + 1, Pose3(gtsam.measurement), noise) with
    //   noise = noiseModel::Gaussian::SqrtInformation(SqrtInformation(gtsam.information), false)
    const rigel::BetweenFactor gtsam = rigel::GtsamBetweenFactor(estimate.pose, estimate.refine);
    const rigel::Matrix6d S = rigel::SqrtInformation(gtsam.information);
    good &= (S.transpose() * S - gtsam.information).norm() < 1e-6 * gtsam.information.norm();

    // 99.9 percent of errors of six degrees of freedom are below 22.5.
    good &= SquaredSigmas(edge, TrueMotion(k, k + 1)) < 22.5;
    good &= estimate.refine.scale_observable == (k % 2 == 0);
  }
  return good ? 0 : 1;
}
