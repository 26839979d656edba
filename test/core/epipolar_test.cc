#include "rigel/core/epipolar.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "rigel/core/random.h"
#include "rigel/test/core/pinhole.h"

namespace rigel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Three cameras of different focal lengths (fx != fy), each with its own principal point.
Rig MakeRig(Random* random) {
  Rig rig;
  const double fx[] = {400.0, 800.0, 250.0};
  const double fy[] = {430.0, 700.0, 260.0};
  for (int k = 0; k < 3; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(fx[k], fy[k], 300.0 + 20 * k, 260.0 - 15 * k, 640, 480);
    camera.Q = ExpSO3(0.3 * random->NormalVector3());
    camera.s = random->NormalVector3();
    rig.cameras.push_back(camera);
  }
  return rig;
}

Pose RandomPose(Random* random) {
  Pose pose;
  pose.R = ExpSO3(0.2 * random->NormalVector3());
  pose.t = random->NormalVector3();
  return pose;
}

Vector2d RandomPixel(Random* random) {
  const double u = random->Uniform(0.0, 640.0);
  const double v = random->Uniform(0.0, 480.0);
  return {u, v};
}

// Any two pixels: the forms of the constraint agree on wrong matches too.
Match RandomMatch(Random* random) {
  Match match;
  match.camera1 = random->Index(3);
  match.camera2 = random->Index(3);
  match.pixel1 = RandomPixel(random);
  match.pixel2 = RandomPixel(random);
  return match;
}

// A match of a point in front of both cameras.
Match TrueMatch(const Rig& rig, const Pose& pose, Random* random) {
  Match match;
  for (int tries = 0; tries < 1000; ++tries) {
    match.camera1 = random->Index(3);
    match.camera2 = random->Index(3);
    const RigCamera& c1 = rig.cameras[match.camera1];
    const RigCamera& c2 = rig.cameras[match.camera2];
    match.pixel1 = RandomPixel(random);
    const Vector3d X1 =
        c1.Q * (random->Uniform(4.0, 20.0) * AlongRay(c1.intrinsics, match.pixel1)) + c1.s;
    const Vector3d X2 = c2.Q.transpose() * (pose * X1 - c2.s);
    if (X2.z() < 1.0) continue;
    match.pixel2 = ProjectPinhole(c2.intrinsics, X2);
    break;
  }
  return match;
}

struct Problem {
  Rig rig;
  Pose pose;
  Match match;
  RayPair rays;
};

Problem MakeProblem(uint64_t seed, bool true_match = false) {
  Random random = Random::Stream(1, seed);
  Problem p;
  p.rig = MakeRig(&random);
  p.pose = RandomPose(&random);
  p.match = true_match ? TrueMatch(p.rig, p.pose, &random) : RandomMatch(&random);
  p.rays = MakeRayPair(p.rig, p.match);
  return p;
}

// u_j' E u_i for the four pixel coordinates, straight from the definitions: no centred pixels and
// no F, so that it can judge them.
double PixelConstraint(const Problem& p, const Vector4d& pixels) {
  const RigCamera& ci = p.rig.cameras[p.match.camera1];
  const RigCamera& cj = p.rig.cameras[p.match.camera2];
  const Vector3d xi = p.pose.R * ci.Q * AlongRay(ci.intrinsics, pixels.head<2>());
  const Vector3d xj = cj.Q * AlongRay(cj.intrinsics, pixels.tail<2>());
  return xj.dot((p.pose.R * ci.s + p.pose.t - cj.s).cross(xi));
}

Vector4d Pixels(const Match& match) {
  Vector4d pixels;
  pixels << match.pixel1, match.pixel2;
  return pixels;
}

// The constraint is bilinear in the two pixels, so central differences are exact but for rounding.
Vector4d PixelGradient(const Problem& p, const Vector4d& pixels) {
  Vector4d gradient;
  const double h = 1.0;
  for (int k = 0; k < 4; ++k) {
    const Vector4d d = h * Vector4d::Unit(k);
    gradient[k] = (PixelConstraint(p, pixels + d) - PixelConstraint(p, pixels - d)) / (2 * h);
  }
  return gradient;
}

// Distance in pixels of a match from the nearest exact match, by iterated projection onto the
// tangent of the constraint.
double MinimalDistance(const Problem& p) {
  const Vector4d x0 = Pixels(p.match);
  Vector4d x = x0;
  for (int k = 0; k < 100; ++k) {
    const Vector4d g = PixelGradient(p, x);
    x = x0 - g * ((PixelConstraint(p, x) + g.dot(x0 - x)) / g.squaredNorm());
  }
  return (x - x0).norm();
}

