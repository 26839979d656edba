// Synthetic frame pairs: the scene of the benchmarks.
//
// Two forward cameras at (-0.5, 0, 0) and (0.5, 0, 0) m, each moved by N(0, 0.05 m) and turned by
// N(0, 0.1 rad) per axis. They have 640 x 480 pixels, focal length 400, and the principal point at
// the centre. Image points uniform in view 1, depth uniform in 5-30 m, kept if they fall into the
// image of view 2.
//
// A ring, where one is asked for: 1 to 16 such cameras on a circle of 1 m radius in the plane
// perpendicular to the body's down. They are at equal angles, the first ahead, each facing outwards
// with its image's y down. Exactly so. Matches between cameras are of neighbours.
//
// A car, where one is asked for: a box 4.5 m long, 1.8 m wide and 1.5 m high, 5-15 m in front of
// the rig, with points uniform in it. Between the frames it moves by 0.5-2 m over the ground, in
// any direction, and turns by up to 3 degrees about its vertical.
//
// Scores as of a matcher with Lowe's ratio test at 0.8, distributed as SIFT's on KITTI 06. That of
// a true match, the car's too, is 0.8 times the mean of two uniform numbers, that of an outlier 0.8
// times the largest of eleven.
#ifndef RIGEL_PROBLEMS_SCENES_SYNTHETIC_H_
#define RIGEL_PROBLEMS_SCENES_SYNTHETIC_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/frame_pair.h"

namespace rigel {

// kTurn: the rotation alone, about the body's origin, so that t is exactly 0. kStill: no rotation
// either.
enum class MotionPattern { kForward, kRandom, kSideways, kPlanar, kTurn, kStill };
enum class RotationAxisPattern { kY, kRandom };

// "forward", "random", "sideways", "planar", "turn", "still"; "y", "random". False if there is no
// such name.
bool ParseMotionPattern(std::string_view name, MotionPattern* pattern);
bool ParseRotationAxisPattern(std::string_view name, RotationAxisPattern* pattern);

// Cameras, then 22.5 degrees apart: each of 77 degrees shares most of its view with its
// neighbours', and more would add little.
inline constexpr int kMaxRing = 16;
// Cameras of 77 degrees: neighbours of a ring of fewer see nothing in common.
inline constexpr int kMinRingOfNeighbours = 5;

// Distributions of the noise on one coordinate, for a stated sigma:
//   kGaussian  of that standard deviation
//   kMixture   Gaussian, 80 percent of 0.6 sigma and 20 percent of 3 sigma
//   kLaplace   of that standard deviation
//   kStudent3  Student's t with three degrees of freedom, of that standard deviation
enum class NoiseShape { kGaussian, kMixture, kLaplace, kStudent3 };

// "gaussian", "mixture", "laplace", "t3". False if there is no such name.
bool ParseNoiseShape(std::string_view name, NoiseShape* shape);

// What the matches of a scene are like: of this one, and of the street (street.h).
struct SceneMatchOptions {
  int num_matches = 200;
  double noise_px = 0.5;                // sigma on each image coordinate of both views
  std::vector<double> camera_noise_px;  // the same of each camera instead; empty: noise_px
  NoiseShape noise_model = NoiseShape::kGaussian;
  double inter_share = 0.0;    // of the matches; needs two cameras
  double outlier_share = 0.0;  // second point uniform in the image
  double moving_share = 0.0;   // on the car; none of them an outlier
  bool match_scores = false;   // else all 0, unknown
  // The error of the rig that sees the scene against the one that is stated (scene_rig.h), 1 sigma
  // per axis, and whether that sigma is stated with the rig.
  double calibration_sigma_deg = 0.0;
  double calibration_sigma_m = 0.0;
  bool state_calibration_sigma = false;
  // Seconds that each camera fires after the times of the pair; empty: as the rig says.
  std::vector<double> camera_times;
  double interval_s = 0.1;  // between the times of a pair, for cameras that fire later
  uint64_t seed = 1;

  bool AreMatchesValid(int num_cameras, std::string* error) const;

 private:
  bool IsSeenRigValid(int num_cameras, std::string* error) const;
};

struct SceneOptions : SceneMatchOptions {
  // 1 to 4, the third and fourth at (0, 0.4, 0.3) and (0, -0.4, 0.3) m; of a ring 1 to kMaxRing.
  int num_cameras = 2;
  bool ring = false;
  double rotation_deg = 1.0;  // about the axis, exactly
  RotationAxisPattern rotation_axis = RotationAxisPattern::kY;
  MotionPattern motion = MotionPattern::kForward;  // if any, |t| = 1 m; forward +z, sideways +x

  bool IsValid(std::string* error) const;
};

// Pair number `index` of the scene: it depends on the seed and the index alone. With truth, exact
// gravity, axis and (planar motion) normal, and with the columns `inlier` and `exact`. False with a
// message if the options are invalid, or if hardly any point is seen in both views (motion out of
// view).
bool MakeScenePair(const SceneOptions& options, int index, FramePair* pair, std::string* error);

// The same with a given motion and gravity instead of the pattern's.
bool MakeScenePair(const SceneOptions& options, int index, const Pose& truth, FramePair* pair,
                   std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_SYNTHETIC_H_
