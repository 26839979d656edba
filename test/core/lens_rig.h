// Rigs of cameras of any model, anywhere on the body, and matches of them.
#ifndef RIGEL_TEST_CORE_LENS_RIG_H_
#define RIGEL_TEST_CORE_LENS_RIG_H_

#include <vector>

#include "rigel/core/match.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"
#include "rigel/core/rig.h"
#include "rigel/test/core/camera_cases.h"
#include "rigel/test/core/random_vector.h"

namespace rigel {

struct LensRig {
  Rig rig;
  std::vector<CameraCase> cases;  // of the cameras
};

// Three cameras: numbers from 0 on have all cases in turn.
inline LensRig MakeLensRig(int number, Random* random) {
  const std::vector<CameraCase> all = CameraCases();
  LensRig lenses;
  for (int k = 0; k < 3; ++k) {
    lenses.cases.push_back(all[(3 * number + k) % all.size()]);
    RigCamera camera;
    camera.intrinsics = lenses.cases.back().camera;
    camera.Q = ExpSO3(RandomVector3(0.0, 3.0, random));
    camera.s = RandomVector3(0.1, 1.5, random);
    lenses.rig.cameras.push_back(camera);
  }
  return lenses;
}

// A pixel anywhere in the camera's field of view.
inline Pixel LensPixel(const CameraCase& lens, Random* random) {
  Pixel pixel(0, 0);
  Project(lens.camera, RandomRay(lens, random), &pixel);
  return pixel;
}

// `count` matches of all camera pairs in turn, of unrelated pixels.
inline std::vector<Match> UnrelatedLensMatches(const LensRig& lenses, int count, Random* random) {
  std::vector<Match> matches;
  const int n = lenses.rig.size();
  for (int k = 0; k < count; ++k) {
    Match m;
    m.camera1 = k % n;
    m.camera2 = (k / n) % n;
    m.pixel1 = LensPixel(lenses.cases[m.camera1], random);
    m.pixel2 = LensPixel(lenses.cases[m.camera2], random);
    matches.push_back(m);
  }
  return matches;
}

}  // namespace rigel

#endif  // RIGEL_TEST_CORE_LENS_RIG_H_
