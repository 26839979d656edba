// Random problems of the scene of docs (two forward cameras a metre apart, points 5-30 m away)
// for the tests of the minimal solvers: noise-free, with the truth and every prior exact.
#ifndef RIGEL_TEST_MINIMAL_RANDOM_PROBLEM_H_
#define RIGEL_TEST_MINIMAL_RANDOM_PROBLEM_H_

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "rigel/core/alignment.h"
#include "rigel/core/angles.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/match.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pose.h"
#include "rigel/core/prior.h"
#include "rigel/core/random.h"
#include "rigel/core/rig.h"
#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"
#include "rigel/test/core/pinhole.h"

namespace rigel {

// Camera at time 1 and at time 2.
using CameraPairs = std::vector<std::pair<int, int>>;

inline CameraPairs InterPairs() { return {{0, 1}, {1, 0}}; }
inline CameraPairs IntraPairs() { return {{0, 0}, {1, 1}}; }
inline CameraPairs IntraPairsOfThree() { return {{0, 0}, {1, 1}, {2, 2}}; }

struct ProblemOptions {
  int num_matches = 4;
  int num_cameras = 2;                 // or 3: one more above and ahead of the others
  CameraPairs cameras = InterPairs();  // match k is of cameras[k % size]

  // The rotation is about an axis near body Y, or one uniform on the sphere, by an angle uniform
  // in [-max, max] or by exactly max.
  double max_rotation_deg = 30.0;
  bool exact_rotation = false;
  bool random_axis = false;

  // t: any direction; in the plane of the axis; along the arc of an Ackermann vehicle.
  enum class Motion { kAny, kPlanar, kAckermann } motion = Motion::kAny;
  double distance = 1.0;  // |t|, metres
};

struct RandomProblem {
  Rig rig;
  Pose truth;
  MotionPrior prior;
  std::vector<Match> matches;

  PreparedMatches Prepare(PriorKind kind) const {
    Alignment alignment;
    std::string error;
    MakeAlignment(prior, kind, &alignment, &error);
    return PreparedMatches(rig, matches, alignment);
  }
};

// A match of a point that `camera1` sees at `pixel1`, `depth` metres along its optical axis, at
// time 1, and that `camera2` sees at time 2. False if it is behind camera 2.
inline bool MakeMatch(const Rig& rig, const Pose& truth, int camera1, int camera2,
                      const Eigen::Vector2d& pixel1, double depth, Match* match) {
  const RigCamera& c1 = rig.cameras[camera1];
  const RigCamera& c2 = rig.cameras[camera2];
  const Eigen::Vector3d X1 = c1.Q * (depth * AlongRay(c1.intrinsics, pixel1)) + c1.s;
  const Eigen::Vector3d X2 = c2.Q.transpose() * (truth * X1 - c2.s);
  if (!(X2.z() > 0.1)) return false;
  match->camera1 = camera1;
  match->pixel1 = pixel1;
  match->camera2 = camera2;
  match->pixel2 = ProjectPinhole(c2.intrinsics, X2);
  return true;
}

inline RandomProblem MakeRandomProblem(uint64_t seed, const ProblemOptions& options) {
  Random rng = Random::Stream(20240601, seed);
  RandomProblem problem;
  for (int k = 0; k < options.num_cameras; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
    camera.Q = ExpSO3(0.1 * rng.NormalVector3());
    const Eigen::Vector3d centre =
        k < 2 ? Eigen::Vector3d(k - 0.5, 0.0, 0.0) : Eigen::Vector3d(0.0, 0.4, 0.3);
    camera.s = centre + 0.05 * rng.NormalVector3();
    problem.rig.cameras.push_back(camera);
  }

  const Eigen::Vector3d near_y = ExpSO3(0.1 * rng.NormalVector3()) * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d uniform = rng.UnitVector3();
  const Eigen::Vector3d axis = options.random_axis ? uniform : near_y;
  const double max_angle = DegToRad(options.max_rotation_deg);
  const double share = rng.Uniform(-1.0, 1.0);
  const double angle = options.exact_rotation ? max_angle : share * max_angle;
  problem.truth.R = ExpSO3(angle * axis);
  Eigen::Vector3d direction = rng.UnitVector3();
  if (options.motion != ProblemOptions::Motion::kAny) {
    if (options.motion == ProblemOptions::Motion::kAckermann) {
      // The second body frame lies half way round the arc's turn, ahead or behind.
      const Eigen::Vector3d heading =
          ExpSO3(-0.5 * angle * axis) * (Eigen::Vector3d::UnitZ() - axis.z() * axis).normalized();
      direction = problem.truth.R * heading * (rng.Uniform() < 0.5 ? -1.0 : 1.0);
    }
    direction = (direction - axis.dot(direction) * axis).normalized();
  }
  problem.truth.t = options.distance * direction;
  problem.prior.gravity1 = near_y;
  problem.prior.gravity2 = problem.truth.R * near_y;
  problem.prior.axis = axis;
  problem.prior.normal = axis;
  problem.prior.forward = Eigen::Vector3d::UnitZ();

  for (int tries = 0; tries < 100000; ++tries) {
    const int count = static_cast<int>(problem.matches.size());
    if (count == options.num_matches) break;
    const auto& pair = options.cameras[count % options.cameras.size()];
    const Eigen::Vector2d pixel{rng.Uniform(0.0, 640.0), rng.Uniform(0.0, 480.0)};
    Match match;
    if (MakeMatch(problem.rig, problem.truth, pair.first, pair.second, pixel,
                  rng.Uniform(5.0, 30.0), &match) &&
        problem.rig.cameras[pair.second].intrinsics.InImage(match.pixel2)) {
      problem.matches.push_back(match);
    }
  }
  return problem;
}

// Radians; infinity if there is no solution.
inline double BestRotationError(const Solutions& solutions, const Pose& truth) {
  double best = std::numeric_limits<double>::infinity();
  for (const Solution& solution : solutions) {
    best = std::min(best, RotationError(truth.R, solution.R));
  }
  return best;
}

// The translation errors of the solution nearest in rotation and direction together.
struct MotionError {
  double rotation = std::numeric_limits<double>::infinity();   // radians
  double direction = std::numeric_limits<double>::infinity();  // radians
  double scale = std::numeric_limits<double>::infinity();      // a fraction
  bool has_scale = false;
};

inline MotionError BestMotion(const Solutions& solutions, const Pose& truth) {
  MotionError best;
  for (const Solution& solution : solutions) {
    const double rotation = RotationError(truth.R, solution.R);
    const double direction = TranslationDirectionError(truth.t, solution.t);
    if (rotation + direction < best.rotation + best.direction) {
      best = {rotation, direction, ScaleError(truth.t, solution.t), solution.has_scale};
    }
  }
  return best;
}

// How far a match is from the epipolar constraint of a solution, relative to the length of t.
inline double ConstraintError(const RandomProblem& problem, int match, const Solution& solution) {
  return std::abs(GecTripleProduct(solution, MakeRayPair(problem.rig, problem.matches[match]))) /
         (1.0 + solution.t.norm());
}

}  // namespace rigel

#endif  // RIGEL_TEST_MINIMAL_RANDOM_PROBLEM_H_
