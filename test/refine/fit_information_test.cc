// The information of a fit: against numeric differentiation, against scores that are drawn, and in
// the limit of no noise.
#include "rigel/refine/fit_information.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "rigel/core/epipolar.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/pixel_noise.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// All matches are inliers, of the same noise.
struct Problem {
  Problem(const Rig& rig, const std::vector<Match>& all, const Pose& at, double sigma_px)
      : matches(rig, all), pose(at) {
    fit.factors.assign(matches.size(), 1.0);
    fit.noise_is_given = true;
    errors.Set(matches, pose, 1.0);
    noise.sigma_px = sigma_px;
    noise.sigma_of.assign(matches.groups().size(), sigma_px);
  }
  FitInformation Information() const { return InformationOfFit(fit, matches, errors, noise, pose); }

  GroupedMatches matches;
  Pose pose;
  FittedInliers fit;
  MatchErrors errors;
  NoiseModel noise;
};

FramePair ExactPair(int num_matches, int index) {
  SceneOptions scene;
  scene.noise_px = 0.0;
  scene.inter_share = 0.5;
  scene.num_matches = num_matches;
  return ScenePair(scene, index);
}

// Smallest and largest eigenvalue of `part` against `whole`.
Eigen::Vector2d Ratios(const Matrix6d& part, const Matrix6d& whole) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> eigen(part, whole);
  return {eigen.eigenvalues()(0), eigen.eigenvalues()(5)};
}

void ExpectRatiosWithin(double tolerance, const Matrix6d& part, const Matrix6d& whole) {
  const Eigen::Vector2d ratios = Ratios(part, whole);
  EXPECT_GT(ratios(0), 1.0 - tolerance);
  EXPECT_LT(ratios(1), 1.0 + tolerance);
}

constexpr LossKind kSmoothLosses[] = {LossKind::kNone, LossKind::kHuber, LossKind::kCauchy,
                                      LossKind::kTukey};

// Where all residuals are zero the second derivatives of the errors and the loss play no part.
TEST(FitInformation, TheCurvatureIsThatOfGaussNewtonAtZeroResiduals) {
  for (int index = 0; index < 10; ++index) {
    const FramePair pair = ExactPair(100, index);
    for (const LossKind loss : kSmoothLosses) {
      SCOPED_TRACE(LossName(loss));
      Problem problem(pair.rig, pair.matches, *pair.truth, 0.5);
      problem.fit.loss = loss;
      problem.fit.loss_scale_sigmas = 6.0;
      problem.fit.noise_is_given = false;
      const FitInformation information = problem.Information();
      ExpectRatiosWithin(1e-4, information.curvature, information.observed);
      const Matrix6d expected =
          SampsonInformation(problem.matches, problem.fit.factors, *pair.truth) / 0.25;
      EXPECT_LT((information.observed - expected).norm(), 1e-9 * expected.norm());
    }
  }
}

// Where they are not: the second differences of the cost, for a motion that is off and outliers.
TEST(FitInformation, TheCurvatureIsThatOfTheCost) {
  constexpr double kSigma = 0.5;
  constexpr double kScale = 4.0;  // sigmas
  for (int index = 0; index < 5; ++index) {
    SceneOptions scene;
    scene.inter_share = 0.5;
    scene.num_matches = 60;
    scene.noise_px = 2.0;
    const FramePair pair = ScenePair(scene, index);
    for (const LossKind loss : {LossKind::kNone, LossKind::kCauchy}) {
      SCOPED_TRACE(LossName(loss));
      Problem problem(pair.rig, pair.matches, *pair.truth, kSigma);
      problem.fit.loss = loss;
      problem.fit.loss_scale_sigmas = kScale;
      problem.fit.noise_is_given = false;
      for (int k = 0; k < problem.matches.size(); ++k) problem.fit.factors[k] = 0.5 * (k % 3);
      const auto rho = MakeLoss(loss, kScale);
      const auto cost = [&](const Vector6d& step) {
        const Pose pose = Perturbed(*pair.truth, step);
        double sum = 0.0;
        for (int k = 0; k < problem.matches.size(); ++k) {
          const double r = problem.fit.factors[k] *
                           SampsonError(pose, pair.rig, problem.matches.matches()[k]) / kSigma;
          double values[3] = {r * r, 1, 0};
          if (rho) rho->Evaluate(r * r, values);
          sum += 0.5 * values[0];
        }
        return sum;
      };
      const double h = 1e-4;
      Matrix6 expected;
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
          const Vector6d a = h * Vector6d::Unit(i), b = h * Vector6d::Unit(j);
          expected(i, j) = (cost(a + b) - cost(a - b) - cost(b - a) + cost(-a - b)) / (4.0 * h * h);
        }
      }
      const FitInformation information = problem.Information();
      // Far nearer to it than Gauss-Newton's.
      EXPECT_LT((information.curvature - expected).norm(),
                0.05 * (information.observed - expected).norm());
    }
  }
}

