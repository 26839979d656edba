// The prior as residuals: which there are, their derivatives, and that a sigma means what it says.
#include "rigel/refine/least_squares/prior_residuals.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

Pose RandomPose(Random* random) {
  Pose pose;
  pose.R = ExpSO3(RandomVector3(0.0, 3.1, random));
  pose.t = RandomVector3(0.1, 3.0, random);
  return pose;
}

TEST(PriorResiduals, OnlyPartsWithASigmaGiveResiduals) {
  Random random(1);
  const MotionPrior full = FullPrior(&random);
  const Pose pose = RandomPose(&random);
  EXPECT_EQ(PriorResiduals().size(), 0);
  // One of the distance with each of them.
  EXPECT_EQ(PriorResiduals(full, PriorKind::kNone, pose).size(), 1);
  EXPECT_EQ(PriorResiduals(full, PriorKind::kVertical, pose).size(), 3);
  EXPECT_EQ(PriorResiduals(full, PriorKind::kAxis, pose).size(), 3);
  EXPECT_EQ(PriorResiduals(full, PriorKind::kPlanar, pose).size(), 4);
  // At t = 0 a plane says nothing of the direction of t.
  EXPECT_EQ(PriorResiduals(full, PriorKind::kPlanar, Pose()).size(), 3);

  MotionPrior silent = full;
  silent.gravity_sigma.reset();
  silent.axis_sigma.reset();
  silent.normal_sigma.reset();
  silent.distance_sigma = 0.0;
  MotionPrior empty;
  empty.gravity_sigma = empty.axis_sigma = empty.normal_sigma = 0.01;
  for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
    for (const MotionPrior& prior : {silent, empty}) {
      const PriorResiduals residuals(prior, kind, pose);
      EXPECT_EQ(residuals.size(), 0);
      PriorResiduals::Residuals r;
      PriorResiduals::Jacobian J;
      residuals.Evaluate(pose, &r, &J);
      EXPECT_EQ(r.size(), 0);
      EXPECT_EQ(J.rows(), 0);
    }
  }
}

TEST(PriorResiduals, JacobianMatchesNumericDifferentiation) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Random random = Random::Stream(5, seed);
    const MotionPrior prior = FullPrior(&random);
    const Pose start = RandomPose(&random);
    const Pose pose = RandomPose(&random);
    for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
      const PriorResiduals residuals(prior, kind, start);
      PriorResiduals::Residuals r;
      PriorResiduals::Jacobian J;
      residuals.Evaluate(pose, &r, &J);
      ASSERT_EQ(J.rows(), r.size());
      for (int c = 0; c < 6; ++c) {
        const PriorResiduals::Residuals numeric = CentralDifference(
            [&](double h) {
              PriorResiduals::Residuals at;
              residuals.Evaluate(Perturbed(pose, h * Vector6d::Unit(c)), &at, nullptr);
              return at;
            },
            1e-3);
        EXPECT_LT((J.col(c) - numeric).norm(), 1e-8 * (1 + J.norm())) << "column " << c;
      }
    }
  }
}

TEST(PriorResiduals, VanishWhereThePriorHolds) {
  Random random(3);
  const Eigen::Vector3d axis = random.UnitVector3();
  Pose pose;
  pose.R = ExpSO3(0.7 * axis);
  pose.t = axis.cross(random.UnitVector3());
  MotionPrior prior;
  prior.gravity1 = random.UnitVector3();
  prior.gravity2 = pose.R * *prior.gravity1;
  prior.axis = prior.normal = axis;
  prior.gravity_sigma = prior.axis_sigma = prior.normal_sigma = 1e-3;
  for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
    const PriorResiduals residuals(prior, kind, pose);
    PriorResiduals::Residuals r;
    residuals.Evaluate(pose, &r, nullptr);
    EXPECT_LT(r.norm(), 1e-11);
  }
}

// A direction off by N(0, sigma) about each axis across it.
Eigen::Vector3d Disturbed(const Eigen::Vector3d& v, double sigma, Random* random) {
  return ExpSO3(sigma * random->NormalVector3()) * v;
}

// At the truth the residuals of a disturbed prior have variance one: only then do they weigh right
// against pixels. 20000 draws know a variance to 1 percent.
TEST(PriorResiduals, AreOfUnitVarianceUnderTheStatedSigma) {
  constexpr int kDraws = 20000;
  const double sigma = DegToRad(0.5);
  for (const double angle_deg : {2.0, 60.0, 150.0}) {
    Random random(11);
    const Eigen::Vector3d axis = random.UnitVector3();
    Pose pose;
    pose.R = ExpSO3(DegToRad(angle_deg) * axis);
    pose.t = 1.7 * axis.cross(random.UnitVector3()).normalized();
    const Eigen::Vector3d g1 = random.UnitVector3();
    for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
      Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();
      int size = 0;
      for (int i = 0; i < kDraws; ++i) {
        MotionPrior prior;
        prior.gravity1 = Disturbed(g1, sigma, &random);
        prior.gravity2 = Disturbed(pose.R * g1, sigma, &random);
        prior.axis = prior.normal = Disturbed(axis, sigma, &random);
        prior.gravity_sigma = prior.axis_sigma = prior.normal_sigma = sigma;
        const PriorResiduals residuals(prior, kind, pose);
        PriorResiduals::Residuals r;
        residuals.Evaluate(pose, &r, nullptr);
        size = static_cast<int>(r.size());
        for (int k = 0; k < size; ++k) second_moment(k, k) += r(k) * r(k);
      }
      ASSERT_EQ(size, kind == PriorKind::kPlanar ? 3 : 2);
      for (int k = 0; k < size; ++k) {
        EXPECT_NEAR(second_moment(k, k) / kDraws, 1.0, 0.05)
            << "kind " << static_cast<int>(kind) << ", residual " << k << ", " << angle_deg
            << " degrees";
      }
    }
  }
}

// Where there is next to no rotation the axis must not get an unbounded weight.
TEST(PriorResiduals, AnAxisOfNextToNoRotationIsWeighedAsThatOfTheSmallestAngle) {
  MotionPrior prior;
  prior.axis = Eigen::Vector3d::UnitY();
  prior.axis_sigma = 0.01;
  Pose still;
  PriorResiduals::Residuals r;
  PriorResiduals::Jacobian J;
  PriorResiduals(prior, PriorKind::kAxis, still).Evaluate(still, &r, &J);
  EXPECT_EQ(r.norm(), 0.0);
  EXPECT_NEAR(J.row(0).norm(), 1.0 / (0.01 * kMinAxisAngle), 1e-2);
  Pose half;
  half.R = ExpSO3(kPi * Eigen::Vector3d::UnitY());
  PriorResiduals(prior, PriorKind::kAxis, half).Evaluate(half, &r, &J);
  EXPECT_TRUE(J.allFinite());
  EXPECT_NEAR(J.row(0).norm(), 1.0 / (0.01 * 2.0), 0.2);
}

}  // namespace
}  // namespace rigel
