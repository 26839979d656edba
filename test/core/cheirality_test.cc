#include "rigel/core/cheirality.h"

#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/random.h"

namespace rigel {
namespace {

using Eigen::Vector3d;

struct Problem {
  Pose pose;
  RayPair rays;
  double d1, d2;
};

// Rays that meet at the signed distances d1 and d2 from their cameras.
Problem MakeProblem(uint64_t seed, bool front1, bool front2) {
  Random random = Random::Stream(1, seed);
  Problem p;
  p.pose.R = ExpSO3(0.3 * random.NormalVector3());
  p.pose.t = random.NormalVector3();
  p.rays.ray1.s = random.NormalVector3();
  p.rays.ray2.s = random.NormalVector3();
  p.rays.ray1.x = random.UnitVector3();
  p.d1 = random.Uniform(3.0, 30.0) * (front1 ? 1.0 : -1.0);
  const Vector3d X2 = p.pose * (p.rays.ray1.s + p.d1 * p.rays.ray1.x);
  p.rays.ray2.x = (X2 - p.rays.ray2.s).normalized() * (front2 ? 1.0 : -1.0);
  p.d2 = (X2 - p.rays.ray2.s).dot(p.rays.ray2.x);
  return p;
}

TEST(Cheirality, DepthsAreTheTrueDistances) {
  for (int seed = 0; seed < 400; ++seed) {
    const Problem p = MakeProblem(seed, seed % 2 == 0, seed % 4 < 2);
    Depths depths;
    ASSERT_TRUE(TriangulateDepths(p.pose, p.rays, &depths));
    EXPECT_NEAR(depths.d1 / p.d1, 1.0, 1e-9) << seed;
    EXPECT_NEAR(depths.d2 / p.d2, 1.0, 1e-9) << seed;
    EXPECT_EQ(depths.BothPositive(), p.d1 > 0 && p.d2 > 0);
  }
}

TEST(Cheirality, DepthsOfSkewRaysAreThoseOfClosestApproach) {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    Problem p = MakeProblem(k, true, true);
    p.rays.ray2.x = (p.rays.ray2.x + 0.05 * random.NormalVector3()).normalized();
    Depths depths;
    ASSERT_TRUE(TriangulateDepths(p.pose, p.rays, &depths));
    // The connecting segment is perpendicular to both rays.
    const Vector3d gap = p.pose * (p.rays.ray1.s + depths.d1 * p.rays.ray1.x) -
                         (p.rays.ray2.s + depths.d2 * p.rays.ray2.x);
    EXPECT_LT(std::abs(gap.dot(p.rays.ray2.x)), 1e-9);
    EXPECT_LT(std::abs(gap.dot(p.pose.R * p.rays.ray1.x)), 1e-9);
  }
}

TEST(Cheirality, NamesWhereThePointLies) {
  for (int seed = 0; seed < 100; ++seed) {
    const auto test = [seed](bool front1, bool front2) {
      const Problem p = MakeProblem(seed, front1, front2);
      return TestCheirality(p.pose, p.rays);
    };
    EXPECT_EQ(test(true, true), Cheirality::kInFront);
    EXPECT_EQ(test(false, false), Cheirality::kBehind);
    EXPECT_EQ(test(true, false), Cheirality::kMixed);
    EXPECT_EQ(test(false, true), Cheirality::kMixed);
    const auto vote = [seed](bool front1, bool front2) {
      const Problem p = MakeProblem(seed, front1, front2);
      return CheiralityVote(p.pose, p.rays);
    };
    EXPECT_EQ(vote(true, true), 1);
    EXPECT_EQ(vote(false, false), -1);
    EXPECT_EQ(vote(true, false), 0);
  }
}

TEST(Cheirality, TheWrongSignOfTheBaselinePutsPointsBehindBothCameras) {
  for (int seed = 0; seed < 100; ++seed) {
    Problem p = MakeProblem(seed, true, true);
    // b -> -b for b = R s1 + t - s2.
    p.pose.t = 2.0 * (p.rays.ray2.s - p.pose.R * p.rays.ray1.s) - p.pose.t;
    EXPECT_EQ(TestCheirality(p.pose, p.rays), Cheirality::kBehind) << seed;
  }
}

TEST(Cheirality, ParallelRaysHaveNoDepth) {
  Problem p = MakeProblem(3, true, true);
  p.rays.ray2.x = p.pose.R * p.rays.ray1.x;
  Depths depths;
  depths.d1 = 11.0;
  depths.d2 = 12.0;
  EXPECT_FALSE(TriangulateDepths(p.pose, p.rays, &depths));
  EXPECT_EQ(depths.d1, 11.0);
  EXPECT_EQ(depths.d2, 12.0);
  EXPECT_EQ(TestCheirality(p.pose, p.rays), Cheirality::kUndecided);
  p.rays.ray2.x = -p.rays.ray2.x;
  EXPECT_FALSE(TriangulateDepths(p.pose, p.rays, &depths));
}

TEST(Cheirality, TheParallaxThresholdIsTheSineOfTheAngle) {
  RayPair rays;
  Pose pose;
  pose.t = Vector3d(-1, 0, 0);  // the second camera is 1 m to the right
  rays.ray1.x = Vector3d(0, 0, 1);
  rays.ray2.x = Vector3d(-0.01, 0, 1).normalized();
  EXPECT_EQ(TestCheirality(pose, rays), Cheirality::kInFront);
  EXPECT_EQ(TestCheirality(pose, rays, 0.0099), Cheirality::kInFront);
  EXPECT_EQ(TestCheirality(pose, rays, 0.0101), Cheirality::kUndecided);
}

TEST(Cheirality, NanIsUndecided) {
  Problem p = MakeProblem(4, true, true);
  p.pose.R(0, 0) = std::numeric_limits<double>::quiet_NaN();
  Depths depths;
  EXPECT_FALSE(TriangulateDepths(p.pose, p.rays, &depths));
  EXPECT_EQ(TestCheirality(p.pose, p.rays), Cheirality::kUndecided);
}

}  // namespace
}  // namespace rigel
