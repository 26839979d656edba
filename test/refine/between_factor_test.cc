// Between factors: the perturbations and errors of GTSAM and g2o, written out as their sources
// define them, against the Jacobians, the covariances and the information.
#include "rigel/refine/between_factor.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "rigel/core/rig_centre.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

// Log of SE(3), (w, v): Exp(w), V(w) v with the left Jacobian V.
Vector6d LogSE3(const Pose& pose) {
  Vector6d xi;
  xi.head<3>() = LogSO3(pose.R);
  xi.tail<3>() = LeftJacobianSO3(xi.head<3>()).inverse() * pose.t;
  return xi;
}

// internal::toVectorMQT of g2o: the translation, then the vector part of the unit quaternion, w >=
// 0.
Vector6d ToVectorMQT(const Pose& pose) {
  Vector6d v;
  v << pose.t, pose.Quaternion().vec();
  return v;
}

// The perturbation that leads from the inverse of `pose` to that of `other`.
Vector6d GtsamDifference(const Pose& other, const Pose& pose) {
  return LogSE3(pose * other.Inverse());
}
Vector6d G2oDifference(const Pose& other, const Pose& pose) {
  return ToVectorMQT(pose * other.Inverse());
}

// Rotations of any size; every fourth nearly none, every fourth nearly half a turn.
Pose RandomPose(int index, Random* random) {
  const double angles[] = {random->Uniform(0, kPi), std::pow(10.0, random->Uniform(-12, -3)),
                           random->Uniform(0, kPi), kPi - std::pow(10.0, random->Uniform(-12, -3))};
  Pose pose;
  pose.R = ExpSO3(angles[index % 4] * random->UnitVector3());
  pose.t = RandomVector3(0.1, 5.0, random);
  return pose;
}

// Anisotropic and correlated; standard deviations of a few `sigma`, metres ten times radians.
Matrix6d RandomCovariance(double sigma, Random* random) {
  Matrix6d root;
  for (int k = 0; k < 6; ++k) root.col(k) << random->NormalVector3(), random->NormalVector3();
  root.topRows<3>() *= sigma;
  root.bottomRows<3>() *= 10 * sigma;
  return root * root.transpose();
}

double SmallestEigenvalue(const Matrix6d& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(m).eigenvalues()(0);
}

TEST(BetweenFactor, JacobiansMatchNumericDifferentiation) {
  Random random(1);
  double worst = 0.0;
  for (int index = 0; index < 200; ++index) {
    const Pose pose = RandomPose(index, &random);
    Matrix6d gtsam, g2o;
    constexpr double kStep = 1e-4;
    for (int c = 0; c < 6; ++c) {
      const auto at = [&](double h) { return Perturbed(pose, h * Vector6d::Unit(c)); };
      gtsam.col(c) =
          (GtsamDifference(at(kStep), pose) - GtsamDifference(at(-kStep), pose)) / (2 * kStep);
      g2o.col(c) = (G2oDifference(at(kStep), pose) - G2oDifference(at(-kStep), pose)) / (2 * kStep);
    }
    worst = std::max({worst, (GtsamJacobian(pose) - gtsam).cwiseAbs().maxCoeff(),
                      (G2oJacobian(pose) - g2o).cwiseAbs().maxCoeff()});
  }
  EXPECT_LT(worst, 1e-7);
  RecordProperty("worst_times_1e12", std::to_string(1e12 * worst));
}

TEST(BetweenFactor, MeasurementIsThePoseOfFrame2InFrame1) {
  Random random(2);
  for (int index = 0; index < 50; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d covariance = RandomCovariance(1e-3, &random);
    for (const Pose& measurement : {G2oEdge(pose, covariance).measurement,
                                    GtsamBetweenFactor(pose, covariance).measurement}) {
      // A point seen from frame 2 is where it was seen from frame 1.
      const Eigen::Vector3d X1 = 10 * random.NormalVector3();
      EXPECT_LT((measurement * (pose * X1) - X1).norm(), 1e-13);
      EXPECT_LT(Difference(measurement.Inverse(), pose).norm(), 1e-13);
    }
  }
}

