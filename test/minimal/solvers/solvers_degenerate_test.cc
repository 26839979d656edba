// The solvers of the paper's family on named special cases: pure translation, one camera, samples
// that are broken.
#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/test/minimal/solvers/family_samples.h"

namespace rigel {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(AllSolvers, PureTranslationOfIntraCameraMatchesGivesTheDirectionAndNoScale) {
  // A rotation of 1e-9 rad is none: the scale that it gives is rounding.
  for (const double rotation_deg : {0.0, 1e-7}) {
    Scene scene;
    scene.rotation_deg = rotation_deg;
    for (const char* name : kFamily) {
      const SolverInfo& solver = Find(name);
      int found = 0;
      for (int seed = 0; seed < kSeeds; ++seed) {
        const FramePair pair = MakePair(solver, scene, seed);
        for (const Solution& solution : Solve(solver, pair)) {
          if (RotationError(pair.truth->R, solution.R) < 1e-7 &&
              TranslationDirectionError(pair.truth->t, solution.t) < 1e-5 && !solution.has_scale) {
            EXPECT_NEAR(solution.t.norm(), 1.0, 1e-6) << "the cameras' baseline, of unit length";
            ++found;
            break;
          }
        }
      }
      EXPECT_GE(found, 0.99 * kSeeds) << name << " at " << rotation_deg;
    }
  }
}

TEST(AllSolvers, PureTranslationOfInterCameraMatchesHasAScale) {
  Scene scene;
  scene.rotation_deg = 0.0;
  scene.inter = true;
  for (const char* name : kFamily) {
    // At zero rotation the first order is exact.
    EXPECT_GE(FoundShares(Find(name), scene).motion, 0.99) << name;
  }
}

TEST(AllSolvers, SingleCameraGivesTheDirectionOfItsBaselineAndNoScale) {
  Scene scene;
  scene.num_cameras = 1;
  for (const char* name : kFamily) {
    const SolverInfo& solver = Find(name);
    int found = 0;
    std::vector<double> rotation_errors;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const FramePair pair = MakePair(solver, scene, seed);
      const Eigen::Vector3d& s = pair.rig.cameras[0].s;
      const auto baseline = [&s](const Pose& pose) {
        return Eigen::Vector3d(pose.R * s + pose.t - s);
      };
      bool found_it = false;
      double rotation_error = kInf;
      for (const Solution& solution : Solve(solver, pair)) {
        EXPECT_FALSE(solution.has_scale) << name;
        EXPECT_NEAR(baseline(solution).norm(), 1.0, 1e-9) << name;
        const double rotation = RotationError(pair.truth->R, solution.R);
        rotation_error = std::min(rotation_error, rotation);
        found_it = found_it ||
                   (rotation < 1e-6 &&
                    TranslationDirectionError(baseline(*pair.truth), baseline(solution)) < 1e-4);
      }
      found += found_it;
      rotation_errors.push_back(rotation_error);
    }
    std::sort(rotation_errors.begin(), rotation_errors.end());
    if (solver.exact) {
      EXPECT_GE(found, 0.998 * kSeeds) << name;
    } else if (std::string(name).find("polished") != std::string::npos) {
      EXPECT_GE(found, 0.93 * kSeeds) << name;
    } else {
      EXPECT_LE(RadToDeg(rotation_errors[kSeeds / 2]), 0.5) << name;
    }
  }
}

// Each damage to a good sample gives no solution or some, never a crash or a loop without end.
TEST(AllSolvers, SurviveDegenerateSamples) {
  struct Damage {
    const char* what;
    std::function<void(FramePair*)> apply;
  };
  const Damage damages[] = {
      {"identical matches",
       [](FramePair* pair) {
         for (Match& match : pair->matches) match = pair->matches[0];
       }},
      {"two identical matches", [](FramePair* pair) { pair->matches[1] = pair->matches[0]; }},
      {"coinciding cameras",
       [](FramePair* pair) {
         for (RigCamera& camera : pair->rig.cameras) camera.s = pair->rig.cameras[0].s;
       }},
      {"all at the principal point",
       [](FramePair* pair) {
         for (Match& match : pair->matches) match.pixel1 = match.pixel2 = {320.0, 240.0};
       }},
      {"far outside the image",
       [](FramePair* pair) {
         for (Match& match : pair->matches) match.pixel2 *= 1e12;
       }},
      {"huge rig",
       [](FramePair* pair) {
         for (RigCamera& camera : pair->rig.cameras) camera.s *= 1e100;
       }},
  };
  for (const char* name : kFamily) {
    const SolverInfo& solver = Find(name);
    for (const Damage& damage : damages) {
      for (const bool inter : {false, true}) {
        for (int seed = 0; seed < 20; ++seed) {
          Scene scene;
          scene.inter = inter;
          FramePair pair = MakePair(solver, scene, seed);
          damage.apply(&pair);
          SCOPED_TRACE(std::string(name) + ": " + damage.what);
          // Checks the number of solutions and that each R is a rotation.
          Solve(solver, pair);
        }
      }
    }
  }
}

TEST(AllSolvers, NoMotionGivesNoSolution) {
  // Nothing is known of t, and a direction would be made up.
  for (const char* name : kFamily) {
    const SolverInfo& solver = Find(name);
    for (int seed = 0; seed < 100; ++seed) {
      FramePair pair = MakePair(solver, Scene(), seed);
      for (Match& match : pair.matches) match.pixel2 = match.pixel1;
      pair.prior.gravity2 = pair.prior.gravity1;
      EXPECT_TRUE(Solve(solver, pair).empty()) << name << " seed " << seed;
    }
  }
}

TEST(AllSolvers, NonFiniteInputGivesNoFiniteSolution) {
  for (const char* name : kFamily) {
    const SolverInfo& solver = Find(name);
    for (const bool inter : {false, true}) {
      for (const double bad : {kNan, kInf, -kInf}) {
        for (int k = 0; k < solver.sample_size; ++k) {
          Scene scene;
          scene.inter = inter;
          FramePair pair = MakePair(solver, scene, k);
          pair.matches[k].pixel2.y() = bad;
          for (const Solution& solution : Solve(solver, pair)) {
            EXPECT_FALSE(solution.AllFinite()) << name << " match " << k << " " << bad;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace rigel
