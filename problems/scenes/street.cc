#include "rigel/problems/scenes/street.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rigel/core/angles.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/rays.h"
#include "rigel/core/rig_centre.h"
#include "rigel/problems/scenes/moving_car.h"
#include "rigel/problems/scenes/scene_matches.h"
#include "rigel/problems/scenes/scene_rig.h"

namespace rigel {
namespace {

constexpr EnumName<StreetMotion> kMotionNames[] = {
    {StreetMotion::kCar, "car"}, {StreetMotion::kTurn, "turn"}, {StreetMotion::kStill, "still"}};

// Metres, as street.h states: how far a facade is from the middle of the cameras.
constexpr double kNearestFacade = 7.0, kFarthestFacade = 13.0;
// Metres, as street.h states.
constexpr double kFacadeHeight = 12.0;
// Metres, as street.h states: the distances of far points.
constexpr double kNearestFar = 30.0, kFarthestFar = 200.0;
// Metres, as street.h states.
constexpr double kNearestClutter = 2.0;
// Share of the points that are clutter.
constexpr double kClutterShare = 0.25;
// Degrees, 1 sigma of pitch and roll between the frames.
constexpr double kBumpDeg = 0.2;
// Draws of a point before giving up: on rigs whose cameras share a strip of a few percent of their
// views most draws are in vain.
constexpr int kMaxStreetDraws = 100000;
// Radians: a smaller rotation has no axis.
constexpr double kNoRotation = 1e-6;
// Cars, as street.h states: two ahead and one behind.
constexpr int kNumCars = 3;

double LogUniform(double low, double high, Random* random) {
  return low * std::exp(random->Uniform(0.0, std::log(high / low)));
}

class StreetGeometry : public SceneGeometry {
 public:
  StreetGeometry(const StreetOptions& options, const Rig& rig, const Pose& truth, Random* random)
      : options_(options),
        rig_(rig),
        truth_(truth),
        right_(options.axes.Right()),
        middle_(right_.dot(RigCentre(options.rig))) {
    double pixels = 0;
    for (const RigCamera& camera : rig_.cameras) {
      pixels += static_cast<double>(camera.intrinsics.width) * camera.intrinsics.height;
      pixels_.push_back(pixels);
    }
    for (double& side : facades_) side = random->Uniform(kNearestFacade, kFarthestFacade);
  }

  bool DrawMatch(int /*number*/, bool inter, Random* random, Match* match,
                 std::string* error) override {
    for (int draw = 0; draw < kMaxStreetDraws; ++draw) {
      match->camera1 = DrawCamera(random);
      const Eigen::Vector3d X = DrawPoint(random, match);
      const auto same = [&](int /*camera*/) -> Eigen::Vector3d { return truth_ * X; };
      if (DrawSecond(inter, same, random, match)) return true;
    }
    *error = inter ? "no two cameras of the rig share enough of their views for matches between "
                     "cameras (inter_share)"
                   : "the motion leaves hardly any point in the view of the camera that saw it";
    return false;
  }

  void DrawCars(Random* random) override {
    BodyAxes axes = options_.axes;
    for (int k = 0; k < kNumCars; ++k) {
      // The last one is behind.
      if (k == kNumCars - 1) axes.forward = -axes.forward;
      cars_[k] = DrawCar(axes, options_.ground_m - kHalfCarHeight, random);
    }
  }

  bool DrawCarMatch(Random* random, Match* match) override {
    const bool inter = !match->IsIntra();
    for (int draw = 0; draw < kMaxDraws; ++draw) {
      const Car& car = cars_[random->Index(kNumCars)];
      const Eigen::Vector3d X = DrawCarPoint(car, random);
      // Where the point is when a camera fires.
      const auto at_first = [&](int camera) {
        return PartOfMotion(car.motion, ShareOfTime(options_, rig_.cameras[camera])) * X;
      };
      const auto at_second = [&](int camera) { return truth_ * (car.motion * at_first(camera)); };
      if (ChooseCamera(-1, at_first, random, &match->camera1, &match->pixel1) &&
          DrawSecond(inter, at_second, random, match)) {
        return true;
      }
    }
    return false;
  }