TEST(BetweenFactor, FullRankInformationIsTheInverseOfTheCovariance) {
  Random random(3);
  for (int index = 0; index < 100; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d covariance = RandomCovariance(1e-3, &random);
    for (const BetweenFactor& factor :
         {G2oEdge(pose, covariance), GtsamBetweenFactor(pose, covariance)}) {
      EXPECT_EQ(factor.information, factor.information.transpose());
      EXPECT_EQ(factor.covariance, factor.covariance.transpose());
      const Matrix6d product = factor.covariance * factor.information * factor.covariance;
      EXPECT_LT((product - factor.covariance).norm(), 1e-7 * factor.covariance.norm());
    }
    // There and back.
    for (const Matrix6d& J : {GtsamJacobian(pose), G2oJacobian(pose)}) {
      const Matrix6d back =
          J.inverse() * (J * covariance * J.transpose()) * J.inverse().transpose();
      EXPECT_LT((back - covariance).norm(), 1e-12 * covariance.norm());
    }
    const Matrix6d J = G2oJacobian(pose);
    const Matrix6d G = GtsamJacobian(pose);
    const Matrix6d expected = PseudoInformation(covariance);
    EXPECT_LT((J.transpose() * G2oEdge(pose, covariance).information * J - expected).norm(),
              1e-9 * expected.norm());
    EXPECT_LT(
        (G.transpose() * GtsamBetweenFactor(pose, covariance).information * G - expected).norm(),
        1e-9 * expected.norm());
  }
}

TEST(BetweenFactor, G2oInformationIsGtsamsInItsOrderAndHalfAngle) {
  Random random(4);
  const Pose pose = RandomPose(0, &random);
  const Matrix6d covariance = RandomCovariance(1e-3, &random);
  const Matrix6d gtsam = GtsamBetweenFactor(pose, covariance).information;
  const Matrix6d g2o = G2oEdge(pose, covariance).information;
  const double tolerance = 1e-10 * gtsam.norm();
  EXPECT_LT((g2o.block<3, 3>(0, 0) - gtsam.block<3, 3>(3, 3)).norm(), tolerance);
  EXPECT_LT((g2o.block<3, 3>(3, 3) - 4 * gtsam.block<3, 3>(0, 0)).norm(), tolerance);
  EXPECT_LT((g2o.block<3, 3>(0, 3) - 2 * gtsam.block<3, 3>(3, 0)).norm(), tolerance);
}

// Motions drawn with Rigel's covariance, inverted, compared in the back end's perturbation. The
// whitened sample covariance of n samples is the identity within sqrt(2 / n) per entry (standard
// deviation, on the diagonal); five of them for 72 entries.
TEST(BetweenFactor, CovarianceIsThatOfMappedSamples) {
  constexpr int kSamples = 20000;
  Random random(5);
  for (int index = 0; index < 4; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d covariance = RandomCovariance(1e-4, &random);
    const Matrix6d root = covariance.llt().matrixL();
    const Matrix6d gtsam_whiten =
        Matrix6d(GtsamBetweenFactor(pose, covariance).covariance.llt().matrixL()).inverse();
    const Matrix6d g2o_whiten =
        Matrix6d(G2oEdge(pose, covariance).covariance.llt().matrixL()).inverse();
    Matrix6d gtsam = Matrix6d::Zero();
    Matrix6d g2o = Matrix6d::Zero();
    for (int k = 0; k < kSamples; ++k) {
      Vector6d normal;
      normal << random.NormalVector3(), random.NormalVector3();
      const Pose sample = Perturbed(pose, root * normal);
      const Vector6d x = gtsam_whiten * GtsamDifference(sample, pose);
      const Vector6d y = g2o_whiten * G2oDifference(sample, pose);
      gtsam += x * x.transpose() / kSamples;
      g2o += y * y.transpose() / kSamples;
    }
    const double limit = 5 * std::sqrt(2.0 / kSamples);
    EXPECT_LT((gtsam - Matrix6d::Identity()).cwiseAbs().maxCoeff(), limit) << index;
    EXPECT_LT((g2o - Matrix6d::Identity()).cwiseAbs().maxCoeff(), limit) << index;
  }
}

// An edge of g2o between two vertices whose relative pose is off by (d, e) in Rigel's terms.
double G2oChi2(const BetweenFactor& edge, const Pose& f2_from_f1, Random* random) {
  const Pose world_from_1 = RandomPose(0, random);
  const Pose world_from_2 = world_from_1 * f2_from_f1.Inverse();
  const Vector6d error =
      ToVectorMQT(edge.measurement.Inverse() * (world_from_1.Inverse() * world_from_2));
  return error.dot(edge.information * error);
}

