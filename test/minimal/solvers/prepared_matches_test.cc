#include "rigel/minimal/solvers/prepared_matches.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Problem {
  Rig rig;
  std::vector<Match> matches;
  Alignment alignment;
  PreparedMatches prepared;
};

// Any rig, any matches, two different alignments.
Problem MakeProblem(uint64_t seed) {
  Random random = Random::Stream(1, seed);
  Problem p;
  for (int k = 0; k < 3; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0 + 50 * k, 380.0, 320.0, 240.0, 640, 480);
    camera.Q = ExpSO3(random.NormalVector3());
    camera.s = random.NormalVector3();
    p.rig.cameras.push_back(camera);
  }
  for (int k = 0; k < 6; ++k) {
    Match match;
    match.camera1 = random.Index(3);
    match.camera2 = random.Index(3);
    match.pixel1 = {random.Uniform(0.0, 640.0), random.Uniform(0.0, 480.0)};
    match.pixel2 = {random.Uniform(0.0, 640.0), random.Uniform(0.0, 480.0)};
    p.matches.push_back(match);
  }
  MotionPrior prior;
  prior.gravity1 = random.UnitVector3();
  prior.gravity2 = random.UnitVector3();
  std::string error;
  EXPECT_TRUE(MakeAlignment(prior, PriorKind::kVertical, &p.alignment, &error)) << error;
  p.prepared.Set(p.rig, p.matches, p.alignment);
  return p;
}

Vector3d ToVector(const double v[3]) { return {v[0], v[1], v[2]}; }

TEST(PreparedMatches, TableGivesTheConstraintAtAnyAngle) {
  for (int seed = 0; seed < 200; ++seed) {
    const Problem problem = MakeProblem(seed);
    Random random = Random::Stream(2, seed);
    for (int k = 0; k < problem.prepared.size(); ++k) {
      const PreparedMatch& m = problem.prepared[k];
      const RayPair rays = MakeRayPair(problem.rig, problem.matches[k]);
      const Vector3d p = problem.alignment.A1 * rays.ray1.x;
      const Vector3d r = problem.alignment.A2 * rays.ray2.x;
      const double angle = random.Uniform(-3.1, 3.1);
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      const Matrix3d R = RotationY(angle);
      const Vector3d n(m.X0 + c * m.Xc + s * m.Xs, c * m.Yc + s * m.Ys, m.Z0 + c * m.Xs - s * m.Xc);
      EXPECT_LT((n - (R * p).cross(r)).norm(), 1e-14);
      const Vector3d Rtn(m.Xc + c * m.X0 - s * m.Z0, c * m.Yc + s * m.Ys,
                         m.Xs + c * m.Z0 + s * m.X0);
      EXPECT_LT((Rtn - p.cross(R.transpose() * r)).norm(), 1e-14);
      // k is the constraint at t = 0, and n . t the rest of it, in the body frames.
      const double k_at = m.K0 + c * m.Kc + s * m.Ks;
      Pose pose;
      pose.R = problem.alignment.A2.transpose() * R * problem.alignment.A1;
      EXPECT_NEAR(k_at, GecPluecker(pose, rays), 1e-13);
      pose.t = random.NormalVector3();
      EXPECT_NEAR(n.dot(problem.alignment.A2 * pose.t) + k_at, GecPluecker(pose, rays), 1e-13);
    }
  }
}

TEST(PreparedMatches, KeepsRaysCentresAndCameras) {
  for (int seed = 0; seed < 50; ++seed) {
    const Problem problem = MakeProblem(seed);
    ASSERT_EQ(problem.prepared.size(), static_cast<int>(problem.matches.size()));
    EXPECT_EQ(problem.prepared.alignment().A2, problem.alignment.A2);
    for (int k = 0; k < problem.prepared.size(); ++k) {
      const PreparedMatch& m = problem.prepared[k];
      const RayPair rays = MakeRayPair(problem.rig, problem.matches[k]);
      EXPECT_EQ(problem.prepared.rays(k).ray1.x, rays.ray1.x);
      EXPECT_EQ(problem.prepared.rays(k).ray2.s, rays.ray2.s);
      EXPECT_EQ(ToVector(m.x1), problem.alignment.A1 * rays.ray1.x);
      EXPECT_EQ(ToVector(m.x2), problem.alignment.A2 * rays.ray2.x);
      EXPECT_EQ(ToVector(m.s1), problem.alignment.A1 * rays.ray1.s);
      EXPECT_EQ(ToVector(m.s2), problem.alignment.A2 * rays.ray2.s);
      EXPECT_EQ(m.camera1, problem.matches[k].camera1);
      EXPECT_EQ(m.camera2, problem.matches[k].camera2);
      EXPECT_NEAR(m.parallax2, ToVector(m.x1).cross(ToVector(m.x2)).squaredNorm(), 1e-15);
    }
  }
}

TEST(PreparedMatches, SetForgetsTheLastFramePair) {
  Problem p = MakeProblem(1);
  const Problem other = MakeProblem(2);
  const std::vector<Match> two(other.matches.begin(), other.matches.begin() + 2);
  p.prepared.Set(other.rig, two, other.alignment);
  ASSERT_EQ(p.prepared.size(), 2);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(p.prepared[k].K0, other.prepared[k].K0);
    EXPECT_EQ(p.prepared.rays(k).ray1.x, other.prepared.rays(k).ray1.x);
  }
  p.prepared.Set(other.rig, {}, other.alignment);
  EXPECT_EQ(p.prepared.size(), 0);
  EXPECT_EQ(PreparedMatches().size(), 0);
}

TEST(PreparedMatches, OfAGroupAreThoseOfTheListOncePrepared) {
  const Problem p = MakeProblem(1);
  const GroupedMatches grouped(p.rig, p.matches);
  PreparedMatches prepared = PreparedMatches::OnDemand(grouped, p.alignment);
  ASSERT_EQ(prepared.size(), grouped.size());
  const int sample[] = {3, 0, 3};
  prepared.Prepare(sample, 3);
  for (const int k : sample) {
    const int original = grouped.original(k);
    EXPECT_EQ(prepared[k].K0, p.prepared[original].K0);
    EXPECT_EQ(prepared[k].Ys, p.prepared[original].Ys);
    EXPECT_EQ(prepared[k].camera2, p.prepared[original].camera2);
    EXPECT_EQ(prepared.rays(k).ray1.x, p.prepared.rays(original).ray1.x);
  }
  EXPECT_EQ(prepared.alignment().A2, p.alignment.A2);
}

}  // namespace
}  // namespace rigel
