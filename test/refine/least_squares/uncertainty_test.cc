// Information and covariance: against numeric differentiation, against Monte Carlo, and where the
// matches determine nothing.
#include "rigel/refine/least_squares/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "rigel/core/epipolar.h"
#include "rigel/refine/refine.h"
#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

std::vector<char> AllOf(const GroupedMatches& matches) {
  return std::vector<char>(matches.size(), 1);
}

std::vector<double> OnesOf(const GroupedMatches& matches) {
  return std::vector<double>(matches.size(), 1.0);
}

TEST(Uncertainty, InformationIsThatOfTheWeighedSampsonErrors) {
  for (int index = 0; index < 20; ++index) {
    SceneOptions options;
    options.num_matches = 40;
    options.inter_share = 0.5;
    const FramePair pair = ScenePair(options, index);
    const GroupedMatches matches(pair.rig, pair.matches);
    std::vector<double> weights(matches.size());
    for (size_t k = 0; k < weights.size(); ++k) weights[k] = 0.5 * (k % 3);
    Matrix6d expected = Matrix6d::Zero();
    for (int k = 0; k < matches.size(); ++k) {
      Vector6d row;
      for (int c = 0; c < 6; ++c) {
        row(c) = CentralDifference(
            [&](double h) {
              return Eigen::Matrix<double, 1, 1>(SampsonError(
                  Perturbed(*pair.truth, h * Vector6d::Unit(c)), pair.rig, matches.matches()[k]));
            },
            1e-4)(0);
      }
      expected += weights[k] * weights[k] * row * row.transpose();
    }
    const Matrix6d information = SampsonInformation(matches, weights, *pair.truth);
    EXPECT_LT((information - expected).norm(), 1e-6 * expected.norm());
  }
}

// Normalized estimation error squared, e' C^-1 e: its mean is the number of free parameters if the
// covariance is right. The mean of 300 has a standard deviation of 0.2 for 6 of them.
TEST(Uncertainty, CovarianceMatchesTheErrorsOfRefinedMotions) {
  for (const bool scale_free : {true, false}) {
    double sum = 0.0;
    constexpr int kPairs = 300;
    for (int index = 0; index < kPairs; ++index) {
      SceneOptions options;
      options.num_matches = 100;
      options.inter_share = scale_free ? 0.5 : 0.0;
      options.motion = MotionPattern::kRandom;
      const FramePair pair = ScenePair(options, index);
      RefineOptions refine;
      refine.loss = LossKind::kNone;
      refine.noise_px = options.noise_px;
      refine.threshold_px = 5.0;  // no outliers: a cut would shrink the errors
      refine.hold_distance = !scale_free;
      Pose pose = *pair.truth;
      const RefineSummary summary = Refine(refine, pair.rig, pair.matches, pair.prior, &pose);
      ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
      ASSERT_TRUE(summary.covariance.has_value());
      Vector6d error = Difference(*pair.truth, pose);
      if (scale_free) {
        sum += error.dot(summary.covariance->ldlt().solve(error));
        continue;
      }
      const MotionBasis B = FullBasis(pose, false);
      const Eigen::VectorXd e = B.transpose() * error;
      const Eigen::MatrixXd C = B.transpose() * *summary.covariance * B;
      sum += e.dot(C.ldlt().solve(e));
    }
    const double mean = sum / kPairs;
    RecordProperty(scale_free ? "nees6" : "nees5", std::to_string(mean));
    EXPECT_GT(mean, scale_free ? 5.2 : 4.2);
    EXPECT_LT(mean, scale_free ? 6.9 : 5.9);
  }
}

