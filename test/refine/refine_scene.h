// What the tests of the refinement share: pairs of the scene, poses near the truth, numeric
// derivatives in the library's perturbation.
#ifndef RIGEL_TEST_REFINE_REFINE_SCENE_H_
#define RIGEL_TEST_REFINE_REFINE_SCENE_H_

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "rigel/core/angles.h"
#include "rigel/core/frame_pair.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/refine/refine.h"
#include "rigel/test/core/random_vector.h"

namespace rigel {

// Pair `index` of the scene; the running test fails if there is none.
inline FramePair ScenePair(const SceneOptions& options, int index) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, index, &pair, &error)) << error;
  return pair;
}

inline FramePair ScenePair(const SceneOptions& options, int index, const Pose& truth) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, index, truth, &pair, &error)) << error;
  return pair;
}

inline RefineSummary RefinePair(const RefineOptions& options, const FramePair& pair, Pose* pose) {
  return Refine(options, pair.rig, pair.matches, pair.prior, pose);
}

// R <- Exp(d) R, t <- t + e.
inline Pose Perturbed(const Pose& pose, const Vector6d& d) {
  Pose result;
  result.R = ExpSO3(d.head<3>()) * pose.R;
  result.t = pose.t + d.tail<3>();
  return result;
}

// The (d, e) that leads from `from` to `to`.
inline Vector6d Difference(const Pose& to, const Pose& from) {
  Vector6d d;
  d << LogSO3(to.R * from.R.transpose()), to.t - from.t;
  return d;
}

// Off by `degrees` of rotation and by `share` of |t|, each in a random direction.
inline Pose StartNear(const Pose& truth, double degrees, double share, Random* random) {
  Vector6d d;
  d << DegToRad(degrees) * random->UnitVector3(), share * truth.t.norm() * random->UnitVector3();
  return Perturbed(truth, d);
}

// Unrelated directions and a distance, each with a sigma.
inline MotionPrior FullPrior(Random* random) {
  MotionPrior prior;
  prior.gravity1 = random->UnitVector3();
  prior.gravity2 = random->UnitVector3();
  prior.axis = random->UnitVector3();
  prior.normal = random->UnitVector3();
  prior.gravity_sigma = random->Uniform(1e-3, 1e-1);
  prior.axis_sigma = random->Uniform(1e-3, 1e-1);
  prior.normal_sigma = random->Uniform(1e-3, 1e-1);
  prior.distance = random->Uniform(0.5, 2.0);
  prior.distance_sigma = random->Uniform(1e-3, 1e-1);
  return prior;
}

// Three cameras of unlike focal lengths, fx != fy, anywhere on the body.
inline Rig MixedRig(Random* random) {
  Rig rig;
  for (int k = 0; k < 3; ++k) {
    RigCamera camera;
    // In braces the draws are in order.
    camera.intrinsics = {CameraModel::kPinhole,
                         {random->Uniform(300, 900), random->Uniform(300, 900),
                          random->Uniform(250, 350), random->Uniform(200, 280)},
                         640,
                         480};
    camera.Q = ExpSO3(RandomVector3(0.0, 3.0, random));
    camera.s = RandomVector3(0.1, 1.5, random);
    rig.cameras.push_back(camera);
  }
  return rig;
}

// `count` matches of all camera pairs in turn, of unrelated pixels.
inline std::vector<Match> UnrelatedMatches(const Rig& rig, int count, Random* random) {
  std::vector<Match> matches;
  for (int k = 0; k < count; ++k) {
    Match m;
    m.camera1 = k % rig.size();
    m.camera2 = (k / rig.size()) % rig.size();
    m.pixel1 = {random->Uniform(0, 640), random->Uniform(0, 480)};
    m.pixel2 = {random->Uniform(0, 640), random->Uniform(0, 480)};
    matches.push_back(m);
  }
  return matches;
}

// A central difference of fourth order of f(h), so that the step can be large enough for rounding
// not to matter.
template <class Function>
auto CentralDifference(const Function& f, double h) {
  return ((8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)).eval();
}

inline double MedianOf(std::vector<double> values) {
  if (values.empty()) return -1.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

inline double RotationErrorDeg(const Pose& truth, const Pose& pose) {
  return RadToDeg(RotationError(truth.R, pose.R));
}

inline double DirectionErrorDeg(const Pose& truth, const Pose& pose) {
  return RadToDeg(TranslationDirectionError(truth.t, pose.t));
}

}  // namespace rigel

#endif  // RIGEL_TEST_REFINE_REFINE_SCENE_H_
