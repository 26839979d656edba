#include "rigel/minimal/solvers/direct_sample.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/depth_system.h"
#include "rigel/problems/scenes/synthetic.h"

#include "rigel/test/minimal/random_problem.h"

namespace rigel {
namespace {

constexpr int kSample[] = {0, 1, 2, 3};

// The rows n . t + k = 0 at the angle a, columns t_x, t_z, t_y and 1.
Eigen::Matrix4d Rows(const PreparedMatches& matches, double a) {
  const double c = std::cos(a);
  const double s = std::sin(a);
  Eigen::Matrix4d rows;
  for (int r = 0; r < 4; ++r) {
    const PreparedMatch& m = matches[kSample[r]];
    rows.row(r) << m.X0 + c * m.Xc + s * m.Xs, m.Z0 + c * m.Xs - s * m.Xc, c * m.Yc + s * m.Ys,
        m.K0 + c * m.Kc + s * m.Ks;
  }
  return rows;
}

TEST(DirectSample, DeterminantsAreThoseOfTheConstraints) {
  for (const CameraPairs& cameras : {IntraPairs(), InterPairs()}) {
    ProblemOptions options;
    options.cameras = cameras;
    for (int seed = 0; seed < 50; ++seed) {
      const RandomProblem problem = MakeRandomProblem(seed, options);
      const PreparedMatches matches = problem.Prepare(PriorKind::kAxis);
      const DirectSample sample(matches, kSample);
      ASSERT_EQ(sample.deflated(), cameras == IntraPairs());
      double c[7], first_order[4];
      sample.Determinant(c, first_order);
      Random random = Random::Stream(640, seed);
      for (int n = 0; n < 10; ++n) {
        const double z = random.Uniform(-2.0, 2.0);
        // Columns x, y, z and k times 1 + z^2, and k divided by z.
        const double factor = std::pow(1.0 + z * z, 3) / (sample.deflated() ? z : 1.0);
        const double expected = factor * Rows(matches, 2.0 * std::atan(z)).determinant();
        const double scale = PolynomialMagnitude<6>(c, z);
        EXPECT_NEAR(EvaluatePolynomial<6>(c, z), expected, 1e-10 * scale);
      }
      if (!sample.deflated()) continue;

      EXPECT_EQ(c[6], 0.0);
      const double z = random.Uniform(-2.0, 2.0);
      Eigen::Matrix4d linear;
      linear << (sample.x0 + z * sample.x1).matrix(), (sample.z0 + z * sample.z1).matrix(),
          (sample.y0 + z * sample.y1).matrix(), sample.k0.matrix();
      EXPECT_NEAR(EvaluatePolynomial<3>(first_order, z), linear.determinant(),
                  1e-12 * PolynomialMagnitude<3>(first_order, z));
    }
  }
}

// A motion whose translation is along one axis of the frame half way, and so orthogonal to the
// others.
RandomProblem MotionAlong(int axis, const CameraPairs& cameras, int seed, double* angle) {
  RandomProblem problem = MakeRandomProblem(seed, {});
  Random random = Random::Stream(641, seed);
  *angle = random.Uniform(-0.1, 0.1);
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  problem.truth.R = ExpSO3(*angle * y);
  problem.truth.t = ExpSO3(0.5 * *angle * y) * Eigen::Vector3d::Unit(axis);
  problem.prior.axis = y;
  problem.matches.clear();
  while (problem.matches.size() < 4) {
    const auto& pair = cameras[problem.matches.size() % 2];
    const Eigen::Vector2d pixel{random.Uniform(0.0, 640.0), random.Uniform(0.0, 480.0)};
    Match match;
    if (MakeMatch(problem.rig, problem.truth, pair.first, pair.second, pixel,
                  random.Uniform(5.0, 30.0), &match)) {
      problem.matches.push_back(match);
    }
  }
  return problem;
}

TEST(DirectSample, MotionsAlongEachAxisAreFound) {
  for (const CameraPairs& cameras : {IntraPairs(), InterPairs()}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int seed = 0; seed < 20; ++seed) {
        double angle;
        const RandomProblem problem = MotionAlong(axis, cameras, seed, &angle);
        const PreparedMatches matches = problem.Prepare(PriorKind::kAxis);
        Solutions solutions;
        DirectSample(matches, kSample).AddSolution(std::tan(0.5 * angle), &solutions);
        ASSERT_EQ(solutions.size(), 1);
        EXPECT_TRUE(solutions[0].has_scale);
        EXPECT_LT((solutions[0].t - problem.truth.t).norm(), 1e-8) << "axis " << axis;
        EXPECT_LT(RotationError(problem.truth.R, solutions[0].R), 1e-12);
      }
    }
  }
}

