// The Cramer-Rao bound against numeric differentiation.
#include "rigel/problems/evaluation/cramer_rao.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "rigel/core/epipolar.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/rig_centre.h"
#include "rigel/test/problems/evaluation/cramer_rao_pairs.h"

namespace rigel {
namespace {

// The derivative of a match's Sampson error by the columns of `basis` at the truth, by differences.
Eigen::VectorXd NumericRow(const FramePair& pair, const Match& m, const Eigen::MatrixXd& basis) {
  Eigen::VectorXd row(basis.cols());
  for (int c = 0; c < basis.cols(); ++c) {
    row(c) = CentralDifference(
        [&](double h) {
          const Vector6d step = h * basis.col(c);
          return Eigen::Matrix<double, 1, 1>(
              SampsonError(Perturbed(*pair.truth, step), pair.rig, m));
        },
        1e-4)(0);
  }
  return row;
}

// The matches with an error below kBoundSigmas sigma at the truth, in front of their cameras.
std::vector<Match> GatedMatches(const FramePair& pair) {
  const GroupedMatches matches(pair.rig, pair.matches);
  std::vector<double> errors;
  std::vector<char> inliers;
  matches.SelectInliers(*pair.truth, kBoundSigmas * *pair.noise_px, &errors, &inliers);
  std::vector<Match> selected;
  for (int k = 0; k < matches.size(); ++k) {
    if (inliers[k]) selected.push_back(matches.matches()[k]);
  }
  return selected;
}

// J'J of the Sampson errors over the variance; with `noisy` less what noise of the pixels adds.
Eigen::MatrixXd NumericInformation(const FramePair& pair, const std::vector<Match>& matches,
                                   bool noisy, const Eigen::MatrixXd& basis) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(basis.cols(), basis.cols());
  const double variance = *pair.noise_px * *pair.noise_px;
  for (const Match& m : matches) {
    const Eigen::VectorXd row = NumericRow(pair, m, basis);
    information += row * row.transpose() / variance;
    for (int coordinate = 0; noisy && coordinate < 4; ++coordinate) {
      const Eigen::VectorXd change = CentralDifference(
          [&](double h) {
            Match moved = m;
            (coordinate < 2 ? moved.pixel1 : moved.pixel2)(coordinate % 2) += h;
            return NumericRow(pair, moved, basis);
          },
          1e-2);
      information -= change * change.transpose();
    }
  }
  return information;
}

// Of log |b| with a standard deviation of 1, b = R c + t - c of the rig's centre c: by differences.
Eigen::MatrixXd WeakLength(const FramePair& pair) {
  const Eigen::Vector3d c = RigCentre(pair.rig);
  Eigen::VectorXd row(6);
  for (int k = 0; k < 6; ++k) {
    row(k) = CentralDifference(
        [&](double h) {
          Vector6d step = Vector6d::Zero();
          step(k) = h;
          const Pose moved = Perturbed(*pair.truth, step);
          return Eigen::Matrix<double, 1, 1>(std::log((moved.R * c + moved.t - c).norm()));
        },
        1e-3)(0);
  }
  return row * row.transpose();
}

// Columns: the free directions at the truth, from the description in the header. Of the body by
// those of the rig's centre, whose motion is fitted.
Eigen::MatrixXd OfBody(const FramePair& pair, const Eigen::MatrixXd& of_centre) {
  const Eigen::Matrix<double, 6, 6> jacobian =
      BodyFromPointJacobian(pair.truth->R, RigCentre(pair.rig));
  return jacobian * of_centre;
}

Eigen::MatrixXd Basis(const Eigen::MatrixXd& rotation, const Eigen::MatrixXd& translation) {
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(6, rotation.cols() + translation.cols());
  basis.topLeftCorner(3, rotation.cols()) = rotation;
  basis.bottomRightCorner(3, translation.cols()) = translation;
  return basis;
}

void ExpectIs(const CramerRaoBound& bound, const FramePair& pair, const Eigen::MatrixXd& basis,
              const Eigen::MatrixXd& information, double tolerance = 1e-5) {
  const Matrix6d expected = basis * information.inverse() * basis.transpose();
  EXPECT_LT((bound.covariance - expected).norm(), tolerance * expected.norm());
  EXPECT_NEAR(bound.rotation, std::sqrt(expected.block<3, 3>(0, 0).trace()),
              tolerance * bound.rotation);
  const auto direction = [](const Eigen::Matrix3d& of, const Eigen::Vector3d& t) {
    const Eigen::Vector3d d = t.normalized();
    const Eigen::Matrix3d off = Eigen::Matrix3d::Identity() - d * d.transpose();
    return std::sqrt((off * of * off).trace()) / t.norm();
  };
  EXPECT_NEAR(bound.direction, direction(expected.block<3, 3>(3, 3), pair.truth->t),
              tolerance * bound.direction);
  const Eigen::Vector3d c = RigCentre(pair.rig);
  const Matrix6d of_centre = BodyFromPointJacobian(pair.truth->R, -c) * expected *
                             BodyFromPointJacobian(pair.truth->R, -c).transpose();
  EXPECT_NEAR(bound.rig_direction,
              direction(of_centre.block<3, 3>(3, 3), MotionOfPoint(*pair.truth, c).t),
              tolerance * bound.rig_direction);
}

void ExpectBound(const RefineOptions& options, const FramePair& pair, const Eigen::MatrixXd& basis,
                 const Eigen::MatrixXd& more_information) {
  const auto bound = ComputeCramerRaoBound(options, pair);
  ASSERT_TRUE(bound.has_value());
  ExpectIs(*bound, pair, basis,
           NumericInformation(pair, GatedMatches(pair), true, basis) +
               basis.transpose() * more_information * basis);
}

TEST(CramerRao, MatchesNumericDifferentiationForEachForm) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(6, 6);
  for (int index = 0; index < 5; ++index) {
    for (const double inter_share : {0.5, 0.0}) {
      // Little noise: enough for the correction to show, and a bound for each form.
      SceneOptions scene = Scene(inter_share, MotionPattern::kPlanar);
      scene.noise_px = 0.2;
      const FramePair pair = MeasuredPair(scene, index);
      const Eigen::MatrixXd weak = WeakLength(pair);
      RefineOptions options;
      ExpectBound(options, pair, Basis(I, I), weak);
      // A depth form frees what kFull does, before its reference takes something away.
      options.form = RefineForm::kDepths;
      ExpectBound(options, pair, Basis(I, I), weak);
      for (const RefineForm form : {RefineForm::kPrior, RefineForm::kPriorDepths}) {
        options.form = form;
        options.prior_kind = PriorKind::kVertical;
        ExpectBound(options, pair, OfBody(pair, Basis(*pair.prior.gravity2, I)), weak);
        options.prior_kind = PriorKind::kAxis;
        ExpectBound(options, pair, OfBody(pair, Basis(*pair.prior.axis, I)), weak);
        options.prior_kind = PriorKind::kPlanar;
        const Eigen::Vector3d n = *pair.prior.normal;
        ExpectBound(options, pair, OfBody(pair, Basis(n, TangentBasis(n))), weak);
      }
      // |t| of the body is known.
      options = RefineOptions();
      options.hold_distance = true;
      ExpectBound(options, pair, Basis(I, TangentBasis(pair.truth->t.normalized())), none);
    }
  }
}