TEST(BetweenFactor, Chi2OfAPerturbedG2oEdgeIsTheMahalanobisDistance) {
  Random random(6);
  for (int index = 0; index < 100; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d covariance = RandomCovariance(1e-3, &random);
    const BetweenFactor edge = G2oEdge(pose, covariance);
    double previous = std::numeric_limits<double>::infinity();
    Vector6d normal;
    normal << random.NormalVector3(), random.NormalVector3();
    const Matrix6d root = covariance.llt().matrixL();
    for (const double size : {1e-2, 1e-3, 1e-4}) {
      const Pose other = Perturbed(pose, size * (root * normal));
      const double expected = size * size * normal.squaredNorm();
      const double relative = std::abs(G2oChi2(edge, other, &random) / expected - 1.0);
      // First order: the relative error falls with the size, until rounding is left.
      EXPECT_LT(relative, std::max(0.2 * previous, 1e-5)) << index << " " << size;
      previous = relative;
    }
    EXPECT_LT(previous, 1e-5) << index;
  }
}

RefineSummary SummaryOf(const Matrix6d& covariance, bool length_held) {
  RefineSummary summary;
  summary.termination = Termination::kConverged;
  summary.covariance = covariance;
  summary.length_held = length_held;
  summary.length_sigma = length_held ? 0.0 : 0.01;
  summary.rotation_observable = true;
  summary.translation_observable = true;
  summary.scale_observable = !length_held;
  return summary;
}

TEST(BetweenFactor, HeldLengthHasNoInformation) {
  Random random(7);
  for (int index = 0; index < 100; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d full = RandomCovariance(1e-3, &random).inverse();
    const MotionBasis basis = FullBasis(pose, false);
    Matrix6d covariance;
    ASSERT_TRUE(CovarianceOfBasis(full, basis, &covariance));
    const RefineSummary summary = SummaryOf(covariance, true);
    const Matrix6d information = InformationMatrix(summary, pose);
    Vector6d along = Vector6d::Zero();
    along.tail<3>() = pose.t.normalized();
    EXPECT_LT((information * along).norm(), 1e-14 * information.norm());
    EXPECT_GT(SmallestEigenvalue(information), -1e-14 * information.norm());
    // That of the free directions, and the pseudo-inverse says so as well.
    const Eigen::MatrixXd expected = basis.transpose() * full * basis;
    EXPECT_LT((basis.transpose() * information * basis - expected).norm(), 1e-8 * expected.norm());
    EXPECT_LT((PseudoInformation(covariance) - information).norm(), 1e-9 * information.norm());

    // Along t nothing is lost whatever the back end does; across, chi2 is Rigel's distance.
    const BetweenFactor edge = G2oEdge(pose, summary);
    Pose longer = pose;
    longer.t *= 3.0;
    const Pose across = Perturbed(pose, 1e-5 * (covariance * full * Vector6d::Ones()).normalized());
    const Vector6d d = Difference(across, pose);
    const double distance = d.dot(information * d);
    EXPECT_LT(G2oChi2(edge, longer, &random), 1e-9 * information.norm());
    EXPECT_NEAR(G2oChi2(edge, across, &random), distance, 1e-3 * distance);
    EXPECT_GT(SmallestEigenvalue(edge.information), -1e-14 * edge.information.norm());

    const Matrix6d S = SqrtInformation(GtsamBetweenFactor(pose, summary).information);
    const Matrix6d gtsam = GtsamBetweenFactor(pose, summary).information;
    EXPECT_LT((S.transpose() * S - gtsam).norm(), 1e-10 * gtsam.norm());
    EXPECT_TRUE(S.isUpperTriangular(0.0));
    EXPECT_TRUE(S.allFinite());
  }
}

TEST(BetweenFactor, TranslationThatIsNotObservableHasNoInformation) {
  Random random(8);
  for (int index = 0; index < 100; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d covariance = RandomCovariance(1e-3, &random);
    RefineSummary summary = SummaryOf(covariance, true);
    summary.translation_observable = false;
    const Matrix6d information = InformationMatrix(summary, pose);
    EXPECT_EQ(information.bottomRows<3>().norm(), 0.0);
    EXPECT_EQ(information.rightCols<3>().norm(), 0.0);
    // The marginal of the rotation.
    const Eigen::Matrix3d expected = covariance.block<3, 3>(0, 0).inverse();
    EXPECT_LT((information.block<3, 3>(0, 0) - expected).norm(), 1e-8 * expected.norm());

    const BetweenFactor edge = G2oEdge(pose, summary);
    EXPECT_EQ(edge.information.topRows<3>().norm(), 0.0);
    EXPECT_LT((edge.information.block<3, 3>(3, 3) - 4 * expected).norm(), 1e-8 * expected.norm());
    const BetweenFactor factor = GtsamBetweenFactor(pose, summary);
    EXPECT_EQ(factor.information.bottomRows<3>().norm(), 0.0);
    EXPECT_TRUE(SqrtInformation(factor.information).allFinite());
  }
}