 private:
  // In proportion to its pixels.
  int DrawCamera(Random* random) const {
    const double pixel = random->Uniform(0.0, pixels_.back());
    const auto camera = std::upper_bound(pixels_.begin(), pixels_.end() - 1, pixel);
    return static_cast<int>(camera - pixels_.begin());
  }

  // A point that the match's camera1 sees, in the body frame of time 1.
  Eigen::Vector3d DrawPoint(Random* random, Match* match) const {
    const RigCamera& camera = rig_.cameras[match->camera1];
    match->pixel1 = DrawPixel(camera.intrinsics, random);
    const Eigen::Vector3d ray = MakeRay(camera, match->pixel1).x;
    const double far = LogUniform(kNearestFar, kFarthestFar, random);
    double distance = std::min(far, DistanceOfSurface(camera.s, ray));
    if (random->Uniform() < kClutterShare && distance > kNearestClutter) {
      distance = LogUniform(kNearestClutter, distance, random);
    }
    return camera.s + distance * ray;
  }

  // Of the nearest of ground and facades along a ray; infinite if it meets none.
  double DistanceOfSurface(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    const double height = options_.ground_m - options_.axes.down.dot(from);
    const double sinks = options_.axes.down.dot(ray);
    const double sideways = right_.dot(ray);
    double distance = std::numeric_limits<double>::infinity();
    if (sinks > 0) distance = height / sinks;
    if (sideways == 0) return distance;
    const double side = sideways > 0 ? facades_[1] : -facades_[0];
    const double facade = (middle_ + side - right_.dot(from)) / sideways;
    return height - facade * sinks <= kFacadeHeight ? std::min(distance, facade) : distance;
  }

  // The second camera of a match, the same or another one, that sees the point. `point_of` is where
  // that is for each camera, in the body frame of time 2.
  template <typename PointOf>
  bool DrawSecond(bool inter, const PointOf& point_of, Random* random, Match* match) const {
    if (inter) {
      return ChooseCamera(match->camera1, point_of, random, &match->camera2, &match->pixel2);
    }
    match->camera2 = match->camera1;
    return Sees(rig_.cameras[match->camera2], point_of(match->camera2), &match->pixel2);
  }

  // One of the cameras but `without` that see the point, all of them alike.
  template <typename PointOf>
  bool ChooseCamera(int without, const PointOf& point_of, Random* random, int* camera,
                    Pixel* pixel) const {
    int num_seen = 0;
    for (int k = 0; k < rig_.size(); ++k) {
      Pixel seen;
      if (k == without || !Sees(rig_.cameras[k], point_of(k), &seen)) continue;
      ++num_seen;
      if (random->Index(num_seen) > 0) continue;
      *camera = k;
      *pixel = seen;
    }
    return num_seen > 0;
  }

