// What the tests of noise in the pixels share: moved pixels, numeric rows, a scene of little depth.
#ifndef RIGEL_TEST_REFINE_PIXEL_NOISE_H_
#define RIGEL_TEST_REFINE_PIXEL_NOISE_H_

#include <vector>

#include <Eigen/Core>

#include "rigel/core/epipolar.h"
#include "rigel/core/frame_pair.h"
#include "rigel/core/random.h"
#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Pixel coordinates in the order u1, v1, u2, v2.
inline Match Moved(Match m, int coordinate, double h) {
  (coordinate < 2 ? m.pixel1 : m.pixel2)(coordinate % 2) += h;
  return m;
}

inline std::vector<Match> WithNoise(std::vector<Match> matches, double noise_px, Random* random) {
  for (Match& m : matches) {
    for (int c = 0; c < 4; ++c) m = Moved(m, c, noise_px * random->Normal());
  }
  return matches;
}

// The derivative of a match's Sampson error by the motion.
inline Vector6 NumericRow(const Rig& rig, const Match& m, const Pose& pose) {
  Vector6 row;
  for (int k = 0; k < 6; ++k) {
    row(k) = CentralDifference(
        [&](double h) {
          Vector6d step = Vector6d::Zero();
          step(k) = h;
          return Eigen::Matrix<double, 1, 1>(SampsonError(Perturbed(pose, step), rig, m));
        },
        1e-4)(0);
  }
  return row;
}

// Stereo before a wall at 8 to 9 m, 0.58 m of motion; exact pixels.
inline FramePair WallPair(Random* random) {
  FramePair pair;
  for (const double x : {0.0, 0.537}) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(707, 707, 601, 183, 1226, 370);
    camera.s = {x, 0, 0};
    pair.rig.cameras.push_back(camera);
  }
  const Pose truth = {ExpSO3(Eigen::Vector3d(0, DegToRad(1.0), 0)), {0.5, 0, -0.3}};
  pair.truth = truth;
  while (pair.matches.size() < 200) {
    // One after the other: the order of arguments is the compiler's.
    const double z = random->Uniform(8, 9);
    const double y = random->Uniform(-3, 2);
    const double x_body = random->Uniform(-6, 6);
    const Eigen::Vector3d X(x_body, y, z);
    Match m;
    m.camera1 = static_cast<int>(pair.matches.size()) % 2;
    m.camera2 = static_cast<int>(pair.matches.size() / 2) % 2;
    const auto project = [&](int k, const Eigen::Vector3d& x) {
      const RigCamera& camera = pair.rig.cameras[k];
      return ProjectPinhole(camera.intrinsics, camera.Q.transpose() * (x - camera.s));
    };
    m.pixel1 = project(m.camera1, X);
    m.pixel2 = project(m.camera2, truth * X);
    pair.matches.push_back(m);
  }
  return pair;
}

}  // namespace rigel

#endif  // RIGEL_TEST_REFINE_PIXEL_NOISE_H_
