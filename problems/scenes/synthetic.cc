#include "rigel/problems/scenes/synthetic.h"

#include <cmath>

#include "rigel/core/angles.h"
#include "rigel/core/body_axes.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/moving_car.h"
#include "rigel/problems/scenes/scene_matches.h"
#include "rigel/problems/scenes/scene_rig.h"

namespace rigel {
namespace {

constexpr EnumName<MotionPattern> kMotionNames[] = {
    {MotionPattern::kForward, "forward"},   {MotionPattern::kRandom, "random"},
    {MotionPattern::kSideways, "sideways"}, {MotionPattern::kPlanar, "planar"},
    {MotionPattern::kTurn, "turn"},         {MotionPattern::kStill, "still"}};

constexpr EnumName<RotationAxisPattern> kRotationAxisNames[] = {
    {RotationAxisPattern::kY, "y"}, {RotationAxisPattern::kRandom, "random"}};

// Radians and metres, 1 sigma: by these a camera is turned and moved. Both are stated in
// synthetic.h.
constexpr double kMountingAngle = 0.1;
constexpr double kMountingShift = 0.05;
// Metres, the range of the depths in view 1: both also of synthetic.h.
constexpr double kNearestPoint = 5.0;
constexpr double kFarthestPoint = 30.0;
// Radians: a smaller rotation has no axis.
constexpr double kNoRotation = 1e-6;
// Metres. Cameras are a metre and a half above the ground, the centre of the car half as much.
constexpr double kCarBelowRig = 0.75;

// Body z is ahead and y down.
Rig MakeRing(int num_cameras) {
  Rig rig;
  for (int k = 0; k < num_cameras; ++k) {
    const double angle = 2.0 * kPi * k / num_cameras;
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
    camera.Q = ExpSO3(angle * Eigen::Vector3d::UnitY());
    camera.s = camera.Q.col(2);
    rig.cameras.push_back(camera);
  }
  return rig;
}

Rig MakeRig(int num_cameras, Random* random) {
  const Eigen::Vector3d positions[4] = {
      {-0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.4, 0.3}, {0.0, -0.4, 0.3}};
  Rig rig;
  for (int k = 0; k < num_cameras; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
    camera.Q = ExpSO3(kMountingAngle * random->NormalVector3());
    camera.s = positions[k] + kMountingShift * random->NormalVector3();
    rig.cameras.push_back(camera);
  }
  return rig;
}

// The points of synthetic.h, seen from a rig that moves by `truth`.
class BoxGeometry : public SceneGeometry {
 public:
  BoxGeometry(const SceneOptions& options, const Rig& rig, const Pose& truth)
      : options_(options), rig_(rig), truth_(truth) {}

  bool DrawMatch(int number, bool inter, Random* random, Match* match,
                 std::string* error) override {
    if (DrawCamerasAndPoint(number, inter, random, match)) return true;
    *error = "the motion leaves hardly any point of camera " + std::to_string(match->camera1) +
             " in the view of camera " + std::to_string(match->camera2);
    if (inter && options_.ring && options_.num_cameras < kMinRingOfNeighbours) {
      *error += "; neighbours on a ring of fewer than " + std::to_string(kMinRingOfNeighbours) +
                " see nothing in common without a turn";
    }
    return false;
  }

  void DrawCars(Random* random) override { car_ = DrawCar(BodyAxes(), kCarBelowRig, random); }

  bool DrawCarMatch(Random* random, Match* match) override {
    const RigCamera& camera1 = rig_.cameras[match->camera1];
    const RigCamera& camera2 = rig_.cameras[match->camera2];
    const Pose first = PartOfMotion(car_.motion, ShareOfTime(options_, camera1));
    const Pose motion =
        truth_ * car_.motion * PartOfMotion(car_.motion, ShareOfTime(options_, camera2));
    for (int draw = 0; draw < kMaxDraws; ++draw) {
      const Eigen::Vector3d X = DrawCarPoint(car_, random);
      if (Sees(camera1, first * X, &match->pixel1) && Sees(camera2, motion * X, &match->pixel2)) {
        return true;
      }
    }
    return false;
  }

 private:
  bool DrawCamerasAndPoint(int number, bool inter, Random* random, Match* match) const {
    const int n = options_.num_cameras;
    match->camera1 = number % n;
    match->camera2 = match->camera1;
    if (!inter) return DrawPoint(random, match);
    if (!options_.ring) {
      match->camera2 = (match->camera1 + 1 + random->Index(n - 1)) % n;
      return DrawPoint(random, match);
    }
    // In a turn one of the two neighbours may see nothing in common with this camera.
    const bool right = random->Index(2) == 1;
    for (const bool side : {right, !right}) {
      match->camera2 = (match->camera1 + (side ? 1 : n - 1)) % n;
      if (DrawPoint(random, match)) return true;
    }
    return false;
  }