TEST(Uncertainty, CovarianceOnTheSphereHasRankFiveAndNothingAlongT) {
  const FramePair pair = ScenePair(SceneOptions(), 3);
  const GroupedMatches matches(pair.rig, pair.matches);
  const Matrix6d information = SampsonInformation(matches, OnesOf(matches), *pair.truth) / 0.25;
  const MotionBasis basis = FullBasis(*pair.truth, false);
  ASSERT_EQ(basis.cols(), 5);
  EXPECT_LT((basis.transpose() * basis - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-12);
  Matrix6d covariance;
  ASSERT_TRUE(CovarianceOfBasis(information, basis, &covariance));
  const Eigen::Vector3d along = covariance.block<3, 3>(3, 3) * pair.truth->t;
  EXPECT_LT(along.norm(), 1e-12);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(covariance).eigenvalues();
  EXPECT_LT(eigenvalues(0), 1e-12 * eigenvalues(5));
  EXPECT_GT(eigenvalues(1), 1e-9 * eigenvalues(5));
  // It inverts the information of those directions.
  const Eigen::MatrixXd product =
      basis.transpose() * covariance * basis * (basis.transpose() * information * basis);
  EXPECT_LT((product - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-8);
}

TEST(Uncertainty, FullBasisIsAllSixWhereScaleIsFree) {
  EXPECT_EQ(MotionBasis(FullBasis(Pose(), true)), MotionBasis(Eigen::MatrixXd::Identity(6, 6)));
  EXPECT_TRUE(FullBasis(Pose(), false).allFinite());  // t = 0 has no direction, and no crash
}

TEST(Uncertainty, SingularInformationIsRefusedAndTheCovarianceLeftAlone) {
  const Matrix6d before = Matrix6d::Constant(7.0);
  Matrix6d covariance = before;
  const MotionBasis all = FullBasis(Pose(), true);
  EXPECT_FALSE(CovarianceOfBasis(Matrix6d::Zero(), all, &covariance));
  const Vector6d v = Vector6d::LinSpaced(1, 2);
  // Units as unlike as pixels per radian and per metre must not pass for a lack of rank.
  const Vector6d units(1e6, 1e6, 1e6, 1.0, 1.0, 1e-3);
  Matrix6d information = Matrix6d::Identity() - v.normalized() * v.normalized().transpose();
  information = units.asDiagonal() * information * units.asDiagonal();
  EXPECT_FALSE(CovarianceOfBasis(information, all, &covariance));
  Matrix6d nan = Matrix6d::Identity();
  nan(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(CovarianceOfBasis(nan, all, &covariance));
  MotionBasis none(6, 0);
  EXPECT_FALSE(CovarianceOfBasis(Matrix6d::Identity(), none, &covariance));
  EXPECT_EQ(covariance, before);

  information = units.asDiagonal() * Matrix6d::Identity() * units.asDiagonal();
  ASSERT_TRUE(CovarianceOfBasis(information, all, &covariance));
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(covariance(k, k) * units(k) * units(k), 1.0, 1e-9);
}

// Seen by intra-camera matches, pure translation says nothing at all of |t|.
TEST(Uncertainty, ScaleSigmaIsInfiniteAtPureTranslationOfIntraCameraMatches) {
  for (int index = 0; index < 50; ++index) {
    SceneOptions options;
    options.rotation_deg = 0.0;
    options.motion = MotionPattern::kRandom;
    options.num_matches = 100;
    const FramePair pair = ScenePair(options, index);
    const GroupedMatches matches(pair.rig, pair.matches);
    const Matrix6d information = SampsonInformation(matches, OnesOf(matches), *pair.truth) / 0.25;
    EXPECT_EQ(RelativeScaleSigma(information, *pair.truth),
              std::numeric_limits<double>::infinity());
  }
  EXPECT_EQ(RelativeScaleSigma(Matrix6d::Identity(), Pose()),
            std::numeric_limits<double>::infinity());
}

// DESIGN.md: 0.4 percent at 100 inter-camera matches, tens of percent at as many intra-camera ones.
TEST(Uncertainty, ScaleSigmaTellsInterFromIntraCameraMatches) {
  std::vector<double> sigma[2];
  for (int index = 0; index < 50; ++index) {
    for (const int inter : {0, 1}) {
      SceneOptions options;
      options.num_matches = 100;
      options.inter_share = inter;
      const FramePair pair = ScenePair(options, index);
      const GroupedMatches matches(pair.rig, pair.matches);
      sigma[inter].push_back(RelativeScaleSigma(
          SampsonInformation(matches, OnesOf(matches), *pair.truth) / 0.25, *pair.truth));
    }
  }
  // The short way through a Cholesky factor gives what the covariance says.
  for (const int inter : {0, 1}) {
    SceneOptions options;
    options.inter_share = inter;
    const FramePair pair = ScenePair(options, 7);
    const GroupedMatches matches(pair.rig, pair.matches);
    const Matrix6d information = SampsonInformation(matches, OnesOf(matches), *pair.truth) / 0.25;
    Matrix6d covariance;
    ASSERT_TRUE(CovarianceOfBasis(information, FullBasis(*pair.truth, true), &covariance));
    const Eigen::Vector3d t = pair.truth->t;
    const double expected = std::sqrt(t.dot(covariance.block<3, 3>(3, 3) * t)) / t.squaredNorm();
    EXPECT_NEAR(RelativeScaleSigma(information, *pair.truth), expected, 1e-6 * expected);
  }
  EXPECT_GT(MedianOf(sigma[0]), 0.2);
  EXPECT_LT(MedianOf(sigma[1]), 0.01);
  EXPECT_GT(MedianOf(sigma[1]), 0.001);
}

TEST(Uncertainty, SigmasAreThoseOfTheBlocks) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1, 4, 4, 0.09, 0.16, 25;
  EXPECT_NEAR(RotationSigma(covariance), 3.0, 1e-12);
  // What lies along t does not turn it.
  EXPECT_NEAR(DirectionSigma(covariance, {0, 0, 2}), 0.25, 1e-12);
  EXPECT_EQ(DirectionSigma(covariance, Eigen::Vector3d::Zero()),
            std::numeric_limits<double>::infinity());
  Pose pose;
  pose.t = {0, 0, -2};
  const Matrix6d information = covariance.inverse();
  EXPECT_NEAR(RelativeScaleSigma(information, pose), 2.5, 1e-9);
}

// Known directions in, the same directions in words out.
TEST(Uncertainty, TheWeakestDirectionIsSaidInWords) {
  Matrix6d covariance = 1e-10 * Matrix6d::Identity();
  Vector6d v;
  v << 0, 2e-3, 0, -0.06, 0, 0.08;
  covariance += v * v.transpose();
  EXPECT_EQ(WeakestDirection(covariance, {0, 0, 1}),
            "turn by 0.115 deg about (0.0, 1.0, 0.0) with t by 0.1 m along (-0.6, 0.0, 0.8)");
  EXPECT_EQ(WeakestDirection(covariance, {0, 0, 0}), "");
  // t counts as a share of |t|: 0.1 m of 100 m is less than the rotation's own 0.2 deg.
  covariance(0, 0) = std::pow(DegToRad(0.2), 2);
  EXPECT_THAT(WeakestDirection(covariance, {0, 0, 100}),
              testing::StartsWith("turn by 0.2 deg about (1.0, 0.0, 0.0)"));
}

TEST(Uncertainty, ParallaxIsWhatTheRotationDoesNotExplain) {
  SceneOptions options;
  options.noise_px = 0.0;
  options.rotation_deg = 5.0;
  Pose turn;
  turn.R = ExpSO3(DegToRad(5.0) * Eigen::Vector3d::UnitY());
  // Turned about the camera itself: no parallax. A camera off the origin has its arm.
  FramePair pair = ScenePair(options, 1, turn);
  Rig centred = pair.rig;
  for (RigCamera& camera : centred.cameras) camera.s.setZero();
  std::vector<Match> pure;
  for (Match m : pair.matches) {
    const RigCamera& camera = centred.cameras[m.camera1];
    const Eigen::Vector3d x =
        camera.Q.transpose() * turn.R * camera.Q * AlongRay(camera.intrinsics, m.pixel1);
    m.pixel2 = ProjectPinhole(camera.intrinsics, x);
    pure.push_back(m);
  }
  const GroupedMatches still(centred, pure);
  EXPECT_LT(ParallaxPercentilePx(still, AllOf(still), turn), 1e-9);

  // One metre sideways, points straight ahead at depth d: 400 / d pixels. 80 percent are below it.
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].intrinsics = Camera::Pinhole(400, 400, 320, 240, 640, 480);
  Pose sideways;
  sideways.t = {1, 0, 0};
  std::vector<Match> matches;
  for (int k = 0; k < 100; ++k) {
    Match m;
    m.pixel1 = {320, 240};
    m.pixel2 = ProjectPinhole(rig.cameras[0].intrinsics, {1, 0, 4.0 + k});
    matches.push_back(m);
  }
  const GroupedMatches moved(rig, matches);
  std::vector<char> mask = AllOf(moved);
  EXPECT_NEAR(ParallaxPercentilePx(moved, mask, sideways), 400.0 / std::hypot(1, 4.0 + 19.5), 0.5);
  // Those outside the mask do not count: without the 50 nearest it is less.
  for (int k = 0; k < 50; ++k) mask[k] = 0;
  EXPECT_NEAR(ParallaxPercentilePx(moved, mask, sideways), 400.0 / std::hypot(1, 54.0 + 9.5), 0.2);
  mask.assign(100, 0);
  EXPECT_EQ(ParallaxPercentilePx(moved, mask, sideways), std::numeric_limits<double>::infinity());
}

// Forward motion of one camera: both epipoles are the principal point. Matches at d pixels from it
// in both images have |gradient|^2 = 2 d^2 |F_2x2|^2 / 2, since F_2x2 turns by a right angle and
// scales.
TEST(EpipoleWeights, AreOneHalfAtTheDistanceThatTheHeaderStates) {
  Rig rig;
  RigCamera camera;
  camera.intrinsics = Camera::Pinhole(400, 400, 320, 240, 640, 480);
  rig.cameras.push_back(camera);
  Pose pose;
  pose.t = {0, 0, -1};
  const double noise = 0.5;
  const double half = kEpipoleSigmas / std::sqrt(2.0) * noise;
  std::vector<Match> matches;
  for (const double d : {0.0, half * std::sqrt(2.0), 300.0}) {
    Match m;
    m.pixel1 = m.pixel2 = {320 + d, 240};
    matches.push_back(m);
  }
  const GroupedMatches grouped(rig, matches);
  std::vector<double> weights;
  EpipoleWeights(grouped, pose, noise, &weights);
  ASSERT_EQ(weights.size(), 3u);
  EXPECT_EQ(weights[0], 0.0);
  EXPECT_NEAR(weights[1], 0.5, 1e-9);
  EXPECT_GT(weights[2], 0.99);
  // E = 0: no match says anything.
  EpipoleWeights(grouped, Pose(), noise, &weights);
  EXPECT_EQ(weights, std::vector<double>(3, 0.0));
}

}  // namespace
}  // namespace rigel
