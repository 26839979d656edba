// EstimateMotion() and Refine() with options, pair and prior made from the bytes: sensible values,
// and any double, any integer, any enum value and cameras that are not there among them. What comes
// back says that it failed, or holds a finite motion.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "rigel/minimal/catalogue.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/fuzz/fuzz.h"

namespace {

using rigel::fuzz::Bytes;
using rigel::fuzz::Require;

Eigen::Vector3d Direction(Bytes* bytes) {
  Eigen::Vector3d v;
  for (int k = 0; k < 3; ++k) v[k] = bytes->Double(-1, 1);
  // Most of unit length, so that they are used at all.
  return bytes->Chance(230) && v.norm() > 0 && v.allFinite() ? Eigen::Vector3d(v.normalized()) : v;
}

Eigen::Matrix3d Rotation(Bytes* bytes) {
  Eigen::Quaterniond q(1, bytes->Uniform(-1, 1), bytes->Uniform(-1, 1), bytes->Uniform(-1, 1));
  if (bytes->Chance(128)) q = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d R = q.normalized().toRotationMatrix();
  if (bytes->Chance(4)) R(bytes->Choice(3), bytes->Choice(3)) = bytes->AnyDouble();
  return R;
}

rigel::Rig MakeRig(Bytes* bytes) {
  rigel::Rig rig;
  const int size = bytes->Choice(6);
  for (int k = 0; k < size; ++k) {
    rigel::RigCamera camera;
    camera.intrinsics.parameters[0] = bytes->Double(1, 1000);
    camera.intrinsics.parameters[1] =
        bytes->Chance(200) ? camera.intrinsics.fx() : bytes->Double(1, 1000);
    camera.intrinsics.parameters[2] = bytes->Double(0, 640);
    camera.intrinsics.parameters[3] = bytes->Double(0, 480);
    camera.Q = Rotation(bytes);
    // Far origins too: UTM coordinates.
    const double reach = bytes->Chance(16) ? 5e6 : 1.0;
    for (int i = 0; i < 3; ++i) camera.s[i] = bytes->Double(-reach, reach);
    rig.cameras.push_back(camera);
  }
  return rig;
}

rigel::MotionPrior MakePrior(Bytes* bytes) {
  rigel::MotionPrior prior;
  if (bytes->Chance(160)) prior.gravity1 = Direction(bytes);
  if (bytes->Chance(160)) {
    prior.gravity2 = prior.gravity1 && bytes->Chance(128) ? *prior.gravity1 : Direction(bytes);
  }
  if (bytes->Chance(160)) prior.axis = Direction(bytes);
  if (bytes->Chance(160)) prior.normal = Direction(bytes);
  if (bytes->Chance(100)) prior.gravity_sigma = bytes->Double(0, 0.1);
  if (bytes->Chance(100)) prior.axis_sigma = bytes->Double(0, 0.1);
  if (bytes->Chance(100)) prior.normal_sigma = bytes->Double(0, 0.1);
  if (bytes->Chance(100)) prior.distance = bytes->Double(0, 10);
  if (bytes->Chance(100)) prior.distance_sigma = bytes->Double(0, 1);
  return prior;
}

rigel::Pose MakeMotion(Bytes* bytes) {
  rigel::Pose pose;
  pose.R = Rotation(bytes);
  for (int k = 0; k < 3; ++k) pose.t[k] = bytes->Double(-2, 2);
  return pose;
}

// Points of a scene under `motion`, with noise, outliers and whatever the bytes put in their place.
std::vector<rigel::Match> MakeMatches(const rigel::Rig& rig, const rigel::Pose& motion,
                                      Bytes* bytes) {
  std::vector<rigel::Match> matches;
  const int count = bytes->Choice(80);
  const double near = bytes->Double(0.5, 5), depth = bytes->Double(0, 30);
  const double noise = bytes->Chance(128) ? 0.0 : bytes->Double(0, 3);
  for (int k = 0; k < count && !bytes->Empty(); ++k) {
    rigel::Match match;
    if (rig.size() > 0) {
      match.camera1 = bytes->Choice(rig.size());
      match.camera2 = bytes->Chance(180) ? match.camera1 : bytes->Choice(rig.size());
    }
    match.pixel1 = {bytes->Uniform(0, 640), bytes->Uniform(0, 480)};
    match.pixel2 = {bytes->Uniform(0, 640), bytes->Uniform(0, 480)};
    const uint8_t kind = bytes->Byte();
    if (kind < 180 && rig.size() > 0) {
      const rigel::RigCamera& from = rig.cameras[match.camera1];
      const rigel::RigCamera& to = rig.cameras[match.camera2];
      const Eigen::Vector3d ray = from.Q * AlongRay(from.intrinsics, match.pixel1);
      const Eigen::Vector3d X = from.s + (near + depth * kind / 180.0) * ray;
      if (Project(to.intrinsics, to.Q.transpose() * (motion * X - to.s), &match.pixel2)) {
        match.pixel2 += noise * Eigen::Vector2d{bytes->Uniform(-1, 1), bytes->Uniform(-1, 1)};
      }
    } else if (kind < 190 && !matches.empty()) {
      match = matches[bytes->Choice(static_cast<int>(matches.size()))];
    } else if (kind < 200) {
      match.pixel2 = match.pixel1;
    } else if (kind < 204) {
      match.pixel1[bytes->Choice(2)] = bytes->AnyDouble();
    } else if (kind < 206) {
      match.camera2 = bytes->Int();
    } else if (kind < 220) {
      match.score = bytes->Double(0, 1);
    }
    matches.push_back(match);
  }
  return matches;
}

// Of EstimateMotion(), and of Refine() by itself.
struct Options {
  rigel::EstimateOptions estimate;
  rigel::RefineOptions refine;
};

Options MakeOptions(Bytes* bytes) {
  rigel::EstimateOptions options;
  const std::vector<rigel::SolverInfo>& catalogue = rigel::SolverCatalogue();
  const int solver = bytes->Choice(static_cast<int>(catalogue.size()) + 4);
  if (solver < static_cast<int>(catalogue.size())) {
    options.solver = catalogue[solver].name;
  } else {
    options.solver = "auto";
  }
  if (bytes->Chance(2)) options.solver = "no such solver";
  options.refine_motion = bytes->Chance(230);

  rigel::RansacOptions& ransac = options.ransac;
  if (bytes->Chance(80)) ransac.threshold_px = bytes->Double(0, 5);
  if (bytes->Chance(80)) ransac.confidence = bytes->Double(0, 1);
  // So many at most that no right answer takes seconds under the sanitizers.
  ransac.max_iterations = bytes->Chance(250) ? 1 + bytes->Choice(100) : std::min(bytes->Int(), 100);
  ransac.min_iterations = bytes->Chance(250) ? bytes->Choice(60) : std::min(bytes->Int(), 100);
  ransac.local_optimization = bytes->Chance(220);
  ransac.prosac = bytes->Chance(220);
  ransac.early_termination = bytes->Chance(220);
  ransac.bail_out = bytes->Chance(220);
  ransac.score =
      static_cast<rigel::ScoreKind>(bytes->Chance(250) ? bytes->Choice(3) : bytes->Int());
  // Of options that are gone: the bytes after them keep their meaning.
  bytes->Chance(60);
  if (bytes->Chance(40)) bytes->Double(0, 100);
  if (bytes->Chance(80))
    ransac.num_finalists = bytes->Chance(230) ? bytes->Choice(17) : bytes->Int();
  ransac.seed = bytes->Byte();

  rigel::RefineOptions refine;
  const auto kind = [bytes](int count) {
    return bytes->Chance(252) ? bytes->Choice(count) : bytes->Int();
  };
  refine.form = static_cast<rigel::RefineForm>(kind(5));
  refine.residual = static_cast<rigel::ResidualKind>(bytes->Chance(200) ? 0 : kind(3));
  refine.prior_kind = static_cast<rigel::PriorKind>(kind(4));
  refine.use_prior = bytes->Chance(90);
  refine.epipole_weights = bytes->Chance(200);
  refine.loss = static_cast<rigel::LossKind>(kind(5));
  if (bytes->Chance(60)) refine.loss_scale_sigmas = bytes->Double(0.1, 10);
  refine.engine = static_cast<rigel::RefineEngine>(kind(2));
  if (bytes->Chance(60)) refine.threshold_px = bytes->Double(0, 5);
  if (bytes->Chance(60)) refine.max_rounds = bytes->Chance(230) ? bytes->Choice(8) : -1;
  if (bytes->Chance(60)) refine.max_num_iterations = bytes->Chance(230) ? bytes->Byte() : -1;
  refine.hold_distance = kind(3) == 0;
  if (bytes->Chance(80)) refine.noise_px = bytes->Double(0, 2);
  options.refine = refine;
  return {options, refine};
}

// What came after the first seeds were made: from the last bytes, so that these stay what they are.
constexpr size_t kTail = 16;
void AddLaterOptions(Bytes* bytes, Options* options, rigel::MotionPrior* prior) {
  static const std::atomic<bool> cancelled = true;
  if (bytes->Chance(40)) options->estimate.time_limit = bytes->Double(0, 0.01);
  if (bytes->Chance(8)) options->estimate.cancel = &cancelled;
  if (bytes->Chance(40)) options->refine.time_limit = bytes->Double(0, 0.01);
  if (bytes->Chance(8)) options->refine.cancel = &cancelled;
  if (bytes->Chance(40)) options->refine.num_tries = bytes->Double(0, 1e8);
  if (bytes->Chance(40)) options->refine.threshold_px = 0.0;  // auto
  options->estimate.refine.time_limit = options->refine.time_limit;
  options->estimate.refine.cancel = options->refine.cancel;
  if (bytes->Chance(100)) prior->forward = Direction(bytes);
  if (bytes->Chance(40)) options->refine.typical_length = bytes->Double(0, 1e3);
  options->estimate.refine.typical_length = options->refine.typical_length;
}

// Some become fisheyes. Pixels may then lie outside the circle of the lens.
void AddLenses(Bytes* bytes, rigel::Rig* rig) {
  for (rigel::RigCamera& camera : rig->cameras) {
    if (bytes->Chance(192)) continue;
    camera.intrinsics.model = rigel::CameraModel::kOpencvFisheye;
    for (int i = 4; i < 8; ++i) camera.intrinsics.parameters[i] = bytes->Double(-0.1, 0.1);
  }
}

void RequireSound(const rigel::RefineSummary& summary, size_t num_matches) {
  Require(!summary.message.empty(), "the refinement says what it did");
  summary.BriefReport();
  summary.ObservabilityReport();
  if (!summary.IsSolutionUsable()) return;
  Require(summary.inliers.size() == num_matches, "a flag a match");
  Require(!summary.covariance || summary.covariance->allFinite(), "a finite covariance");
  Require(std::isfinite(summary.noise_px) && std::isfinite(summary.median_residual_px) &&
              std::isfinite(summary.final_cost),
          "finite figures of the refinement");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const size_t tail_size = std::min(kTail, size / 4);
  Bytes bytes(data, size - tail_size);
  Bytes tail(data + (size - tail_size), tail_size);
  Options options = MakeOptions(&bytes);
  rigel::FramePair pair;
  pair.rig = MakeRig(&bytes);
  const rigel::Pose motion = MakeMotion(&bytes);
  pair.prior = MakePrior(&bytes);
  AddLaterOptions(&tail, &options, &pair.prior);
  AddLenses(&tail, &pair.rig);
  if (bytes.Chance(40)) pair.noise_px = bytes.Double(0, 2);
  if (bytes.Chance(40)) pair.time1 = bytes.AnyDouble();
  if (bytes.Chance(40)) pair.time2 = bytes.AnyDouble();
  if (bytes.Chance(40)) pair.truth = motion;
  pair.matches = MakeMatches(pair.rig, motion, &bytes);

  const rigel::MotionEstimate estimate = rigel::EstimateMotion(options.estimate, pair);
  Require(estimate.status == rigel::EstimateStatus::kSuccess || !estimate.message.empty(),
          "a failure has a message");
  if (estimate.HasMotion()) {
    Require(estimate.pose.AllFinite(), "a finite motion");
    Require(std::abs(estimate.pose.R.determinant() - 1.0) < 1e-6, "a rotation");
    Require(estimate.raw.AllFinite(), "a finite raw motion");
    Require(
        estimate.num_inliers >= 0 && estimate.num_inliers <= static_cast<int>(pair.matches.size()),
        "no more inliers than matches");
    if (estimate.refine.IsSolutionUsable()) RequireSound(estimate.refine, pair.matches.size());
  }

  // The same refinement from a start of the caller's, which may be anything.
  rigel::Pose pose = motion;
  const rigel::RefineSummary summary =
      rigel::Refine(options.refine, pair.rig, pair.matches, pair.prior, &pose);
  RequireSound(summary, pair.matches.size());
  Require(!summary.IsSolutionUsable() || pose.AllFinite(), "a finite refined motion");
  return 0;
}