// Without a minimum of the Sampson errors, and with a given noise, nothing is measured.
TEST(FitInformation, ElsewhereTheCurvatureIsTheObservedInformationWithoutNoise) {
  const FramePair pair = ScenePair(SceneOptions(), 1);
  Problem problem(pair.rig, pair.matches, *pair.truth, 0.5);
  problem.fit.is_minimum = false;
  const FitInformation information = problem.Information();
  EXPECT_EQ(information.curvature, Matrix6d(information.observed - information.noise));
}

// Points that both cameras see at time 2: each pixel at time 1 stands in two matches.
std::vector<Match> LandmarkMatches(const FramePair& pair, int num_points, Random* random) {
  std::vector<Match> matches;
  const auto project = [&](int k, const Eigen::Vector3d& x) {
    const RigCamera& camera = pair.rig.cameras[k];
    return ProjectPinhole(camera.intrinsics, camera.Q.transpose() * (x - camera.s));
  };
  for (int n = 0; n < num_points; ++n) {
    const double z = random->Uniform(3, 20);
    const double y = random->Uniform(-3, 2);
    const double x = random->Uniform(-6, 6);
    const Eigen::Vector3d X(x, y, z);
    for (const int camera2 : {0, 1}) {
      Match m;
      m.camera1 = n % 2;
      m.camera2 = camera2;
      m.pixel1 = project(m.camera1, X);
      m.pixel2 = project(camera2, *pair.truth * X);
      matches.push_back(m);
    }
  }
  return matches;
}

// The variance of the score over draws of the noise, in which a pixel that is shared is drawn once.
TEST(FitInformation, TheScatterOfSharedPixelsIsThatOfScoresThatAreDrawn) {
  constexpr double kSigma = 0.02;
  constexpr int kDraws = 10000;
  Random random(3);
  FramePair pair = WallPair(&random);
  pair.matches = LandmarkMatches(pair, 150, &random);
  const Problem exact(pair.rig, pair.matches, *pair.truth, kSigma);
  const int n = exact.matches.size();
  const std::vector<SharedPixel> shared = FindSharedPixels(exact.matches);
  ASSERT_EQ(static_cast<int>(shared.size()), n / 2);
  std::vector<Vector6> rows;
  for (const Match& m : exact.matches.matches()) {
    rows.push_back(NumericRow(pair.rig, m, *pair.truth));
  }
  const auto draw = [&] {
    std::vector<Match> noisy = WithNoise(exact.matches.matches(), kSigma, &random);
    for (const SharedPixel& s : shared) noisy[s.second].pixel1 = noisy[s.first].pixel1;
    return noisy;
  };
  Matrix6 drawn = Matrix6::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const std::vector<Match> noisy = draw();
    Vector6 score = Vector6::Zero();
    for (int k = 0; k < n; ++k) {
      score += rows[k] * (SampsonError(*pair.truth, pair.rig, noisy[k]) / (kSigma * kSigma));
    }
    drawn += score * score.transpose() / kDraws;
  }
  Problem given = exact;
  given.fit.shared = shared;
  // Eigenvalues of the variance that 10000 draws give are within 5 percent.
  ExpectRatiosWithin(0.06, drawn, given.Information().scatter);
  EXPECT_GT(Ratios(drawn, exact.Information().scatter)(1), 1.3);

  // With unknown noise it is measured, here as often as its mean needs. At the truth the residuals
  // are not smaller than the noise, so that the factor for a fit is too much.
  constexpr int kMeasured = 100;
  Matrix6d with_shared = Matrix6d::Zero(), without = with_shared;
  for (int i = 0; i < kMeasured; ++i) {
    Problem noisy(pair.rig, draw(), *pair.truth, kSigma);
    noisy.fit.noise_is_given = false;
    without += noisy.Information().scatter / kMeasured;
    noisy.fit.shared = shared;
    with_shared += noisy.Information().scatter / kMeasured;
  }
  const double bias = n / (n - 6.0);
  ExpectRatiosWithin(0.1, drawn * bias, with_shared);
  // The measured half sees the links by itself; the model's half alone would be off by 1.3.
  EXPECT_GT(Ratios(drawn, without)(1), 1.1);
}

