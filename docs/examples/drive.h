// Stands for your sensors in the examples: a drive of a car with two cameras, and the matches
// between any two of its frames.
#ifndef RIGEL_DOCS_EXAMPLES_DRIVE_H_
#define RIGEL_DOCS_EXAMPLES_DRIVE_H_

#include <cmath>
#include <random>
#include <vector>

#include "rigel/core/frame_pair.h"

// Of the body: z forward, y down. A metre a frame, in a curve to the right.
inline rigel::Pose WorldFromFrame(int frame) {
  const double angle = 0.03 * frame;
  rigel::Pose pose;
  pose.R = rigel::RotationY(angle);
  pose.t = Eigen::Vector3d(1 - std::cos(angle), 0, std::sin(angle)) / 0.03;
  return pose;
}

// Rigel's motion, frame2_from_frame1.
inline rigel::Pose TrueMotion(int frame1, int frame2) {
  return WorldFromFrame(frame2).Inverse() * WorldFromFrame(frame1);
}

// Two frames with 200 matches of 0.5 px of noise; one in five is wrong. With `between_cameras`
// half of them are seen by one camera first and by the other one then: they determine |t|.
inline rigel::FramePair MatchFrames(int frame1, int frame2, bool between_cameras = true) {
  rigel::FramePair pair;
  rigel::RigCamera camera;
  camera.intrinsics = rigel::Camera::Pinhole(400, 400, 320, 240, 640, 480);
  for (const double x : {-0.5, 0.5}) {
    camera.s = {x, 0, 0};
    pair.rig.cameras.push_back(camera);
  }
  pair.prior.gravity1 = pair.prior.gravity2 = Eigen::Vector3d::UnitY();

  std::mt19937_64 random(1000 * frame1 + frame2);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  const auto noise = [&uniform] { return uniform(-0.866, 0.866); };  // 0.5 px, one sigma
  while (pair.matches.size() < 200) {
    const int k = static_cast<int>(pair.matches.size());
    rigel::Match match;
    match.camera1 = k % 2;
    match.camera2 = between_cameras && k % 4 < 2 ? 1 - match.camera1 : match.camera1;
    const rigel::RigCamera& c1 = pair.rig.cameras[match.camera1];
    const rigel::RigCamera& c2 = pair.rig.cameras[match.camera2];
    match.pixel1 = {uniform(0, 640), uniform(0, 480)};
    const Eigen::Vector3d X1 = uniform(5, 30) * AlongRay(c1.intrinsics, match.pixel1) + c1.s;
    const Eigen::Vector3d X2 = TrueMotion(frame1, frame2) * X1;
    if (!Project(c2.intrinsics, X2 - c2.s, &match.pixel2) || !c2.intrinsics.InImage(match.pixel2)) {
      continue;
    }
    if (k % 5 == 0) match.pixel2 = {uniform(0, 640), uniform(0, 480)};
    match.pixel1 += rigel::Pixel{noise(), noise()};
    match.pixel2 += rigel::Pixel{noise(), noise()};
    pair.matches.push_back(match);
  }
  return pair;
}

#endif  // RIGEL_DOCS_EXAMPLES_DRIVE_H_