TEST(BetweenFactor, ExactPriorLeavesTheRestWithoutInformation) {
  Random random(9);
  for (int index = 0; index < 50; ++index) {
    const Pose pose = RandomPose(index, &random);
    const Matrix6d full = RandomCovariance(1e-3, &random).inverse();
    // Rotation about one axis, t free or of held length.
    MotionBasis basis(6, 4);
    basis.setZero();
    basis.block<3, 1>(0, 0) = random.UnitVector3();
    basis.block<3, 3>(3, 1).setIdentity();
    Matrix6d covariance;
    ASSERT_TRUE(CovarianceOfBasis(full, basis, &covariance));
    const Matrix6d information = InformationMatrix(SummaryOf(covariance, false), pose);
    const Eigen::MatrixXd expected = basis.transpose() * full * basis;
    EXPECT_LT((basis.transpose() * information * basis - expected).norm(), 1e-8 * expected.norm());
    const Eigen::Matrix<double, 3, 2> held = TangentBasis(basis.block<3, 1>(0, 0));
    EXPECT_LT((information.leftCols<3>() * held).norm(), 1e-9 * information.norm());
  }
}

TEST(BetweenFactor, NothingKnownIsZero) {
  const Pose pose;
  EXPECT_EQ(InformationMatrix(RefineSummary(), pose), Matrix6d(Matrix6d::Zero()));
  RefineSummary summary = SummaryOf(Matrix6d::Identity(), false);
  EXPECT_EQ(InformationMatrix(summary, pose), Matrix6d(Matrix6d::Identity()));
  summary.rotation_observable = false;
  EXPECT_EQ(InformationMatrix(summary, pose), Matrix6d(Matrix6d::Zero()));
  summary = SummaryOf(Matrix6d::Identity(), false);
  summary.covariance.reset();
  EXPECT_EQ(G2oEdge(pose, summary).information, Matrix6d(Matrix6d::Zero()));
  EXPECT_EQ(PseudoInformation(Matrix6d::Zero()), Matrix6d(Matrix6d::Zero()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(PseudoInformation(Matrix6d::Constant(nan)), Matrix6d(Matrix6d::Zero()));
  EXPECT_EQ(SqrtInformation(Matrix6d::Zero()), Matrix6d(Matrix6d::Zero()));
}

// The whole way: matches within single cameras do not determine the length of the rig's motion,
// those between cameras do.
TEST(BetweenFactor, OfRefinedMotions) {
  for (const bool inter : {false, true}) {
    for (int index = 0; index < 10; ++index) {
      SceneOptions options;
      options.inter_share = inter ? 0.5 : 0.0;
      const FramePair pair = ScenePair(options, index);
      RefineOptions refine;
      refine.noise_px = pair.noise_px;
      Pose pose = *pair.truth;
      const RefineSummary summary = Refine(refine, pair.rig, pair.matches, pair.prior, &pose);
      ASSERT_TRUE(summary.IsSolutionUsable());
      ASSERT_TRUE(summary.translation_observable);
      const BetweenFactor edge = G2oEdge(pose, summary);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(edge.information);
      const double largest = eigen.eigenvalues()(5);
      EXPECT_EQ(summary.length_sigma <= kMaxLengthSigma, inter) << index;
      EXPECT_EQ(eigen.eigenvalues()(0) > 1e-13 * largest, inter) << index;
      EXPECT_GT(eigen.eigenvalues()(0), -1e-13 * largest);
      EXPECT_GT(eigen.eigenvalues()(1), 1e-10 * largest);
      if (inter) {
        // The truth is a few sigma away: 6 degrees of freedom.
        Random random(1);
        EXPECT_LT(G2oChi2(edge, *pair.truth, &random), 40.0);
      } else {
        // The direction without information is that of b, the motion of the rig's centre.
        Pose longer = MotionOfPoint(pose, summary.rig_center);
        longer.t *= 1.1;
        const Vector6d d = Difference(MotionOfBody(longer, summary.rig_center), pose);
        EXPECT_LT((InformationMatrix(summary, pose) * d).norm(), 1e-9 * largest * d.norm());
      }
    }
  }
}

}  // namespace
}  // namespace rigel