// J at the exact pixels, of the inliers that the column states, whatever the noise is.
TEST(CramerRao, IsThatOfTheExactPixelsWhereTheyAreKnown) {
  for (const double noise_px : {0.5, 3.0}) {
    SceneOptions scene = Scene(0.5, MotionPattern::kForward);
    scene.outlier_share = 0.0;
    const FramePair exact = ExactPair(scene, 2);
    FramePair pair = WithNoise(exact, noise_px, 2);
    std::vector<Match> inliers = exact.matches;
    for (size_t k = 0; k < 10; ++k) pair.columns.inlier[k] = 0;
    inliers.erase(inliers.begin(), inliers.begin() + 10);
    const auto bound = ComputeCramerRaoBound(RefineOptions(), pair);
    ASSERT_TRUE(bound.has_value());
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(6, 6);
    ExpectIs(*bound, pair, I, NumericInformation(pair, inliers, false, I) + WeakLength(pair));
  }
}

// Sensors do not move with the cameras: with the body's origin far off the bound is of that body.
TEST(CramerRao, IsOfAnyBodyOrigin) {
  FramePair pair = ExactPair(Scene(0.0, MotionPattern::kForward), 3);
  const Eigen::Vector3d origin(0.3, -0.5, 4.0);
  pair.rig = WithOrigin(pair.rig, origin);
  pair.truth = MotionOfPoint(*pair.truth, origin);
  pair = WithNoise(pair, 0.5, 3);
  const auto bound = ComputeCramerRaoBound(RefineOptions(), pair);
  ASSERT_TRUE(bound.has_value());
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(6, 6);
  std::vector<Match> exact = pair.matches;
  for (size_t k = 0; k < exact.size(); ++k) {
    exact[k].pixel1 = {pair.columns.exact[k][0], pair.columns.exact[k][1]};
    exact[k].pixel2 = {pair.columns.exact[k][2], pair.columns.exact[k][3]};
  }
  ExpectIs(*bound, pair, I, NumericInformation(pair, exact, false, I) + WeakLength(pair));
}

