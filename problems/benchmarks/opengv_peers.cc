#include "rigel/problems/benchmarks/opengv_peers.h"

#ifdef RIGEL_WITH_OPENGV

#include <chrono>
#include <cmath>
#include <memory>

#include <opengv/relative_pose/NoncentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/relative_pose/NoncentralRelativePoseSacProblem.hpp>
#endif

namespace rigel {

#ifdef RIGEL_WITH_OPENGV
namespace {

// OpenGV's data of a sample: every match gets cameras of its own, turned into the body frame.
struct OpenGvSample {
  opengv::bearingVectors_t bearings1, bearings2;
  std::vector<int> cameras1, cameras2;
  opengv::translations_t offsets;
  opengv::rotations_t rotations;

  OpenGvSample(const PreparedMatches& matches, const int* sample, int size) {
    for (int k = 0; k < size; ++k) Add(matches.rays(sample[k]));
  }
  explicit OpenGvSample(const GroupedMatches& matches) {
    for (int k = 0; k < matches.size(); ++k) Add(matches.rays(k));
  }

 private:
  void Add(const RayPair& rays) {
    const int k = static_cast<int>(bearings1.size());
    bearings1.push_back(rays.ray1.x);
    bearings2.push_back(rays.ray2.x);
    cameras1.push_back(2 * k);
    cameras2.push_back(2 * k + 1);
    for (const Eigen::Vector3d& s : {rays.ray1.s, rays.ray2.s}) {
      offsets.push_back(s);
      rotations.push_back(Eigen::Matrix3d::Identity());
    }
  }
};

// Its motions are f1_from_f2.
int SolveOpenGvSixpt(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const OpenGvSample data(matches, sample, 6);
  const opengv::relative_pose::NoncentralRelativeAdapter adapter(
      data.bearings1, data.bearings2, data.cameras1, data.cameras2, data.offsets, data.rotations);
  for (const Eigen::Matrix3d& R : opengv::relative_pose::sixpt(adapter)) {
    Solution& solution = solutions->Append();
    solution.R = R.transpose();
    solution.t.setZero();
    solution.has_scale = false;
  }
  return solutions->size();
}

int SolveOpenGvSeventeenpt(const PreparedMatches& matches, const int* sample,
                           Solutions* solutions) {
  solutions->clear();
  const OpenGvSample data(matches, sample, 17);
  const opengv::relative_pose::NoncentralRelativeAdapter adapter(
      data.bearings1, data.bearings2, data.cameras1, data.cameras2, data.offsets, data.rotations);
  const opengv::transformation_t T = opengv::relative_pose::seventeenpt(adapter);
  Solution& solution = solutions->Append();
  solution.R = T.leftCols<3>().transpose();
  solution.t = -solution.R * T.col(3);
  solution.has_scale = true;
  return solutions->size();
}

}  // namespace

bool RefineWithOpenGv(const GroupedMatches& matches, Pose* pose) {
  const OpenGvSample data(matches);
  opengv::relative_pose::NoncentralRelativeAdapter adapter(
      data.bearings1, data.bearings2, data.cameras1, data.cameras2, data.offsets, data.rotations,
      -pose->R.transpose() * pose->t, pose->R.transpose());
  const opengv::transformation_t T = opengv::relative_pose::optimize_nonlinear(adapter);
  pose->R = T.leftCols<3>().transpose();
  pose->t = -pose->R * T.col(3);
  return pose->AllFinite();
}

bool EstimateWithOpenGv(const std::string& peer, const RansacOptions& options,
                        const FramePair& pair, OpenGvEstimate* estimate) {
  using Problem = opengv::sac_problems::relative_pose::NoncentralRelativePoseSacProblem;
  using Clock = std::chrono::steady_clock;
  const auto milliseconds = [](Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
  };
  const bool sixpt = peer == "opengv-sixpt";
  if (!sixpt && peer != "opengv-seventeenpt") return false;
  const auto start = Clock::now();
  const OpenGvSample data(GroupedMatches(pair.rig, pair.matches));
  opengv::relative_pose::NoncentralRelativeAdapter adapter(
      data.bearings1, data.bearings2, data.cameras1, data.cameras2, data.offsets, data.rotations);
  opengv::sac::Ransac<Problem> ransac;
  ransac.sac_model_ = std::make_shared<Problem>(
      adapter, sixpt ? Problem::SIXPT : Problem::SEVENTEENPT, /*asCentral=*/false,
      /*randomSeed=*/false);
  // Its error is the sum over both views of 1 - cos of the angle.
  ransac.threshold_ = 1.0 - std::cos(ThresholdPx(options.threshold_px, pair.rig) /
                                     pair.rig.cameras[0].intrinsics.PixelsPerRadian().x());
  ransac.max_iterations_ = options.max_iterations;
  ransac.probability_ = options.confidence;
  if (!ransac.computeModel()) return false;
  const auto found = Clock::now();
  opengv::transformation_t T = ransac.model_coefficients_;
  ransac.sac_model_->optimizeModelCoefficients(ransac.inliers_, ransac.model_coefficients_, T);
  const auto refined = Clock::now();
  // f1_from_f2.
  estimate->pose.R = T.leftCols<3>().transpose();
  estimate->pose.t = -estimate->pose.R * T.col(3);
  estimate->num_inliers = static_cast<int>(ransac.inliers_.size());
  estimate->iterations = ransac.iterations_;
  estimate->ransac_ms = milliseconds(start, found);
  estimate->refine_ms = milliseconds(found, refined);
  return estimate->pose.AllFinite();
}
#else
bool RefineWithOpenGv(const GroupedMatches& /*matches*/, Pose* /*pose*/) { return false; }
bool EstimateWithOpenGv(const std::string& /*peer*/, const RansacOptions& /*options*/,
                        const FramePair& /*pair*/, OpenGvEstimate* /*estimate*/) {
  return false;
}
#endif

const std::vector<SolverInfo>& OpenGvPeers() {
  static const std::vector<SolverInfo> peers = {
#ifdef RIGEL_WITH_OPENGV
      {"opengv-sixpt", 6, PriorKind::kNone, 64, true, SampleKind::kSpread, &SolveOpenGvSixpt,
       "OpenGV (Kneip, Furgale, ICRA 2014)"},
      {"opengv-seventeenpt", 17, PriorKind::kNone, 1, true, SampleKind::kSpread,
       &SolveOpenGvSeventeenpt, "OpenGV (Kneip, Furgale, ICRA 2014)"},
#endif
  };
  return peers;
}

}  // namespace rigel
