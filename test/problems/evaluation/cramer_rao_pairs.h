// Pairs of synthetic scenes with exact and with measured pixels, for the tests of the bound.
#ifndef RIGEL_TEST_PROBLEMS_EVALUATION_CRAMER_RAO_PAIRS_H_
#define RIGEL_TEST_PROBLEMS_EVALUATION_CRAMER_RAO_PAIRS_H_

#include "rigel/test/refine/refine_scene.h"

namespace rigel {

// The pair with its columns `inlier` and `exact`: the pixels as they are become the exact ones, the
// measured ones get noise of `noise_px`.
inline FramePair WithNoise(FramePair pair, double noise_px, int index) {
  Random random = Random::Stream(5, index);
  pair.columns.inlier.assign(pair.matches.size(), 1);
  pair.columns.exact.clear();
  for (Match& m : pair.matches) {
    pair.columns.exact.push_back({m.pixel1.x(), m.pixel1.y(), m.pixel2.x(), m.pixel2.y()});
    for (int c = 0; c < 2; ++c) m.pixel1(c) += noise_px * random.Normal();
    for (int c = 0; c < 2; ++c) m.pixel2(c) += noise_px * random.Normal();
  }
  pair.noise_px = noise_px;
  return pair;
}

// A pair of which the measured pixels alone are known.
inline FramePair MeasuredPair(const SceneOptions& scene, int index) {
  FramePair pair = ScenePair(scene, index);
  pair.columns = MatchColumns();
  return pair;
}

// A pair without noise, so that WithNoise() knows its exact pixels.
inline FramePair ExactPair(SceneOptions scene, int index) {
  scene.noise_px = 1e-9;
  return ScenePair(scene, index);
}

inline SceneOptions Scene(double inter_share, MotionPattern motion) {
  SceneOptions options;
  options.num_matches = 100;
  options.inter_share = inter_share;
  options.outlier_share = 0.1;
  options.motion = motion;
  return options;
}

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_EVALUATION_CRAMER_RAO_PAIRS_H_