// A distance is a measurement of |t|, with or without use_prior.
TEST(CramerRao, AStatedDistanceAddsItsInformation) {
  FramePair pair = MeasuredPair(Scene(0.0, MotionPattern::kForward), 1);
  pair.prior.distance = pair.truth->t.norm();
  const auto without = ComputeCramerRaoBound(RefineOptions(), pair);
  pair.prior.distance_sigma = 0.01;
  Eigen::MatrixXd more = WeakLength(pair);
  const Eigen::Vector3d d = pair.truth->t.normalized();
  more.bottomRightCorner(3, 3) += d * d.transpose() / (0.01 * 0.01);
  ExpectBound(RefineOptions(), pair, Eigen::MatrixXd::Identity(6, 6), more);
  const auto with = ComputeCramerRaoBound(RefineOptions(), pair);
  EXPECT_GT(without->relative_scale, 0.1);
  EXPECT_LT(with->relative_scale, 0.011);
}

// Gravity of sigma s on both directions: R g1 is known to sqrt(2) s across itself.
TEST(CramerRao, APriorOfKnownSigmaAddsItsInformation) {
  FramePair pair = MeasuredPair(Scene(0.5, MotionPattern::kRandom), 1);
  const double sigma = DegToRad(0.01);
  pair.prior.gravity_sigma = sigma;
  RefineOptions options;
  options.prior_kind = PriorKind::kVertical;
  const auto without = ComputeCramerRaoBound(options, pair);
  options.use_prior = true;
  Eigen::MatrixXd more = WeakLength(pair);
  const Eigen::Vector3d g = *pair.prior.gravity2;
  more.topLeftCorner(3, 3) +=
      (Eigen::Matrix3d::Identity() - g * g.transpose()) / (2 * sigma * sigma);
  ExpectBound(options, pair, Eigen::MatrixXd::Identity(6, 6), more);
  EXPECT_LT(ComputeCramerRaoBound(options, pair)->rotation, 0.8 * without->rotation);
}

// A match that is listed again says nothing new.
TEST(CramerRao, ARepeatedMatchCountsOnce) {
  for (const bool exact : {true, false}) {
    FramePair pair = ExactPair(Scene(0.5, MotionPattern::kRandom), 1);
    pair = WithNoise(pair, 0.5, 1);
    if (!exact) pair.columns = MatchColumns();
    const auto bound = ComputeCramerRaoBound(RefineOptions(), pair);
    FramePair twice = pair;
    twice.matches.insert(twice.matches.end(), pair.matches.begin(), pair.matches.end());
    for (size_t k = 0; exact && k < pair.matches.size(); ++k) {
      twice.columns.inlier.push_back(1);
      twice.columns.exact.push_back(pair.columns.exact[k]);
    }
    const auto again = ComputeCramerRaoBound(RefineOptions(), twice);
    ASSERT_TRUE(bound && again);
    EXPECT_LT((again->covariance - bound->covariance).norm(), 1e-9 * bound->covariance.norm());
  }
}