  const StreetOptions& options_;
  const Rig& rig_;
  const Pose& truth_;
  const Eigen::Vector3d right_;
  const double middle_;            // of the cameras, to the right of the body's origin
  std::vector<double> pixels_;     // of the cameras up to each
  std::array<double, 2> facades_;  // to the left, to the right
  std::array<Car, kNumCars> cars_;
};

Pose DrawMotion(const StreetOptions& options, Random* random) {
  if (options.motion == StreetMotion::kStill) return Pose();
  const BodyAxes& axes = options.axes;
  const double sign = random->Index(2) == 1 ? 1.0 : -1.0;
  const double yaw = sign * DegToRad(options.rotation_deg);
  if (options.motion == StreetMotion::kTurn) {
    Pose turn;
    turn.R = ExpSO3(yaw * axes.down);
    return turn;
  }
  // Forward on the arc of a rear axle, over a bumpy road.
  const double pitch = DegToRad(kBumpDeg) * random->Normal();
  const double roll = DegToRad(kBumpDeg) * random->Normal();
  Pose f2_from_f1;
  f2_from_f1.R = ExpSO3(pitch * axes.Right() + roll * axes.forward) * ExpSO3(yaw * axes.down);
  // The body turns by -yaw about its down; the chord of the arc is at half of that.
  const Eigen::Vector3d place2 =
      options.distance_m * (ExpSO3(-0.5 * yaw * axes.down) * axes.forward);
  f2_from_f1.t = -(f2_from_f1.R * place2);
  return f2_from_f1;
}

}  // namespace

bool StreetOptions::AreNumbersValid(std::string* error) const {
  if (!std::isfinite(ground_m)) {
    *error = "ground_m must be finite";
  } else if (!std::isfinite(rotation_deg)) {
    *error = "rotation_deg must be finite";
  } else if (!(distance_m >= 0) || !std::isfinite(distance_m)) {
    *error = "distance_m must be finite and not negative";
  } else {
    return true;
  }
  return false;
}

bool ParseStreetMotion(std::string_view name, StreetMotion* motion) {
  return FindValue(kMotionNames, name, motion);
}

bool StreetOptions::ArePlacesValid(const Rig& seen, std::string* error) const {
  const Eigen::Vector3d right = axes.Right();
  const double middle = right.dot(RigCentre(rig));
  for (int k = 0; k < seen.size(); ++k) {
    const Eigen::Vector3d& place = seen.cameras[k].s;
    const std::string name = "camera " + std::to_string(k);
    if (!(axes.down.dot(place) < ground_m)) {
      *error = "ground_m must put the ground below all cameras, but " + name + " is not above it";
    } else if (!(std::abs(right.dot(place) - middle) < kNearestFacade)) {
      *error = "rig: " + name + " is farther from the middle of the cameras than a facade may be";
    } else {
      continue;
    }
    return false;
  }
  return true;
}

bool StreetOptions::IsValid(std::string* error) const {
  if (!AreNumbersValid(error)) return false;
  std::string what = "no camera, expected at least one";
  if (rig.size() == 0 || !rig.IsValid(&what)) {
    *error = "rig: " + what;
    return false;
  }
  for (int k = 0; k < rig.size(); ++k) {
    const Camera& camera = rig.cameras[k].intrinsics;
    if (camera.width < 1 || camera.height < 1) {
      *error = "rig: camera " + std::to_string(k) + " has no image size";
      return false;
    }
  }
  return ArePlacesValid(rig, error) && AreMatchesValid(rig.size(), error);
}

bool MakeStreetPair(const StreetOptions& options, int index, FramePair* pair, std::string* error) {
  if (!options.IsValid(error)) return false;
  // The motion has a stream of its own, so that it does not change with the number of matches.
  Random random = Random::Stream(options.seed, 2 * static_cast<uint64_t>(index) + 1);
  return MakeStreetPair(options, index, DrawMotion(options, &random), pair, error);
}

bool MakeStreetPair(const StreetOptions& options, int index, const Pose& truth, FramePair* pair,
                    std::string* error) {
  if (!options.IsValid(error)) return false;
  Random random = Random::Stream(options.seed, 2 * static_cast<uint64_t>(index));
  FramePair result;
  result.name = "pair " + std::to_string(index);
  result.rig = options.rig;
  result.truth = truth;
  result.prior.gravity1 = options.axes.down;
  result.prior.gravity2 = truth.R * options.axes.down;
  result.prior.forward = options.axes.forward;
  const Eigen::Vector3d turn = LogSO3(truth.R);
  result.prior.axis = turn.norm() > kNoRotation ? turn.normalized() : options.axes.down;
  const Rig rig = RigOfScene(options, index, &result);
  if (!options.ArePlacesValid(rig, error)) {
    *error = "with the errors of the calibration and the times of the cameras " + *error;
    return false;
  }
  StreetGeometry geometry(options, rig, truth, &random);
  if (!DrawSceneMatches(options, &geometry, &random, &result, error)) return false;
  *pair = std::move(result);
  return true;
}

}  // namespace rigel
