// Two-view bundle adjustment: its Jacobians, and that its minimum is that of the Sampson error.
#include "rigel/refine/least_squares/reprojection_cost.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rigel/refine/refine.h"
#include "rigel/test/core/lens_rig.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

struct Point {
  Rig rig;
  Match match;
  Pose pose;
  ReprojectionCost::Point point;
};

// A match between any two of three unlike cameras whose point is in front of the second.
Point RandomPoint(uint64_t seed) {
  Random random = Random::Stream(31, seed);
  Point p;
  p.rig = MixedRig(&random);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const double angle = seed % 3 == 0 ? 1e-9 : seed % 3 == 1 ? 3.14159 : random.Uniform(0.0, 3.0);
    p.pose.R = ExpSO3(angle * random.UnitVector3());
    p.pose.t = RandomVector3(0.1, 2.0, &random);
    p.match = UnrelatedMatches(p.rig, 9, &random)[random.Index(9)];
    p.point = {random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(0.02, 0.5)};
    const RigCamera& c1 = p.rig.cameras[p.match.camera1];
    const RigCamera& c2 = p.rig.cameras[p.match.camera2];
    const Eigen::Vector3d X = c1.Q * AlongRay(c1.intrinsics, p.match.pixel1) / p.point[2] + c1.s;
    const Eigen::Vector3d y = c2.Q.transpose() * (p.pose * X - c2.s);
    if (y.z() > 0.5 && y.head<2>().norm() < 3 * y.z()) return p;
  }
  ADD_FAILURE() << "no point in front";
  return p;
}

Eigen::Vector4d Residuals(const Point& p, const Pose& pose, const ReprojectionCost::Point& point,
                          double weight) {
  const MotionBasis basis = MotionBasis::Identity(6, 6);
  const ReprojectionCost cost(p.rig, p.match, pose, basis, 6, weight);
  const double motion[6] = {};
  const double* blocks[2] = {motion, point.data()};
  Eigen::Vector4d r;
  EXPECT_TRUE(cost.Evaluate(blocks, r.data(), nullptr));
  return r;
}

// The same of any lenses, with rays beyond 90 degrees where they have some.
Point RandomLensPoint(uint64_t seed) {
  Random random = Random::Stream(32, seed);
  Point p;
  const LensRig lenses = MakeLensRig(static_cast<int>(seed), &random);
  p.rig = lenses.rig;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    p.pose.R = ExpSO3(random.Uniform(0.0, 3.0) * random.UnitVector3());
    p.pose.t = RandomVector3(0.1, 2.0, &random);
    p.match = UnrelatedLensMatches(lenses, 9, &random)[random.Index(9)];
    p.point = {random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(0.02, 0.5)};
    const RigCamera& c1 = p.rig.cameras[p.match.camera1];
    const RigCamera& c2 = p.rig.cameras[p.match.camera2];
    const Eigen::Vector3d X = c1.Q * AlongRay(c1.intrinsics, p.match.pixel1) / p.point[2] + c1.s;
    const Eigen::Vector3d y = c2.Q.transpose() * (p.pose * X - c2.s);
    const double angle = std::atan2(y.head<2>().norm(), y.z());
    if (angle < lenses.cases[p.match.camera2].half_view_deg * kRadiansPerDegree) return p;
  }
  ADD_FAILURE() << "no point in view";
  return p;
}

void ExpectJacobians(const Point& p) {
  const MotionBasis basis = MotionBasis::Identity(6, 6);
  constexpr double kWeight = 0.7;
  const ReprojectionCost cost(p.rig, p.match, p.pose, basis, 6, kWeight);
  const double motion[6] = {};
  const double* blocks[2] = {motion, p.point.data()};
  Eigen::Vector4d r;
  Eigen::Matrix<double, 4, 6, Eigen::RowMajor> by_motion;
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> by_point;
  double* jacobians[2] = {by_motion.data(), by_point.data()};
  ASSERT_TRUE(cost.Evaluate(blocks, r.data(), jacobians));
  EXPECT_LT((r - Residuals(p, p.pose, p.point, kWeight)).norm(), 1e-12);
  for (int c = 0; c < 6; ++c) {
    const Eigen::Vector4d numeric = CentralDifference(
        [&](double h) {
          return Residuals(p, Perturbed(p.pose, h * Vector6d::Unit(c)), p.point, kWeight);
        },
        1e-4);
    EXPECT_LT((by_motion.col(c) - numeric).norm(), 1e-7 * (1 + by_motion.norm()));
  }
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector4d numeric = CentralDifference(
        [&](double h) {
          ReprojectionCost::Point moved = p.point;
          moved[c] += h;
          return Residuals(p, p.pose, moved, kWeight);
        },
        1e-4);
    EXPECT_LT((by_point.col(c) - numeric).norm(), 1e-7 * (1 + by_point.norm()));
  }
}