// Rows of one key point: the weighted fit of least variance, by the covariance of their errors that
// differences give.
TEST(CramerRao, SharedPixelsCorrelate) {
  SceneOptions scene = Scene(0.5, MotionPattern::kRandom);
  scene.outlier_share = 0.0;
  FramePair pair = ExactPair(scene, 4);
  // Another match of each first pixel: in the other camera at time 2, wherever that is.
  const size_t n = pair.matches.size();
  for (size_t k = 0; k < n; ++k) {
    Match m = pair.matches[k];
    m.camera2 = 1 - m.camera2;
    const RigCamera& camera1 = pair.rig.cameras[m.camera1];
    const RigCamera& camera2 = pair.rig.cameras[m.camera2];
    const Eigen::Vector3d x = AlongRay(camera1.intrinsics, m.pixel1);
    const Eigen::Vector3d X = pair.truth->R * (camera1.Q * (12.0 * x) + camera1.s) + pair.truth->t;
    const Eigen::Vector3d p = camera2.Q.transpose() * (X - camera2.s);
    m.pixel2 = {camera2.intrinsics.fx() * p.x() / p.z() + camera2.intrinsics.cx(),
                camera2.intrinsics.fy() * p.y() / p.z() + camera2.intrinsics.cy()};
    pair.matches.push_back(m);
  }
  pair.columns.inlier.assign(2 * n, 1);
  pair.columns.exact.clear();
  for (const Match& m : pair.matches) {
    pair.columns.exact.push_back({m.pixel1.x(), m.pixel1.y(), m.pixel2.x(), m.pixel2.y()});
  }
  const auto by_pixel = [&](const Match& m, int coordinate) {
    return CentralDifference(
        [&](double h) {
          Match moved = m;
          moved.pixel1(coordinate) += h;
          return Eigen::Matrix<double, 1, 1>(SampsonError(*pair.truth, pair.rig, moved));
        },
        1e-2)(0);
  };
  pair.noise_px = 0.5;
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(6, 6);
  Eigen::MatrixXd information = WeakLength(pair);
  for (size_t k = 0; k < n; ++k) {
    const Match &a = pair.matches[k], &b = pair.matches[n + k];
    Eigen::MatrixXd J(6, 2);
    J << NumericRow(pair, a, I), NumericRow(pair, b, I);
    const double covariance = by_pixel(a, 0) * by_pixel(b, 0) + by_pixel(a, 1) * by_pixel(b, 1);
    Eigen::Matrix2d S;
    S << 1.0, covariance, covariance, 1.0;
    information += J * S.inverse() * J.transpose() / (0.5 * 0.5);
  }
  const auto bound = ComputeCramerRaoBound(RefineOptions(), pair);
  ASSERT_TRUE(bound.has_value());
  ExpectIs(*bound, pair, I, information, 1e-4);
  // Too many rows of one pixel: none.
  for (Match& m : pair.matches) {
    m.camera1 = 0;
    m.pixel1 = pair.matches[0].pixel1;
  }
  EXPECT_TRUE(ComputeCramerRaoBound(RefineOptions(), pair).has_value());
  const FramePair fewer = pair;
  for (int times = 0; times < 2; ++times) {
    pair.matches.insert(pair.matches.end(), fewer.matches.begin(), fewer.matches.end());
    pair.columns.inlier.insert(pair.columns.inlier.end(), 2 * n, 1);
    pair.columns.exact.insert(pair.columns.exact.end(), fewer.columns.exact.begin(),
                              fewer.columns.exact.end());
  }
  EXPECT_FALSE(ComputeCramerRaoBound(RefineOptions(), pair).has_value());
}

TEST(CramerRao, ThereIsNoneWithoutTruthNoiseOrInformation) {
  const FramePair pair = MeasuredPair(Scene(0.5, MotionPattern::kRandom), 1);
  FramePair without = pair;
  without.truth.reset();
  EXPECT_FALSE(ComputeCramerRaoBound(RefineOptions(), without).has_value());
  without = pair;
  without.noise_px.reset();
  EXPECT_FALSE(ComputeCramerRaoBound(RefineOptions(), without).has_value());
  without = pair;
  without.matches.resize(3);
  EXPECT_FALSE(ComputeCramerRaoBound(RefineOptions(), without).has_value());
  without.matches.clear();
  EXPECT_FALSE(ComputeCramerRaoBound(RefineOptions(), without).has_value());
  without = pair;
  without.matches[0].camera1 = 9;
  EXPECT_FALSE(ComputeCramerRaoBound(RefineOptions(), without).has_value());
  RefineOptions planar;
  planar.form = RefineForm::kPrior;
  planar.prior_kind = PriorKind::kPlanar;  // and no normal
  EXPECT_FALSE(ComputeCramerRaoBound(planar, pair).has_value());
}

}  // namespace
}  // namespace rigel
