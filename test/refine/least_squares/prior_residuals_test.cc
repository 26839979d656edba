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

PriorParts Direction(PriorKind kind) {
  PriorParts parts;
  parts.direction = kind;
  return parts;
}

// One of the distance too.
PriorParts WithDistance(PriorKind kind) {
  PriorParts parts = Direction(kind);
  parts.distance = true;
  return parts;
}

constexpr PriorKind kDirections[] = {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar};

TEST(PriorResiduals, OnlyPartsWithASigmaGiveResiduals) {
  Random random(1);
  const MotionPrior full = FullPrior(&random);
  const Pose pose = RandomPose(&random);
  EXPECT_EQ(PriorResiduals().size(), 0);
  EXPECT_EQ(PriorResiduals(full, PriorParts(), pose).size(), 0);
  EXPECT_EQ(PriorResiduals(full, Direction(PriorKind::kPlanar), pose).size(), 3);
  EXPECT_EQ(PriorResiduals(full, WithDistance(PriorKind::kNone), pose).size(), 1);
  EXPECT_EQ(PriorResiduals(full, WithDistance(PriorKind::kVertical), pose).size(), 3);
  EXPECT_EQ(PriorResiduals(full, WithDistance(PriorKind::kAxis), pose).size(), 3);
  EXPECT_EQ(PriorResiduals(full, WithDistance(PriorKind::kPlanar), pose).size(), 4);
  // At t = 0 a plane says nothing of the direction of t.
  EXPECT_EQ(PriorResiduals(full, WithDistance(PriorKind::kPlanar), Pose()).size(), 3);
  // The weak length needs no prior.
  PriorParts all = WithDistance(PriorKind::kPlanar);
  all.typical_length = 1.0;
  EXPECT_EQ(PriorResiduals(full, all, pose).size(), kMaxPriorResiduals);
  EXPECT_EQ(PriorResiduals(MotionPrior(), all, pose).size(), 1);

  MotionPrior silent = full;
  silent.gravity_sigma.reset();
  silent.axis_sigma.reset();
  silent.normal_sigma.reset();
  silent.distance_sigma = 0.0;
  MotionPrior empty;
  empty.gravity_sigma = empty.axis_sigma = empty.normal_sigma = 0.01;
  for (const PriorKind kind : kDirections) {
    for (const MotionPrior& prior : {silent, empty}) {
      const PriorResiduals residuals(prior, WithDistance(kind), pose);
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
    for (const PriorKind kind : kDirections) {
      PriorParts parts = WithDistance(kind);
      parts.typical_length = random.Uniform(0.3, 3.0);
      Eigen::Vector3d::Map(parts.point.data()) = RandomVector3(0.0, 2.0, &random);
      const PriorResiduals residuals(prior, parts, start);
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
  for (const PriorKind kind : kDirections) {
    const PriorResiduals residuals(prior, Direction(kind), pose);
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
    for (const PriorKind kind : kDirections) {
      Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();
      int size = 0;
      for (int i = 0; i < kDraws; ++i) {
        MotionPrior prior;
        prior.gravity1 = Disturbed(g1, sigma, &random);
        prior.gravity2 = Disturbed(pose.R * g1, sigma, &random);
        prior.axis = prior.normal = Disturbed(axis, sigma, &random);
        prior.gravity_sigma = prior.axis_sigma = prior.normal_sigma = sigma;
        const PriorResiduals residuals(prior, Direction(kind), pose);
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
  PriorResiduals(prior, Direction(PriorKind::kAxis), still).Evaluate(still, &r, &J);
  EXPECT_EQ(r.norm(), 0.0);
  EXPECT_NEAR(J.row(0).norm(), 1.0 / (0.01 * kMinAxisAngle), 1e-2);
  Pose half;
  half.R = ExpSO3(kPi * Eigen::Vector3d::UnitY());
  PriorResiduals(prior, Direction(PriorKind::kAxis), half).Evaluate(half, &r, &J);
  EXPECT_TRUE(J.allFinite());
  EXPECT_NEAR(J.row(0).norm(), 1.0 / (0.01 * 2.0), 0.2);
}

// The distance is that of the body's origin, whatever point the motion is of.
TEST(PriorResiduals, TheDistanceIsThatOfTheBody) {
  Random random(12);
  MotionPrior prior;
  prior.distance = 1.2;
  prior.distance_sigma = 0.05;
  for (int i = 0; i < 20; ++i) {
    const Pose body = RandomPose(&random);
    const Eigen::Vector3d c = RandomVector3(0.1, 2.0, &random);
    PriorParts parts = WithDistance(PriorKind::kNone);
    Eigen::Vector3d::Map(parts.point.data()) = c;
    // The point with body coordinates c moves by R c + t - c.
    const Pose of_point = {body.R, body.R * c + body.t - c};
    PriorResiduals::Residuals r;
    PriorResiduals(prior, parts, of_point).Evaluate(of_point, &r, nullptr);
    ASSERT_EQ(r.size(), 1);
    EXPECT_NEAR(r(0), (body.t.norm() - 1.2) / 0.05, 1e-9);
    ASSERT_GT(std::abs(of_point.t.norm() - body.t.norm()), 1e-3);
  }
}

// One standard deviation is a factor of exp(kLengthSigma) either way, of the motion of the point.
TEST(PriorResiduals, TheWeakLengthIsALogarithm) {
  PriorParts parts;
  parts.typical_length = 0.4;
  parts.point = {5, 6, 7};
  Random random(13);
  for (const double sigmas : {-2.0, -1.0, 0.0, 1.0, 3.0}) {
    Pose pose = RandomPose(&random);
    pose.t = 0.4 * std::exp(kLengthSigma * sigmas) * random.UnitVector3();
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian J;
    PriorResiduals(MotionPrior(), parts, pose).Evaluate(pose, &r, &J);
    EXPECT_NEAR(r(0), sigmas, 1e-12);
    // Its information on log |b| does not depend on |b|.
    EXPECT_NEAR(J.row(0).tail<3>().dot(pose.t), 1.0 / kLengthSigma, 1e-12);
    EXPECT_EQ((J.row(0).head<3>().norm()), 0.0);
  }
}

}  // namespace
}  // namespace rigel