// Roots of first-order forms are approximate, and no motion satisfies all four matches.
TEST(DirectSample, ApproximateRootsGiveTheTranslationOfLeastResidual) {
  for (int axis = 0; axis < 3; ++axis) {
    double largest = 0.0;
    for (int seed = 0; seed < 50; ++seed) {
      double angle;
      const RandomProblem problem = MotionAlong(axis, IntraPairs(), seed, &angle);
      const PreparedMatches matches = problem.Prepare(PriorKind::kAxis);
      const DirectSample sample(matches, kSample);
      const double z = std::tan(0.5 * angle) + 1e-4;
      Eigen::Matrix4d rows;
      rows << (sample.x0 + z * sample.x1).matrix(),
          ((1.0 - z * z) * sample.y0 + z * sample.y1).matrix(),
          (sample.z0 + z * sample.z1).matrix(), (sample.k0 + z * sample.k1).matrix();
      const Eigen::JacobiSVD<Eigen::Matrix4d> svd(rows, Eigen::ComputeFullV);
      const Eigen::Vector4d u = svd.matrixV().col(3);
      const Eigen::Vector3d t(u[0] + z * u[2], (1.0 + z * z) * u[1], u[2] - z * u[0]);
      Solutions solutions;
      sample.AddSolution(z, &solutions);
      ASSERT_EQ(solutions.size(), 1);
      const Eigen::Vector3d expected = matches.alignment().A2.transpose() * t;
      const double error = TranslationDirectionError(expected, solutions[0].t);
      // The residual tells the direction no better than this ratio.
      const double vague = svd.singularValues()[3] / svd.singularValues()[2];
      largest = std::max(largest, std::min(error, M_PI - error) / vague);
    }
    EXPECT_LT(largest, 1.0) << "axis " << axis;
  }
}

TEST(DirectSample, FirstOrderRootsAreLessBiasedThanThoseOfTheDepthForm) {
  std::vector<double> direct_errors, depth_errors;
  for (int seed = 0; seed < 300; ++seed) {
    SceneOptions options;
    options.num_matches = 4;
    options.noise_px = 0.0;
    FramePair pair;
    std::string error;
    ASSERT_TRUE(MakeScenePair(options, seed, &pair, &error)) << error;
    Alignment alignment;
    ASSERT_TRUE(MakeAlignment(pair.prior, PriorKind::kVertical, &alignment, &error)) << error;
    const PreparedMatches matches(pair.rig, pair.matches, alignment);
    const double truth = matches.alignment().NearestAngle(pair.truth->R);
    double c[7];
    double roots[3];
    const auto nearest = [&](int count, double unit) {
      double best = 1.0;
      for (int k = 0; k < count; ++k) best = std::min(best, std::abs(unit * roots[k] - truth));
      return best;
    };
    double first_order[4];
    DirectSample(matches, kSample).Determinant(c, first_order);
    direct_errors.push_back(nearest(RealRoots<3>(first_order, roots), 2.0));
    DepthSystem<RotationModel::kFirstOrder> system;
    system.SetFourPoint(matches, kSample);
    ASSERT_EQ(system.Determinant(c), 2);
    depth_errors.push_back(nearest(RealRoots<2>(c, roots), 1.0));
  }
  std::sort(direct_errors.begin(), direct_errors.end());
  std::sort(depth_errors.begin(), depth_errors.end());
  EXPECT_LT(RadToDeg(direct_errors[150]), 0.015);
  EXPECT_LT(5.0 * direct_errors[150], depth_errors[150]);
}

}  // namespace
}  // namespace rigel
