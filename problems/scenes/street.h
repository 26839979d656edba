// Synthetic frame pairs of a car on a street, with the rig of a file.
//
// The ground is a plane below the body's origin. To either side is a facade, parallel to the car at
// time 1, at 7-13 m from the middle of the cameras and 12 m high. Image points are uniform in the
// images of view 1, over all cameras alike. A point is on the nearest of: the ground, a facade, and
// a far point at a distance that is log-uniform in 30-200 m. A quarter of the points are clutter:
// log-uniform from 2 m on, nearer than these. A match is kept if its point is in front of the
// camera and in its image, at each of the two times. So the matches are spread over the cameras in
// proportion to what they see, and matches between cameras are of those that share a view. Nothing
// hides what is behind it.
//
// Cars, where they are asked for: three of moving_car.h, two ahead and one behind, on the ground. A
// match of a car is of cameras that see it.
#ifndef RIGEL_PROBLEMS_SCENES_STREET_H_
#define RIGEL_PROBLEMS_SCENES_STREET_H_

#include <string>
#include <string_view>

#include "rigel/core/body_axes.h"
#include "rigel/core/frame_pair.h"
#include "rigel/core/pose.h"
#include "rigel/core/rig.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

// Metres: the ground below a rear axle, for rigs that do not say more.
inline constexpr double kUsualGround = 0.35;

// kCar: forward on the arc of a rear axle, with bumps. kTurn: the yaw alone, about the body's
// origin, so that t is exactly 0. kStill: no yaw either.
enum class StreetMotion { kCar, kTurn, kStill };

// "car", "turn", "still". False if there is no such name.
bool ParseStreetMotion(std::string_view name, StreetMotion* motion);

struct StreetOptions : SceneMatchOptions {
  Rig rig;
  BodyAxes axes;
  double ground_m = kUsualGround;  // how far the ground is below the body's origin
  StreetMotion motion = StreetMotion::kCar;
  double rotation_deg = 1.0;  // yaw, its sign random; a car's pitch and roll are N(0, 0.2 degrees)
  double distance_m = 1.0;    // |t| of a car, forward along the arc of a rear axle (Ackermann)

  // Those of this struct but the rig.
  bool AreNumbersValid(std::string* error) const;

  // Whether the cameras that see the street are above the ground and between the facades.
  bool ArePlacesValid(const Rig& seen, std::string* error) const;

  // False also if that is not so of `rig`.
  bool IsValid(std::string* error) const;
};

// Pair number `index` of the street: it depends on the seed and the index alone. With truth, exact
// gravity and axis, the direction of the front, and the columns `inlier` and `exact`. False with a
// message if the options are invalid, or if too few points are seen.
bool MakeStreetPair(const StreetOptions& options, int index, FramePair* pair, std::string* error);

// The same with a given motion of the body.
bool MakeStreetPair(const StreetOptions& options, int index, const Pose& truth, FramePair* pair,
                    std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_STREET_H_
