// The published baselines of two matches, of one camera and of a steered vehicle: 2pt-choi and
// 2pt-ackermann.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/minimal/solvers/two_point_ackermann.h"
#include "rigel/minimal/solvers/two_point_choi.h"
#include "rigel/test/minimal/random_problem.h"

namespace rigel {
namespace {

constexpr int kTwo[] = {0, 1};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ProblemOptions ChoiOptions(int camera) {
  ProblemOptions options;
  options.num_matches = 2;
  options.cameras = {{camera, camera}};
  options.motion = ProblemOptions::Motion::kPlanar;
  return options;
}

ProblemOptions AckermannOptions(CameraPairs cameras) {
  ProblemOptions options;
  options.num_matches = 2;
  options.cameras = std::move(cameras);
  options.motion = ProblemOptions::Motion::kAckermann;
  return options;
}

TEST(TwoPointChoi, FindsTheRotationAndTheDirectionOfTheCamera) {
  for (const bool random_axis : {false, true}) {
    ProblemOptions options = ChoiOptions(1);
    options.random_axis = random_axis;
    int found = 0;
    for (int seed = 0; seed < 2000; ++seed) {
      RandomProblem problem = MakeRandomProblem(seed, options);
      Solutions solutions;
      const int count = Solve2ptChoi(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
      EXPECT_EQ(count, solutions.size());
      EXPECT_LE(count, 2);
      const Eigen::Vector3d expected =
          Baseline(problem.truth, problem.rig.cameras[1].s, problem.rig.cameras[1].s);
      bool match = false;
      for (const Solution& solution : solutions) {
        EXPECT_FALSE(solution.has_scale);
        const Eigen::Vector3d baseline =
            Baseline(solution, problem.rig.cameras[1].s, problem.rig.cameras[1].s);
        EXPECT_NEAR(baseline.norm(), 1.0, 1e-9);
        EXPECT_NEAR(solution.t.dot(*problem.prior.normal), 0.0, 1e-9);
        for (int k = 0; k < 2; ++k) EXPECT_LT(ConstraintError(problem, k, solution), 1e-9) << seed;
        match = match || (RotationError(problem.truth.R, solution.R) < 1e-6 &&
                          TranslationDirectionError(expected, baseline) < 1e-5);
      }
      found += match;
    }
    EXPECT_GE(found, 1998);
  }
}

TEST(TwoPointChoi, AnOffCentreCameraTurnedByARotationInPlaceMovesOnItsArc) {
  // The body turns about its origin: the camera's own motion tells, t of the body is zero.
  ProblemOptions options = ChoiOptions(0);
  options.distance = 0.0;
  int found = 0;
  for (int seed = 0; seed < 500; ++seed) {
    const RandomProblem problem = MakeRandomProblem(seed, options);
    Solutions solutions;
    Solve2ptChoi(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
    const Eigen::Vector3d expected =
        Baseline(problem.truth, problem.rig.cameras[0].s, problem.rig.cameras[0].s);
    bool match = false;
    for (const Solution& solution : solutions) {
      match =
          match || (RotationError(problem.truth.R, solution.R) < 1e-6 &&
                    TranslationDirectionError(expected, Baseline(solution, problem.rig.cameras[0].s,
                                                                 problem.rig.cameras[0].s)) < 1e-4);
    }
    found += match;
  }
  EXPECT_GE(found, 490);
}

TEST(TwoPointChoi, PureTranslation) {
  ProblemOptions options = ChoiOptions(0);
  options.max_rotation_deg = 0.0;
  int found = 0;
  for (int seed = 0; seed < 500; ++seed) {
    const RandomProblem problem = MakeRandomProblem(seed, options);
    Solutions solutions;
    Solve2ptChoi(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
    const MotionError best = BestMotion(solutions, problem.truth);
    found += best.rotation < 1e-8 && best.direction < 1e-6 && best.scale < 1e-6;
  }
  EXPECT_GE(found, 498);
}

TEST(TwoPointChoi, OtherSamplesThanOfOneCameraHaveNoSolution) {
  for (const CameraPairs& cameras :
       {CameraPairs{{0, 1}}, CameraPairs{{0, 0}, {1, 1}}, CameraPairs{{0, 0}, {0, 1}}}) {
    ProblemOptions options = ChoiOptions(0);
    options.cameras = cameras;
    Solutions solutions;
    solutions.Append();
    EXPECT_EQ(
        Solve2ptChoi(MakeRandomProblem(1, options).Prepare(PriorKind::kPlanar), kTwo, &solutions),
        0);
    EXPECT_TRUE(solutions.empty());
  }
}

TEST(TwoPointChoi, NoMotionGivesFiniteMotionsOrNone) {
  ProblemOptions options = ChoiOptions(0);
  options.max_rotation_deg = 0.0;
  options.distance = 0.0;
  for (int seed = 0; seed < 200; ++seed) {
    Solutions solutions;
    Solve2ptChoi(MakeRandomProblem(seed, options).Prepare(PriorKind::kPlanar), kTwo, &solutions);
    for (const Solution& solution : solutions) EXPECT_TRUE(solution.AllFinite()) << seed;
  }
}

TEST(TwoPointChoi, PointsOnTheHorizonDoNotBreakIt) {
  for (int seed = 0; seed < 200; ++seed) {
    RandomProblem problem = MakeRandomProblem(seed, ChoiOptions(0));
    Random rng = Random::Stream(78, seed);
    for (RigCamera& camera : problem.rig.cameras) camera.Q = Eigen::Matrix3d::Identity();
    problem.prior.normal = Eigen::Vector3d::UnitY();
    problem.truth.R = RotationY(rng.Uniform(-0.2, 0.2));
    problem.truth.t = Eigen::Vector3d{rng.Normal(), 0.0, rng.Normal()}.normalized();
    // One of the two, then both; then one a hundredth of a pixel off, which is not degenerate.
    for (const double off : {1e3, 0.0, 0.01}) {
      for (int k = 0; k < 2; ++k) {
        const double row = k == 0 ? (off == 0.01 ? 240.01 : 240.0)
                                  : (off == 0.0 ? 240.0 : rng.Uniform(0.0, 200.0));
        EXPECT_TRUE(MakeMatch(problem.rig, problem.truth, 0, 0, {rng.Uniform(0.0, 640.0), row},
                              rng.Uniform(5.0, 30.0), &problem.matches[k]));
      }
      Solutions solutions;
      Solve2ptChoi(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
      for (const Solution& solution : solutions) EXPECT_TRUE(solution.AllFinite()) << seed;
      if (off == 0.01) {
        EXPECT_LT(BestRotationError(solutions, problem.truth), 1e-5) << seed;
      }
    }
  }
}

TEST(TwoPointAckermann, FindsTheTruthWithItsScale) {
  for (const CameraPairs& cameras : {InterPairs(), IntraPairs(), CameraPairs{{1, 1}}}) {
    for (const bool random_axis : {false, true}) {
      ProblemOptions options = AckermannOptions(cameras);
      options.random_axis = random_axis;
      int found = 0;
      for (int seed = 0; seed < 2000; ++seed) {
        const RandomProblem problem = MakeRandomProblem(seed, options);
        Solutions solutions;
        const int count = Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
        EXPECT_EQ(count, solutions.size());
        EXPECT_LE(count, 3);
        for (const Solution& solution : solutions) {
          for (int k = 0; k < 2; ++k)
            EXPECT_LT(ConstraintError(problem, k, solution), 1e-9) << seed;
        }
        const MotionError best = BestMotion(solutions, problem.truth);
        found +=
            best.rotation < 1e-6 && best.direction < 1e-6 && best.scale < 1e-4 && best.has_scale;
      }
      EXPECT_GE(found, 1995) << cameras[0].first << cameras[0].second;
    }
  }
}

TEST(TwoPointAckermann, AgreesWithTheTurnAboutAPointOfTheRearAxle) {
  // Another way to say the model: the centre of rotation (r, 0, 0) is the same point of both
  // body frames.
  int found = 0;
  for (int seed = 0; seed < 200; ++seed) {
    RandomProblem problem = MakeRandomProblem(seed, AckermannOptions(InterPairs()));
    Random rng = Random::Stream(79, seed);
    const double radius = rng.Uniform(5.0, 30.0) * (seed % 2 == 0 ? 1.0 : -1.0);
    const double forward = rng.Uniform(0.5, 1.5);
    // Turning about a point to the right (+x), the car's heading in the world swings by
    // forward / radius towards +x, and the world's points swing back.
    const Eigen::Vector3d centre(radius, 0.0, 0.0);
    problem.truth.R = RotationY(-forward / radius);
    problem.truth.t = centre - problem.truth.R * centre;
    // Driving forwards, what was at the origin falls behind.
    ASSERT_LT(problem.truth.t.z(), 0.0);
    problem.prior.normal = Eigen::Vector3d::UnitY();
    for (Match& match : problem.matches) {
      EXPECT_TRUE(MakeMatch(problem.rig, problem.truth, match.camera1, match.camera2,
                            {rng.Uniform(0.0, 640.0), rng.Uniform(0.0, 480.0)},
                            rng.Uniform(5.0, 30.0), &match));
    }
    Solutions solutions;
    Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
    const MotionError best = BestMotion(solutions, problem.truth);
    found += best.rotation < 1e-7 && best.direction < 1e-6 && best.scale < 1e-5;
  }
  EXPECT_GE(found, 199);
}

TEST(TwoPointAckermann, StraightAheadSeenByIntraCameraMatchesHasNoScale) {
  ProblemOptions options = AckermannOptions(IntraPairs());
  options.max_rotation_deg = 0.0;
  int found = 0;
  for (int seed = 0; seed < 500; ++seed) {
    const RandomProblem problem = MakeRandomProblem(seed, options);
    Solutions solutions;
    Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
    const MotionError best = BestMotion(solutions, problem.truth);
    found += best.rotation < 1e-8 && best.direction < 1e-8 && best.scale < 1e-8 && !best.has_scale;
  }
  EXPECT_GE(found, 498);
}

TEST(TwoPointAckermann, ACameraAboveTheOriginHasNoScale) {
  int found = 0;
  for (int seed = 0; seed < 500; ++seed) {
    RandomProblem problem = MakeRandomProblem(seed, AckermannOptions({{0, 0}}));
    Random rng = Random::Stream(80, seed);
    // Up to the normal, whose foot is the origin.
    problem.rig.cameras[0].s = -1.5 * *problem.prior.normal;
    for (Match& match : problem.matches) {
      EXPECT_TRUE(MakeMatch(problem.rig, problem.truth, 0, 0,
                            {rng.Uniform(0.0, 640.0), rng.Uniform(0.0, 480.0)},
                            rng.Uniform(5.0, 30.0), &match));
    }
    Solutions solutions;
    Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions);
    const MotionError best = BestMotion(solutions, problem.truth);
    found += best.rotation < 1e-6 && best.direction < 1e-6 && !best.has_scale;
  }
  EXPECT_GE(found, 495);
}

TEST(TwoPointAckermann, DegenerateSamples) {
  // No motion.
  for (const CameraPairs& cameras : {InterPairs(), IntraPairs()}) {
    ProblemOptions options = AckermannOptions(cameras);
    options.max_rotation_deg = 0.0;
    options.distance = 0.0;
    for (int seed = 0; seed < 200; ++seed) {
      Solutions solutions;
      Solve2ptAckermann(MakeRandomProblem(seed, options).Prepare(PriorKind::kPlanar), kTwo,
                        &solutions);
      for (const Solution& solution : solutions) EXPECT_TRUE(solution.AllFinite()) << seed;
    }
  }
  // Straight ahead is out of the plane.
  RandomProblem problem = MakeRandomProblem(1, AckermannOptions(InterPairs()));
  problem.prior.normal = Eigen::Vector3d::UnitZ();
  Solutions solutions;
  EXPECT_EQ(Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions), 0);
  // Nobody says where it is.
  problem = MakeRandomProblem(1, AckermannOptions(InterPairs()));
  EXPECT_GT(Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions), 0);
  problem.prior.forward.reset();
  EXPECT_EQ(Solve2ptAckermann(problem.Prepare(PriorKind::kPlanar), kTwo, &solutions), 0);
}

TEST(Baseline2pt, NonFiniteInputGivesNoFiniteMotion) {
  for (const double value : {kNan, kInfinity}) {
    for (int k = 0; k < 2; ++k) {
      Solutions solutions;
      RandomProblem one = MakeRandomProblem(k, ChoiOptions(0));
      one.matches[k].pixel1.y() = value;
      Solve2ptChoi(one.Prepare(PriorKind::kPlanar), kTwo, &solutions);
      for (const Solution& solution : solutions) EXPECT_FALSE(solution.AllFinite());
      for (const CameraPairs& cameras : {InterPairs(), IntraPairs()}) {
        RandomProblem arc = MakeRandomProblem(k, AckermannOptions(cameras));
        arc.matches[k].pixel1.y() = value;
        Solve2ptAckermann(arc.Prepare(PriorKind::kPlanar), kTwo, &solutions);
        for (const Solution& solution : solutions) EXPECT_FALSE(solution.AllFinite());
      }
    }
  }
}

}  // namespace
}  // namespace rigel