TEST(Epipolar, ThreeFormsOfTheConstraintAgree) {
  for (int seed = 0; seed < 1000; ++seed) {
    const Problem p = MakeProblem(seed);
    const RigCamera& ci = p.rig.cameras[p.match.camera1];
    const RigCamera& cj = p.rig.cameras[p.match.camera2];
    const Vector3d ui = AlongRay(ci.intrinsics, p.match.pixel1);
    const Vector3d uj = AlongRay(cj.intrinsics, p.match.pixel2);
    const double triple = GecTripleProduct(p.pose, p.rays);
    EXPECT_NEAR(GecPluecker(p.pose, p.rays), triple, 1e-13) << seed;
    EXPECT_NEAR(uj.dot(EssentialMatrix(p.pose, ci, cj) * ui) / (ui.norm() * uj.norm()), triple,
                1e-13)
        << seed;
    EXPECT_NEAR(PixelConstraint(p, Pixels(p.match)) / (ui.norm() * uj.norm()), triple, 1e-13);
  }
}

TEST(Epipolar, VanishesForTrueMatches) {
  for (int seed = 0; seed < 500; ++seed) {
    const Problem p = MakeProblem(seed, true);
    EXPECT_LT(std::abs(GecTripleProduct(p.pose, p.rays)), 1e-13) << seed;
    EXPECT_LT(std::abs(SampsonError(p.pose, p.rig, p.match)), 1e-8) << seed;
  }
}

// The reference's depths give back t, and the coefficients of the depth form give C for any other
// match, true or not (paper eqs. a5, b4).
TEST(Epipolar, DepthFormAgreesWithTheTripleProduct) {
  for (int seed = 0; seed < 1000; ++seed) {
    Random random = Random::Stream(2, seed);
    const Problem p = MakeProblem(seed);
    const RayPair reference = MakeRayPair(p.rig, RandomMatch(&random));
    const double l1 = random.Uniform(-10.0, 30.0);
    const double l2 = random.Uniform(-10.0, 30.0);
    Pose pose = p.pose;
    pose.t = TranslationFromDepths(pose.R, reference, l1, l2);
    const Vector3d point1 = reference.ray1.Foot() + l1 * reference.ray1.x;
    const Vector3d point2 = reference.ray2.Foot() + l2 * reference.ray2.x;
    EXPECT_LT((pose * point1 - point2).norm(), 1e-12);
    const Vector3d k = GecDepthCoefficients(pose.R, reference, p.rays);
    EXPECT_NEAR(k.dot(Vector3d(l1, l2, 1.0)), GecTripleProduct(pose, p.rays), 1e-12) << seed;
    // The reference itself is satisfied whatever its depths are.
    EXPECT_LT(GecDepthCoefficients(pose.R, reference, reference).norm(), 1e-13);
  }
}

TEST(Epipolar, EssentialMatrixFromDepthsIsTheEssentialMatrix) {
  for (int seed = 0; seed < 1000; ++seed) {
    Random random = Random::Stream(3, seed);
    const Problem p = MakeProblem(seed);
    const RayPair reference = MakeRayPair(p.rig, RandomMatch(&random));
    const double l1 = random.Uniform(-10.0, 30.0);
    const double l2 = random.Uniform(-10.0, 30.0);
    Pose pose = p.pose;
    pose.t = TranslationFromDepths(pose.R, reference, l1, l2);
    const RigCamera& ci = p.rig.cameras[p.match.camera1];
    const RigCamera& cj = p.rig.cameras[p.match.camera2];
    const Matrix3d E = EssentialMatrix(pose, ci, cj);
    EXPECT_LT((EssentialMatrixFromDepths(pose.R, reference, l1, l2, ci, cj) - E).norm(),
              1e-13 * (1.0 + std::abs(l1) + std::abs(l2)))
        << seed;
  }
}

TEST(Epipolar, TheFundamentalActsOnCentredPixels) {
  for (int seed = 0; seed < 200; ++seed) {
    const Problem p = MakeProblem(seed);
    const RigCamera& ci = p.rig.cameras[p.match.camera1];
    const RigCamera& cj = p.rig.cameras[p.match.camera2];
    const Matrix3d F =
        Unprojection(cj).transpose() * EssentialMatrix(p.pose, ci, cj) * Unprojection(ci);
    EXPECT_NEAR(RowPointOf(cj, p.match.pixel2).p.dot(F * RowPointOf(ci, p.match.pixel1).p),
                PixelConstraint(p, Pixels(p.match)), 1e-13);
  }
}

// fx != fy and another focal length in each camera: a mean focal length, or camera i's in place of
// camera j's, would show.
TEST(Sampson, IsTheConstraintOverItsNumericGradientInPixels) {
  for (int seed = 0; seed < 1000; ++seed) {
    const Problem p = MakeProblem(seed);
    const Vector4d x = Pixels(p.match);
    const double expected = PixelConstraint(p, x) / PixelGradient(p, x).norm();
    EXPECT_NEAR(SampsonError(p.pose, p.rig, p.match), expected, 1e-9 * (1 + std::abs(expected)))
        << seed;
  }
}