  // A point that both cameras of the match see.
  bool DrawPoint(Random* random, Match* match) const {
    const RigCamera& camera1 = rig_.cameras[match->camera1];
    for (int draw = 0; draw < kMaxDraws; ++draw) {
      const double u = random->Uniform(0.0, camera1.intrinsics.width);
      const double v = random->Uniform(0.0, camera1.intrinsics.height);
      const double depth = random->Uniform(kNearestPoint, kFarthestPoint);
      match->pixel1 = {u, v};
      const Eigen::Vector3d X =
          camera1.Q * (depth * AlongRay(camera1.intrinsics, match->pixel1)) + camera1.s;
      if (Sees(rig_.cameras[match->camera2], truth_ * X, &match->pixel2)) return true;
    }
    return false;
  }

  const SceneOptions& options_;
  const Rig& rig_;
  const Pose& truth_;
  Car car_;
};

}  // namespace

bool ParseMotionPattern(std::string_view name, MotionPattern* pattern) {
  return FindValue(kMotionNames, name, pattern);
}

bool ParseRotationAxisPattern(std::string_view name, RotationAxisPattern* pattern) {
  return FindValue(kRotationAxisNames, name, pattern);
}

bool SceneOptions::IsValid(std::string* error) const {
  const int max_cameras = ring ? kMaxRing : 4;
  if (num_cameras < 1 || num_cameras > max_cameras) {
    *error = "num_cameras must be 1 to " + std::to_string(max_cameras) +
             (ring ? " on a ring" : " without a ring");
  } else if (!std::isfinite(rotation_deg)) {
    *error = "rotation_deg must be finite";
  } else if (motion == MotionPattern::kPlanar && rotation_axis != RotationAxisPattern::kY) {
    *error = "rotation_axis=random contradicts planar motion, which turns about y";
  } else {
    return AreMatchesValid(num_cameras, error);
  }
  return false;
}

bool MakeScenePair(const SceneOptions& options, int index, FramePair* pair, std::string* error) {
  // The motion has a stream of its own, so that it does not change with the number of matches.
  Random random = Random::Stream(options.seed, 2 * static_cast<uint64_t>(index) + 1);
  const Eigen::Vector3d axis = options.rotation_axis == RotationAxisPattern::kY
                                   ? Eigen::Vector3d::UnitY()
                                   : random.UnitVector3();
  Pose truth;
  if (options.motion != MotionPattern::kStill) {
    truth.R = ExpSO3(DegToRad(options.rotation_deg) * axis);
  }
  switch (options.motion) {
    case MotionPattern::kForward:
      truth.t = Eigen::Vector3d::UnitZ();
      break;
    case MotionPattern::kSideways:
      truth.t = Eigen::Vector3d::UnitX();
      break;
    case MotionPattern::kRandom:
      truth.t = random.UnitVector3();
      break;
    case MotionPattern::kPlanar: {
      const double angle = random.Uniform(0.0, 2.0 * kPi);
      truth.t = {std::sin(angle), 0.0, std::cos(angle)};
      break;
    }
    case MotionPattern::kTurn:
    case MotionPattern::kStill:
      break;
  }
  if (!MakeScenePair(options, index, truth, pair, error)) return false;
  pair->prior.axis = axis;
  if (options.motion == MotionPattern::kPlanar) pair->prior.normal = Eigen::Vector3d::UnitY();
  return true;
}

bool MakeScenePair(const SceneOptions& options, int index, const Pose& truth, FramePair* pair,
                   std::string* error) {
  if (!options.IsValid(error)) return false;
  Random random = Random::Stream(options.seed, 2 * static_cast<uint64_t>(index));
  FramePair result;
  result.name = "pair " + std::to_string(index);
  result.truth = truth;
  result.rig = options.ring ? MakeRing(options.num_cameras) : MakeRig(options.num_cameras, &random);
  result.prior.gravity1 = Eigen::Vector3d::UnitY();
  result.prior.gravity2 = truth.R * *result.prior.gravity1;
  const double angle = LogSO3(truth.R).norm();
  result.prior.axis =
      angle > kNoRotation ? Eigen::Vector3d(LogSO3(truth.R) / angle) : Eigen::Vector3d::UnitY();

  const Rig rig = RigOfScene(options, index, &result);
  BoxGeometry geometry(options, rig, truth);
  if (!DrawSceneMatches(options, &geometry, &random, &result, error)) return false;
  *pair = result;
  return true;
}

}  // namespace rigel