// With unknown noise the scatter follows the noise of each camera pair, whatever the model says. Of
// many matches a sample is taken.
TEST(FitInformation, TheScatterIsMeasuredWhereTheNoiseIsUnknown) {
  Random random(4);
  for (const int num_matches : {600, 2400}) {
    const FramePair pair = ExactPair(num_matches, 3);
    for (const double actual : {0.05, 0.15}) {
      const Problem known(pair.rig, pair.matches, *pair.truth, 0.1);
      Problem noisy(pair.rig, WithNoise(pair.matches, actual, &random), *pair.truth, 0.1);
      noisy.fit.noise_is_given = false;
      const double expected = actual * actual / 0.01;
      ExpectRatiosWithin(0.25, noisy.Information().scatter, expected * known.Information().scatter);
    }
  }
}

TEST(FitInformation, TheNoiseMakesMuchOfTheInformationBeforeAWall) {
  const MotionBasis all = FullBasis(Pose(), true);
  Random random(5);
  const FramePair wall = WallPair(&random);
  const auto share = [&](const FramePair& pair, double sigma) {
    const Problem problem(pair.rig, WithNoise(pair.matches, sigma, &random), *pair.truth, sigma);
    return TrueInformation(problem.Information(), Matrix6d::Zero(), all);
  };
  EXPECT_LT(share(wall, 0.5), kMinTrueInformation);
  // Of the same wall with exact pixels nothing is false.
  EXPECT_GT(share(wall, 0.005), 0.99);
  const FramePair box = ExactPair(200, 2);
  EXPECT_GT(share(box, 0.5), kMinTrueInformation);
}

// Before a wall noise makes narrow minima in a wide valley. What is called valid there is.
TEST(FitInformation, NarrowMinimaOfAWideValleyAreNotValid) {
  Random random(6);
  int num_valid = 0, num_wrong = 0;
  for (int index = 0; index < 40; ++index) {
    FramePair wall = WallPair(&random);
    wall.matches = WithNoise(wall.matches, 0.5, &random);
    const MotionEstimate e = EstimateMotion({}, wall);
    if (!e.refine.covariance_valid || !e.refine.rotation_observable) continue;
    const Vector6d error = Difference(e.pose, *wall.truth);
    ++num_valid;
    num_wrong += error.dot(e.refine.covariance->inverse() * error) > 24.0;  // four times expected
  }
  EXPECT_LE(num_wrong, 1) << "of " << num_valid;
}

TEST(FitInformation, TheCostOfABoxRisesAsTheCurvatureSays) {
  for (int index = 0; index < 20; ++index) {
    const FramePair box = ExactPair(200, index);
    const Problem problem(box.rig, box.matches, *box.truth, 0.5);
    const FitInformation information = problem.Information();
    const CostRise rise =
        RiseOfCost(problem.fit, problem.matches, problem.noise, *box.truth, information.observed);
    EXPECT_GT(rise.least, 0.9) << index;
    EXPECT_LT(rise.widening.trace(), 1e-4);
  }
}

