// Samples of the paper's family of solvers, and how near their solutions are to the truth.
#ifndef RIGEL_TEST_MINIMAL_SOLVERS_FAMILY_SAMPLES_H_
#define RIGEL_TEST_MINIMAL_SOLVERS_FAMILY_SAMPLES_H_

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "rigel/core/metrics.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

inline constexpr int kSample[] = {0, 1, 2, 3};
inline constexpr int kSeeds = 1000;

inline constexpr const char* kFirstOrder[] = {"4pt-approx", "4pt-axis-approx", "3pt-approx"};
inline constexpr const char* kPolished[] = {"4pt-approx-polished", "4pt-axis-approx-polished",
                                            "3pt-approx-polished"};
inline constexpr const char* kExact[] = {"4pt", "4pt-axis", "3pt"};
inline constexpr const char* kFamily[] = {"4pt-approx",
                                          "4pt-axis-approx",
                                          "3pt-approx",
                                          "4pt-approx-polished",
                                          "4pt-axis-approx-polished",
                                          "3pt-approx-polished",
                                          "4pt",
                                          "4pt-axis",
                                          "3pt"};

inline const SolverInfo& Find(const char* name) {
  const SolverInfo* info = FindSolver(name);
  EXPECT_NE(info, nullptr) << name;
  return *info;
}

struct Scene {
  double rotation_deg = 1.0;
  bool inter = false;
  int num_cameras = 2;
  // About a random axis where the solver allows it; then R = I is not in the family of the
  // vertical solvers and nothing is deflated.
  bool random_axis = false;
};

inline FramePair MakePair(const SolverInfo& solver, const Scene& scene, int seed) {
  SceneOptions options;
  options.num_cameras = scene.num_cameras;
  options.num_matches = solver.sample_size;
  options.noise_px = 0.0;
  options.rotation_deg = scene.rotation_deg;
  options.inter_share = scene.inter ? 1.0 : 0.0;
  options.seed = 2024;
  const bool planar = solver.prior == PriorKind::kPlanar;
  options.motion = planar ? MotionPattern::kPlanar : MotionPattern::kRandom;
  if (scene.random_axis && !planar) options.rotation_axis = RotationAxisPattern::kRandom;
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, seed, &pair, &error)) << error;
  return pair;
}

inline Solutions Solve(const SolverInfo& solver, const FramePair& pair) {
  Alignment alignment;
  std::string error;
  EXPECT_TRUE(MakeAlignment(pair.prior, solver.prior, &alignment, &error)) << error;
  Solutions solutions;
  // What was there is overwritten.
  solutions.Append().R.setZero();
  const PreparedMatches matches(pair.rig, pair.matches, alignment);
  const int count = solver.solve(matches, kSample, &solutions);
  EXPECT_EQ(count, solutions.size()) << solver.name;
  EXPECT_LE(solutions.size(), solver.max_solutions) << solver.name;
  for (const Solution& solution : solutions) {
    if (!solution.R.allFinite()) continue;
    EXPECT_LT((solution.R.transpose() * solution.R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(solution.R.determinant(), 1.0, 1e-12);
  }
  return solutions;
}

// Angles of the best solution, radians; infinity if there is none.
struct Errors {
  double rotation = std::numeric_limits<double>::infinity();
  double direction = std::numeric_limits<double>::infinity();
  double scale = std::numeric_limits<double>::infinity();
  bool has_scale = true;
};

inline Errors Best(const Solutions& solutions, const Pose& truth) {
  Errors best;
  for (const Solution& solution : solutions) {
    const double rotation = RotationError(truth.R, solution.R);
    if (rotation < best.rotation) {
      best = {rotation, TranslationDirectionError(truth.t, solution.t),
              ScaleError(truth.t, solution.t), solution.has_scale};
    }
  }
  return best;
}

struct Shares {
  double rotation = 0.0;  // below 1e-6 rad
  double motion = 0.0;    // and the direction below 1e-4 rad, the scale below 1e-3
};

inline Shares FoundShares(const SolverInfo& solver, const Scene& scene) {
  int rotation = 0, motion = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const FramePair pair = MakePair(solver, scene, seed);
    const Errors best = Best(Solve(solver, pair), *pair.truth);
    rotation += best.rotation < 1e-6;
    motion += best.rotation < 1e-6 && best.direction < 1e-4 && best.scale < 1e-3 && best.has_scale;
  }
  return {rotation / static_cast<double>(kSeeds), motion / static_cast<double>(kSeeds)};
}

}  // namespace rigel

#endif  // RIGEL_TEST_MINIMAL_SOLVERS_FAMILY_SAMPLES_H_