TEST(ReprojectionCost, JacobiansMatchNumericDifferentiation) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    ExpectJacobians(RandomPoint(seed));
  }
}

TEST(ReprojectionCost, JacobiansOfAnyLensMatchNumericDifferentiation) {
  int num_beyond_90 = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const Point p = RandomLensPoint(seed);
    ExpectJacobians(p);
    const Camera& first = p.rig.cameras[p.match.camera1].intrinsics;
    num_beyond_90 += AlongRay(first, p.match.pixel1).z() < 0 ? 1 : 0;
  }
  EXPECT_GT(num_beyond_90, 0);
}

TEST(ReprojectionCost, APointInThePlaneOfTheCameraIsRefused) {
  Point p = RandomPoint(2);
  const MotionBasis basis = MotionBasis::Identity(6, 6);
  p.pose = Pose();
  p.match.camera2 = p.match.camera1;
  RigCamera& camera = p.rig.cameras[p.match.camera1];
  // Turned by a right angle about x: the ray of the principal point lies in the plane.
  p.match.pixel1 = {camera.intrinsics.cx(), camera.intrinsics.cy()};
  p.pose.R = camera.Q * ExpSO3(0.5 * M_PI * Eigen::Vector3d::UnitX()) * camera.Q.transpose();
  const ReprojectionCost cost(p.rig, p.match, p.pose, basis, 6, 1.0);
  const double motion[6] = {};
  const ReprojectionCost::Point point = {0.0, 0.0, 0.0};
  const double* blocks[2] = {motion, point.data()};
  Eigen::Vector4d r;
  // Exactly or by rounding.
  if (cost.Evaluate(blocks, r.data(), nullptr)) {
    EXPECT_GT(r.cwiseAbs().maxCoeff(), 1e10);
  }
}

// The Sampson error is the reprojection error to first order: the minima differ by far less than
// the noise moves them. Sideways, away from epipoles.
TEST(ReprojectionCost, BundleAdjustmentEndsWhereTheSampsonErrorDoes) {
  for (int index = 0; index < 20; ++index) {
    SceneOptions scene;
    scene.motion = MotionPattern::kSideways;
    scene.inter_share = 0.5;
    const FramePair pair = ScenePair(scene, index);
    Random random = Random::Stream(8, index);
    const Pose start = StartNear(*pair.truth, 0.05, 0.02, &random);
    RefineOptions options;
    options.noise_px = 0.5;
    options.loss = LossKind::kNone;
    options.threshold_px = 20.0;
    Pose full = start;
    Pose bundle = start;
    const RefineSummary by_full = Refine(options, pair.rig, pair.matches, pair.prior, &full);
    options.form = RefineForm::kBundle;
    const RefineSummary by_bundle = Refine(options, pair.rig, pair.matches, pair.prior, &bundle);
    ASSERT_TRUE(by_full.IsSolutionUsable() && by_bundle.IsSolutionUsable());
    EXPECT_NEAR(by_bundle.final_cost, by_full.final_cost, 0.02 * by_full.final_cost);
    ASSERT_TRUE(by_full.covariance.has_value());
    const Vector6d d = Difference(bundle, full);
    for (int c = 0; c < 6; ++c) {
      EXPECT_LT(std::abs(d(c)), 0.1 * std::sqrt((*by_full.covariance)(c, c))) << index;
    }
  }
}

}  // namespace
}  // namespace rigel