// The part that a prior adds is true; a direction without information has none that is.
TEST(FitInformation, TrueInformationIsThatOfTheWorstFreeDirection) {
  FitInformation information;
  information.observed = Matrix6d::Identity();
  information.noise.diagonal() << 0.1, 0.2, 0.3, 0.0, 0.6, 0.4;
  const MotionBasis all = FullBasis(Pose(), true);
  EXPECT_NEAR(TrueInformation(information, Matrix6d::Zero(), all), 0.4, 1e-12);
  Matrix6d prior = Matrix6d::Zero();
  prior(4, 4) = 2.0;
  EXPECT_NEAR(TrueInformation(information, prior, all), 0.6, 1e-12);
  EXPECT_NEAR(TrueInformation(information, Matrix6d::Zero(), all.leftCols(3)), 0.7, 1e-12);
  information.observed(3, 3) = 0.0;
  EXPECT_EQ(TrueInformation(information, Matrix6d::Zero(), all), 0.0);
}

// The covariance of the noise; false without one.
bool NoiseCovariance(const FitInformation& information, const Matrix6d& prior,
                     const MotionBasis& basis, Matrix6d* covariance) {
  Matrix6d inverse;
  if (!InverseCurvature(information, prior, basis, kMinShare, &inverse)) return false;
  *covariance = CovarianceOfFit(information, prior, inverse).noise;
  return true;
}

TEST(FitInformation, TheCurvatureIsAShareOfTheObservedInformation) {
  FitInformation information;
  information.observed.diagonal() << 1, 1, 1, 4, 4, 4;
  information.scatter = information.observed;
  information.curvature.diagonal() << -0.5, 0.1, 0.5, 4, 1, 8;
  const MotionBasis all = FullBasis(Pose(), true);
  Matrix6d covariance;
  ASSERT_TRUE(NoiseCovariance(information, Matrix6d::Zero(), all, &covariance));
  Vector6d expected;
  expected << 16, 16, 4, 0.25, 4, 0.25;
  EXPECT_LT((covariance - Matrix6d(expected.asDiagonal())).norm(), 1e-12);
  // The prior is of the curvature, of the observed information and of the scatter.
  ASSERT_TRUE(NoiseCovariance(information, Matrix6d::Identity(), all, &covariance));
  expected << 2.0 / 0.25, 2.0 / 1.21, 2.0 / 2.25, 5.0 / 25, 5.0 / 4, 5.0 / 25;
  EXPECT_LT((covariance - Matrix6d(expected.asDiagonal())).norm(), 1e-12);
  // In the free directions alone.
  ASSERT_TRUE(NoiseCovariance(information, Matrix6d::Zero(), all.rightCols(2), &covariance));
  expected << 0, 0, 0, 0, 4, 0.25;
  EXPECT_LT((covariance - Matrix6d(expected.asDiagonal())).norm(), 1e-12);
}

