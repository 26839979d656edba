// The matches of a synthetic scene: noise, outliers, a car that moves by itself, scores. The scenes
// say where the points are.
#ifndef RIGEL_PROBLEMS_SCENES_SCENE_MATCHES_H_
#define RIGEL_PROBLEMS_SCENES_SCENE_MATCHES_H_

#include <string>

#include "rigel/core/frame_pair.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

// Where the points of a scene are seen.
class SceneGeometry {
 public:
  virtual ~SceneGeometry() = default;

  // Match number `number`, its cameras and exact pixels. False with a message if no point is seen.
  virtual bool DrawMatch(int number, bool inter, Random* random, Match* match,
                         std::string* error) = 0;

  // Other cars than before.
  virtual void DrawCars(Random* random) = 0;

  // Moves a match to a point of a car. An intra-camera match stays one, and so does an inter-camera
  // match. False if none is seen.
  virtual bool DrawCarMatch(Random* random, Match* match) = 0;
};

// Fills pair->matches, the columns `inlier` and `exact`, and noise_px, the standard deviation. If
// the noise of each camera is given, noise_px is the root mean square over the cameras, and
// the columns `sigma1` and `sigma2` have that of each point. The pair has its rig. `inlier` is 0
// for outliers, whose exact pixels are those that they have, and for matches of a car. False with a
// message if no point is seen.
bool DrawSceneMatches(const SceneMatchOptions& options, SceneGeometry* geometry, Random* random,
                      FramePair* pair, std::string* error);

// Whether the camera sees the point X of the body frame: in its image, and not nearer than
// kMinDistance. *pixel is then where.
bool Sees(const RigCamera& camera, const Eigen::Vector3d& X, Pixel* pixel);

// Uniform over the pixels of the image that have a ray.
Pixel DrawPixel(const Camera& camera, Random* random);

// Draws of a point before giving up: a motion that leaves fewer than one point in a thousand in
// view is out of view.
inline constexpr int kMaxDraws = 1000;

// Metres from a camera: what is nearer is not seen.
inline constexpr double kMinDistance = 0.1;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_SCENE_MATCHES_H_
