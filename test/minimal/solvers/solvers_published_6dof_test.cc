// The baselines without a prior: 17pt-li, 6pt-ventura, 6pt-stewenius. Noise-free problems of the
// scene; the seed of a problem is its index.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/minimal/solvers/seventeen_point_li.h"
#include "rigel/minimal/solvers/six_point_stewenius.h"
#include "rigel/minimal/solvers/six_point_ventura.h"
#include "rigel/test/minimal/random_problem.h"

namespace rigel {
namespace {

using SolveFunction = int (*)(const PreparedMatches&, const int*, Solutions*);

constexpr int kIndices[17] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

ProblemOptions Options(int num_matches, const CameraPairs& cameras, double rotation_deg,
                       int num_cameras = 2) {
  ProblemOptions options;
  options.num_matches = num_matches;
  options.num_cameras = num_cameras;
  options.cameras = cameras;
  options.max_rotation_deg = rotation_deg;
  options.exact_rotation = true;
  options.random_axis = true;
  return options;
}

struct Shares {
  double rotation = 0;  // share of problems with the true rotation to `tolerance`
  double motion = 0;    // and direction and scale to 1e-4
  double median_rotation = 0;
  double median_direction = 0;
  double solutions = 0;  // mean number
};

Shares Measure(SolveFunction solve, const ProblemOptions& options, int num_problems,
               double tolerance) {
  Shares shares;
  std::vector<double> rotations;
  std::vector<double> directions;
  Solutions solutions;
  for (int seed = 0; seed < num_problems; ++seed) {
    const RandomProblem problem = MakeRandomProblem(seed, options);
    const PreparedMatches matches = problem.Prepare(PriorKind::kNone);
    const int count = solve(matches, kIndices, &solutions);
    EXPECT_EQ(count, solutions.size());
    const MotionError best = BestMotion(solutions, problem.truth);
    const double rotation = BestRotationError(solutions, problem.truth);
    shares.rotation += rotation < tolerance;
    shares.motion += best.rotation < tolerance && best.direction < 1e-4 && best.scale < 1e-4;
    shares.solutions += solutions.size();
    rotations.push_back(rotation);
    directions.push_back(best.direction);
  }
  std::sort(rotations.begin(), rotations.end());
  std::sort(directions.begin(), directions.end());
  shares.rotation /= num_problems;
  shares.motion /= num_problems;
  shares.solutions /= num_problems;
  shares.median_rotation = rotations[num_problems / 2];
  shares.median_direction = directions[num_problems / 2];
  return shares;
}

CameraPairs MixedPairs() { return {{0, 0}, {1, 1}, {0, 1}, {1, 0}}; }

TEST(SeventeenPointLi, FindsTheTruth) {
  for (const double degrees : {0.1, 1.0, 10.0, 30.0}) {
    for (const CameraPairs& cameras : {InterPairs(), MixedPairs()}) {
      const Shares shares = Measure(&Solve17ptLi, Options(17, cameras, degrees), 300, 1e-6);
      EXPECT_GE(shares.motion, 0.995) << degrees;
    }
  }
}

TEST(SeventeenPointLi, FindsTheTruthFromIntraCameraMatches) {
  for (const double degrees : {0.1, 1.0, 10.0}) {
    const Shares three =
        Measure(&Solve17ptLi, Options(17, IntraPairsOfThree(), degrees, 3), 300, 1e-6);
    EXPECT_GE(three.motion, 0.995) << degrees;
    // Rank 14: three more null vectors, all with E = 0.
    const Shares two = Measure(&Solve17ptLi, Options(17, IntraPairs(), degrees), 300, 1e-6);
    EXPECT_GE(two.motion, 0.995) << degrees;
  }
}

TEST(SeventeenPointLi, DoesNotDependOnTheOriginOfTheBody) {
  // The ambiguous vectors of two cameras have E = 0 only about their line.
  int found = 0;
  for (int seed = 0; seed < 100; ++seed) {
    RandomProblem problem = MakeRandomProblem(seed, Options(17, InterPairs(), 10.0));
    const Eigen::Vector3d shift(1.0, -2.0, 0.7);
    for (RigCamera& camera : problem.rig.cameras) camera.s += shift;
    problem.truth.t += shift - problem.truth.R * shift;
    Solutions solutions;
    Solve17ptLi(problem.Prepare(PriorKind::kNone), kIndices, &solutions);
    const MotionError best = BestMotion(solutions, problem.truth);
    found += best.rotation < 1e-6 && best.scale < 1e-6;
  }
  EXPECT_GE(found, 99);
}

TEST(SeventeenPointLi, LeastSquaresOverManyMatches) {
  // Noise of 0.5 px: more matches, less error; the first solution is the better one.
  double few = 0.0;
  double many = 0.0;
  for (int seed = 0; seed < 50; ++seed) {
    RandomProblem problem = MakeRandomProblem(seed, Options(200, MixedPairs(), 5.0));
    Random rng = Random::Stream(17, seed);
    for (Match& match : problem.matches) {
      match.pixel2 += 0.5 * Eigen::Vector2d{rng.Normal(), rng.Normal()};
    }
    const PreparedMatches matches = problem.Prepare(PriorKind::kNone);
    std::vector<int> all(200);
    for (int k = 0; k < 200; ++k) all[k] = k;
    Solutions solutions;
    ASSERT_GE(Solve17ptLi(matches, all.data(), 20, &solutions), 1);
    few += RotationError(problem.truth.R, solutions[0].R);
    ASSERT_GE(Solve17ptLi(matches, all.data(), 200, &solutions), 1);
    many += RotationError(problem.truth.R, solutions[0].R);
    EXPECT_EQ(Solve17ptLi(matches, all.data(), 16, &solutions), 0);
  }
  EXPECT_LT(many, 0.2 * few);
  EXPECT_LT(many / 50, DegToRad(0.3));
}

TEST(SeventeenPointLi, CentralSampleHasNoScale) {
  RandomProblem problem = MakeRandomProblem(1, Options(17, {{0, 0}}, 5.0));
  Solutions solutions;
  ASSERT_GE(Solve17ptLi(problem.Prepare(PriorKind::kNone), kIndices, &solutions), 1);
  EXPECT_LT(RotationError(problem.truth.R, solutions[0].R), 1e-9);
  EXPECT_FALSE(solutions[0].has_scale);
  const Eigen::Vector3d& s = problem.rig.cameras[0].s;
  const Eigen::Vector3d baseline = problem.truth * s - s;
  const double best = std::min(TranslationDirectionError(baseline, solutions[0] * s - s),
                               TranslationDirectionError(baseline, solutions[1] * s - s));
  EXPECT_LT(best, 1e-9);
}

TEST(SixPointVentura, BiasAtOneDegree) {
  // Measured: 0.010 and 0.026 degrees of rotation, 0.15 and 0.25 of direction.
  const Shares inter = Measure(&Solve6ptVentura, Options(6, InterPairs(), 1.0), 300, 1e-3);
  EXPECT_LT(RadToDeg(inter.median_rotation), 0.015);
  EXPECT_LT(RadToDeg(inter.median_direction), 0.25);
  EXPECT_GE(inter.rotation, 0.85);
  const Shares intra = Measure(&Solve6ptVentura, Options(6, IntraPairs(), 1.0), 300, 1e-3);
  EXPECT_LT(RadToDeg(intra.median_rotation), 0.04);
  EXPECT_LT(RadToDeg(intra.median_direction), 0.4);
  // The error of the model is of second order.
  const Shares smaller = Measure(&Solve6ptVentura, Options(6, InterPairs(), 0.1), 300, 1e-4);
  EXPECT_LT(smaller.median_rotation, 0.02 * inter.median_rotation);
  EXPECT_GE(smaller.rotation, 0.95);
}

TEST(SixPointVentura, ExactWithoutRotation) {
  const Shares inter = Measure(&Solve6ptVentura, Options(6, InterPairs(), 0.0), 200, 1e-9);
  EXPECT_GE(inter.motion, 0.99);
}

TEST(SixPointStewenius, FindsTheTruth) {
  for (const double degrees : {0.0, 1.0, 10.0, 30.0}) {
    for (const CameraPairs& cameras : {InterPairs(), MixedPairs()}) {
      const Shares shares = Measure(&Solve6ptStewenius, Options(6, cameras, degrees), 250, 1e-6);
      EXPECT_GE(shares.motion, 0.98) << degrees;
      EXPECT_GE(shares.solutions, 10);
      EXPECT_LE(shares.solutions, 30);
    }
  }
}

TEST(SixPointStewenius, FindsTheTruthFromIntraCameraMatches) {
  EXPECT_GE(Measure(&Solve6ptStewenius, Options(6, IntraPairsOfThree(), 10.0, 3), 400, 1e-4).motion,
            0.95);
  EXPECT_GE(Measure(&Solve6ptStewenius, Options(6, IntraPairsOfThree(), 1.0, 3), 250, 1e-4).motion,
            0.85);
  EXPECT_GE(Measure(&Solve6ptStewenius, Options(6, IntraPairs(), 10.0), 250, 1e-4).motion, 0.97);
  EXPECT_GE(Measure(&Solve6ptStewenius, Options(6, IntraPairs(), 1.0), 250, 1e-4).motion, 0.95);
}

TEST(SixPointStewenius, FindsTheTruthForAnyGrouping) {
  using P = CameraPairs;
  const CameraPairs groupings[] = {
      {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {1, 1}, {1, 1}},  // 4 + 2: 40 solutions
      {{0, 1}, {0, 1}, {0, 1}, {0, 1}, {1, 0}, {0, 0}},  // 4 + 1 + 1
      {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {1, 1}},  // 5 + 1: 20
      {{0, 1}, {0, 1}, {0, 1}, {1, 0}, {1, 0}, {0, 0}},  // 3 + 2 + 1: 56
      {{0, 0}, {0, 0}, {0, 1}, {0, 1}, {1, 0}, {1, 0}},  // 2 + 2 + 2: 64
      {{0, 0}, {0, 0}, {0, 0}, {0, 1}, {0, 1}, {0, 1}},  // 3 + 3 from one centre: 48
  };
  for (const P& cameras : groupings) {
    const Shares shares = Measure(&Solve6ptStewenius, Options(6, cameras, 10.0), 150, 1e-6);
    EXPECT_GE(shares.motion, 0.95) << &cameras - groupings;
  }
}

class SixPoint : public testing::TestWithParam<SolveFunction> {};

TEST_P(SixPoint, PureTranslationHasNoScaleFromIntraCameraMatches) {
  for (const int num_cameras : {2, 3}) {
    for (int seed = 0; seed < 50; ++seed) {
      const RandomProblem problem = MakeRandomProblem(
          seed,
          Options(6, num_cameras == 2 ? IntraPairs() : IntraPairsOfThree(), 0.0, num_cameras));
      Solutions solutions;
      ASSERT_GE(GetParam()(problem.Prepare(PriorKind::kNone), kIndices, &solutions), 1);
      const MotionError best = BestMotion(solutions, problem.truth);
      EXPECT_LT(best.rotation, 1e-9);
      EXPECT_LT(best.direction, 1e-6);
      EXPECT_FALSE(best.has_scale);
      EXPECT_NEAR(solutions[0].t.norm(), 1.0, 1e-12);
    }
  }
}

TEST_P(SixPoint, NeverReturnsTheZeroMotionOfIntraCameraMatches) {
  for (int seed = 0; seed < 100; ++seed) {
    const RandomProblem problem = MakeRandomProblem(seed, Options(6, IntraPairsOfThree(), 10.0, 3));
    Solutions solutions;
    GetParam()(problem.Prepare(PriorKind::kNone), kIndices, &solutions);
    for (const Solution& solution : solutions) {
      EXPECT_GT(RotationError(Eigen::Matrix3d::Identity(), solution.R) + solution.t.norm(), 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, SixPoint, testing::Values(&Solve6ptVentura, &Solve6ptStewenius));

struct Baseline {
  const char* name;
  int sample_size;
  SolveFunction solve;
};

class SixDof : public testing::TestWithParam<Baseline> {};

TEST_P(SixDof, ReturnsRotationsThatFit) {
  const bool exact = std::string(GetParam().name) == "stewenius";
  for (int seed = 0; seed < 50; ++seed) {
    const RandomProblem problem =
        MakeRandomProblem(seed, Options(GetParam().sample_size, MixedPairs(), 10.0));
    const PreparedMatches matches = problem.Prepare(PriorKind::kNone);
    Solutions solutions;
    GetParam().solve(matches, kIndices, &solutions);
    for (const Solution& solution : solutions) {
      EXPECT_LT((solution.R.transpose() * solution.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
      EXPECT_GT(solution.R.determinant(), 0.0);
      for (int k = 0; exact && k < 6; ++k) {
        EXPECT_LT(std::abs(GecTripleProduct(solution, matches.rays(k))),
                  1e-9 * (1.0 + solution.t.norm()));
      }
    }
  }
}

TEST_P(SixDof, NoMotion) {
  for (const CameraPairs& cameras : {InterPairs(), MixedPairs(), IntraPairs()}) {
    for (int seed = 0; seed < 20; ++seed) {
      ProblemOptions options = Options(GetParam().sample_size, cameras, 0.0);
      options.distance = 0.0;
      const RandomProblem problem = MakeRandomProblem(seed, options);
      Solutions solutions;
      const int count = GetParam().solve(problem.Prepare(PriorKind::kNone), kIndices, &solutions);
      EXPECT_EQ(count, solutions.size());
      for (const Solution& solution : solutions) EXPECT_TRUE(solution.AllFinite());
      if (cameras == IntraPairs()) {
        EXPECT_EQ(count, 0) << "nothing moved, nothing is known";
      }
    }
  }
}

TEST_P(SixDof, NonFiniteAndIdenticalPoints) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(), 1e300};
  for (const CameraPairs& cameras : {InterPairs(), MixedPairs(), IntraPairs()}) {
    for (int k = 0; k < GetParam().sample_size; ++k) {
      for (const double value : bad) {
        RandomProblem problem = MakeRandomProblem(k, Options(GetParam().sample_size, cameras, 5.0));
        problem.matches[k].pixel2.x() = value;
        Solutions solutions;
        GetParam().solve(problem.Prepare(PriorKind::kNone), kIndices, &solutions);
        for (const Solution& solution : solutions) EXPECT_TRUE(solution.AllFinite());
      }
    }
    RandomProblem problem = MakeRandomProblem(7, Options(GetParam().sample_size, cameras, 5.0));
    for (Match& match : problem.matches) match = problem.matches[0];
    Solutions solutions;
    GetParam().solve(problem.Prepare(PriorKind::kNone), kIndices, &solutions);
    for (const Solution& solution : solutions) EXPECT_TRUE(solution.AllFinite());
  }
}

INSTANTIATE_TEST_SUITE_P(Baselines, SixDof,
                         testing::Values(Baseline{"li", 17, &Solve17ptLi},
                                         Baseline{"ventura", 6, &Solve6ptVentura},
                                         Baseline{"stewenius", 6, &Solve6ptStewenius}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace rigel