TEST(FitInformation, SingularInformationHasNoCovariance) {
  FitInformation information;
  information.curvature = information.scatter = Matrix6d::Identity();
  information.observed = Matrix6d::Identity();
  information.observed(2, 2) = 0.0;
  const MotionBasis all = FullBasis(Pose(), true);
  const Matrix6d before = Matrix6d::Constant(7.0);
  Matrix6d covariance = before;
  EXPECT_FALSE(NoiseCovariance(information, Matrix6d::Zero(), all, &covariance));
  information.observed(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(NoiseCovariance(information, Matrix6d::Zero(), all, &covariance));
  EXPECT_FALSE(NoiseCovariance(information, Matrix6d::Zero(), MotionBasis(6, 0), &covariance));
  EXPECT_EQ(covariance, before);
}

// sigma^2 (J'J)^-1 within the free directions.
TEST(FitInformation, WithoutNoiseTheCovarianceIsThatOfLeastSquares) {
  constexpr double kSigma = 1e-3;
  for (int index = 0; index < 5; ++index) {
    const FramePair pair = ExactPair(100, index);
    const Problem problem(pair.rig, pair.matches, *pair.truth, kSigma);
    const FitInformation information = problem.Information();
    Matrix6 JJ = Matrix6::Zero();
    for (const Match& m : pair.matches) {
      const Vector6 row = NumericRow(pair.rig, m, *pair.truth);
      JJ += row * row.transpose();
    }
    for (const bool length_is_free : {true, false}) {
      const MotionBasis B = FullBasis(*pair.truth, length_is_free);
      Matrix6d covariance;
      ASSERT_TRUE(NoiseCovariance(information, Matrix6d::Zero(), B, &covariance));
      const Eigen::MatrixXd product =
          B.transpose() * covariance * B * (B.transpose() * JJ * B) / (kSigma * kSigma);
      EXPECT_LT((product - Eigen::MatrixXd::Identity(B.cols(), B.cols())).norm(), 0.01);
    }
  }
}

// The same rays through a fisheye in place of camera k.
void PutFisheye(int k, FramePair* pair) {
  Camera& camera = pair->rig.cameras[k].intrinsics;
  const Camera old = camera;
  camera = {CameraModel::kOpencvFisheye, {600, 600, 601, 183, -0.03, 4e-3}, 1226, 370};
  for (Match& match : pair->matches) {
    if (match.camera1 == k) Project(camera, AlongRay(old, match.pixel1), &match.pixel1);
    if (match.camera2 == k) Project(camera, AlongRay(old, match.pixel2), &match.pixel2);
  }
}

// What the calibration does is linear: the minimum for a rig with a small error against that of the
// right one.
TEST(FitInformation, CalibrationErrorsMoveTheMotionAsStated) {
  // Of the two cameras none, one and both are fisheyes.
  for (int index = 0; index < 9; ++index) {
    FramePair pair = ExactPair(150, index / 3);
    for (int k = 0; k < index % 3; ++k) PutFisheye(k, &pair);
    for (RigCamera& camera : pair.rig.cameras) {
      camera.rotation_sigma = 1e-3;
      camera.position_sigma = 1e-2;
      camera.focal_sigma = 1e-3;
    }
    RefineOptions options;
    options.noise_px = 0.1;  // the steps, of some 0.01 px, then change no weight
    Pose reference = *pair.truth;
    const RefineSummary summary = RefinePair(options, pair, &reference);
    ASSERT_EQ(summary.calibration_gain.size(), pair.rig.cameras.size());
    Matrix6d sum = Matrix6d::Zero();
    for (int k = 0; k < pair.rig.size(); ++k) {
      for (int error = 0; error < 7; ++error) {
        constexpr double kStep = 1e-5;
        // The central difference, so that what is left is of third order.
        Pose moved[2];
        for (int side = 0; side < 2; ++side) {
          const double step = side == 0 ? kStep : -kStep;
          FramePair wrong = pair;
          RigCamera& camera = wrong.rig.cameras[k];
          const Eigen::Vector3d unit = Eigen::Vector3d::Unit(error % 3);
          if (error < 3) {
            camera.Q = ExpSO3(step * unit) * camera.Q;
          } else if (error < 6) {
            camera.s += step * unit;
          } else {
            camera.intrinsics.parameters[0] *= 1.0 + step;
            camera.intrinsics.parameters[1] *= 1.0 + step;
          }
          moved[side] = *pair.truth;
          RefinePair(options, wrong, &moved[side]);
        }
        const Vector6d numeric = Difference(moved[0], moved[1]) / (2.0 * kStep);
        const Vector6d stated = summary.calibration_gain[k].col(error);
        // To what the weak length and the noise of the pixels change.
        EXPECT_LT((stated - numeric).norm(), 5e-3 * (numeric.norm() + 1.0))
            << "camera " << k << ", error " << error << ": " << stated.transpose() << " and "
            << numeric.transpose();
        const double sigma = error < 3 ? 1e-3 : error < 6 ? 1e-2 : 1e-3;
        sum += sigma * sigma * stated * stated.transpose();
      }
    }
    ASSERT_TRUE(summary.calibration_covariance.has_value());
    EXPECT_LT((*summary.calibration_covariance - sum).norm(), 1e-9 * sum.norm());
    // It is a part of the covariance.
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> rest(*summary.covariance - sum);
    EXPECT_EQ(rest.info(), Eigen::Success);
    RefineSummary without;
    for (RigCamera& camera : pair.rig.cameras) {
      camera.rotation_sigma = camera.position_sigma = camera.focal_sigma = 0.0;
    }
    Pose pose = *pair.truth;
    without = RefinePair(options, pair, &pose);
    EXPECT_FALSE(without.calibration_covariance.has_value());
    EXPECT_LT((*without.covariance - (*summary.covariance - sum)).norm(),
              1e-6 * without.covariance->norm());
  }
}

}  // namespace
}  // namespace rigel