TEST(Sampson, IsTheDistanceFromTheNearestExactMatchToFirstOrder) {
  // With noise sigma the relative deviation is of the order sigma times the curvature over the
  // gradient: it falls in proportion to the noise.
  for (const double sigma : {1e-3, 1e-1}) {
    double worst = 0.0;
    for (int seed = 0; seed < 300; ++seed) {
      Random random = Random::Stream(4, seed);
      Problem p = MakeProblem(seed, true);
      for (int k = 0; k < 2; ++k) {
        p.match.pixel1[k] += sigma * random.Normal();
        p.match.pixel2[k] += sigma * random.Normal();
      }
      const double distance = MinimalDistance(p);
      if (distance < 0.1 * sigma) continue;
      worst = std::max(worst,
                       std::abs(std::abs(SampsonError(p.pose, p.rig, p.match)) / distance - 1.0));
    }
    EXPECT_LT(worst, 0.1 * sigma) << sigma;
  }
}

TEST(Sampson, DoesNotChangeWhenTheMatrixIsScaled) {
  for (int seed = 0; seed < 200; ++seed) {
    Random random = Random::Stream(5, seed);
    Matrix3d F;
    F << random.NormalVector3(), random.NormalVector3(), random.NormalVector3();
    const Vector3d pi{random.Normal(), random.Normal(), 1.0};
    const Vector3d pj{random.Normal(), random.Normal(), 1.0};
    const double r = SampsonError(F, pi, pj);
    for (const double scale : {1e-100, 1e-8, 1e3, 1e100}) {
      EXPECT_NEAR(SampsonError(scale * F, pi, pj), r, 1e-12 * std::abs(r)) << scale;
    }
    EXPECT_NEAR(SampsonError(-F, pi, pj), -r, 1e-12 * std::abs(r));
  }
}

TEST(Sampson, IntraCameraErrorCannotGainByShrinkingTheMotion) {
  // Without rotation only t is left to shrink, and the algebraic error shrinks with it.
  for (int seed = 0; seed < 100; ++seed) {
    Problem p = MakeProblem(seed);
    p.match.camera2 = p.match.camera1;
    p.rays = MakeRayPair(p.rig, p.match);
    p.pose.R.setIdentity();
    const double r = SampsonError(p.pose, p.rig, p.match);
    const double C = GecTripleProduct(p.pose, p.rays);
    p.pose.t *= 1e-6;
    // R s + t - s cancels: t keeps ten digits.
    EXPECT_NEAR(SampsonError(p.pose, p.rig, p.match), r, 1e-6 * std::abs(r));
    EXPECT_LT(std::abs(GecTripleProduct(p.pose, p.rays)), 1.1e-6 * std::abs(C) + 1e-14);
  }
}

TEST(Sampson, IsZeroAtTheEpipoles) {
  // Forward motion of one camera: both epipoles at the principal point. The numbers are exact.
  const Matrix3d F = Skew(Vector3d::UnitZ());
  EXPECT_EQ(SampsonError(F, Vector3d::UnitZ(), Vector3d::UnitZ()), 0.0);
  // At one epipole only the gradient is not zero, the error is.
  EXPECT_EQ(SampsonError(F, Vector3d(3, 4, 1), Vector3d::UnitZ()), 0.0);
  // Towards the epipoles along exact matches and beside them the error stays finite.
  for (const double d : {1e-3, 1e-9, 1e-100}) {
    EXPECT_EQ(SampsonError(F, Vector3d(d, 0, 1), Vector3d(2 * d, 0, 1)), 0.0);
    const double r = SampsonError(F, Vector3d(d, 0, 1), Vector3d(0, d, 1));
    EXPECT_NEAR(std::abs(r), d / std::sqrt(2.0), 1e-12 * d);
  }
}

TEST(Sampson, IsInfiniteWhereTheMotionSaysNothing) {
  const Vector3d p(3, 4, 1);
  EXPECT_EQ(SampsonError(Matrix3d::Zero(), p, p), std::numeric_limits<double>::infinity());
  // No motion at all, one camera: E = 0 fits every match and must win none.
  Problem problem = MakeProblem(1);
  problem.match.camera2 = problem.match.camera1;
  EXPECT_EQ(std::abs(SampsonError(Pose(), problem.rig, problem.match)),
            std::numeric_limits<double>::infinity());
  // A constraint that no pixel can reach.
  Matrix3d constant = Matrix3d::Zero();
  constant(2, 2) = 1.0;
  EXPECT_EQ(SampsonError(constant, p, p), std::numeric_limits<double>::infinity());
}

TEST(Sampson, NanIsNeverASmallError) {
  Matrix3d F = Skew(Vector3d(1, 2, 3));
  F(1, 1) = std::numeric_limits<double>::quiet_NaN();
  const double r = SampsonError(F, Vector3d(3, 4, 1), Vector3d(1, 2, 1));
  EXPECT_FALSE(std::abs(r) < 1e300);
}

}  // namespace
}  // namespace rigel
