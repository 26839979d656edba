#include "rigel/problems/scenes/synthetic.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/angles.h"
#include "rigel/core/enum_names.h"
#include "rigel/core/random.h"
#include "rigel/problems/scenes/moving_car.h"

namespace rigel {
namespace {

constexpr EnumName<MotionPattern> kMotionNames[] = {{MotionPattern::kForward, "forward"},
                                                    {MotionPattern::kRandom, "random"},
                                                    {MotionPattern::kSideways, "sideways"},
                                                    {MotionPattern::kPlanar, "planar"}};

constexpr EnumName<RotationAxisPattern> kRotationAxisNames[] = {
    {RotationAxisPattern::kY, "y"}, {RotationAxisPattern::kRandom, "random"}};

// Lowe's ratio test: no match has a larger score.
constexpr double kRatioTest = 0.8;
// Radians and metres, 1 sigma: by these a camera is turned and moved. Both are stated in
// synthetic.h.
constexpr double kMountingAngle = 0.1;
constexpr double kMountingShift = 0.05;
// Metres, the range of the depths in view 1: both also of synthetic.h.
constexpr double kNearestPoint = 5.0;
constexpr double kFarthestPoint = 30.0;
// An outlier's score is distributed as the largest of so many uniform numbers, as SIFT's on KITTI.
constexpr double kOutlierDraws = 11.0;
// Radians: a smaller rotation has no axis.
constexpr double kNoRotation = 1e-6;

// Body z is ahead and y down.
Rig MakeRing(int num_cameras) {
  Rig rig;
  for (int k = 0; k < num_cameras; ++k) {
    const double angle = 2.0 * kPi * k / num_cameras;
    RigCamera camera;
    camera.intrinsics = {400.0, 400.0, 320.0, 240.0, 640, 480};
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
    camera.intrinsics = {400.0, 400.0, 320.0, 240.0, 640, 480};
    camera.Q = ExpSO3(kMountingAngle * random->NormalVector3());
    camera.s = positions[k] + kMountingShift * random->NormalVector3();
    rig.cameras.push_back(camera);
  }
  return rig;
}

Eigen::Vector2d Noise(double sigma, Random* random) {
  const double x = random->Normal();
  const double y = random->Normal();
  return {sigma * x, sigma * y};
}

// A point that both cameras of the match see.
bool DrawSeenMatch(const Rig& rig, const Pose& truth, Random* random, Match* match) {
  const RigCamera& camera1 = rig.cameras[match->camera1];
  const RigCamera& camera2 = rig.cameras[match->camera2];
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const double u = random->Uniform(0.0, camera1.intrinsics.width);
    const double v = random->Uniform(0.0, camera1.intrinsics.height);
    const double depth = random->Uniform(kNearestPoint, kFarthestPoint);
    match->pixel1 = {u, v};
    const Eigen::Vector3d X1 =
        camera1.Q * (depth * camera1.intrinsics.Normalize(match->pixel1)) + camera1.s;
    const Eigen::Vector3d X2 = camera2.Q.transpose() * (truth * X1 - camera2.s);
    if (!(X2.z() > kMinDepth)) continue;
    match->pixel2 = camera2.intrinsics.Project(X2);
    if (camera2.intrinsics.InImage(match->pixel2)) return true;
  }
  return false;
}

bool DrawMatch(const SceneOptions& options, const Rig& rig, const Pose& truth, bool inter,
               int number, Random* random, Match* match) {
  const int n = options.num_cameras;
  match->camera1 = number % n;
  match->camera2 = match->camera1;
  if (!inter) return DrawSeenMatch(rig, truth, random, match);
  if (!options.ring) {
    match->camera2 = (match->camera1 + 1 + random->Index(n - 1)) % n;
    return DrawSeenMatch(rig, truth, random, match);
  }
  // In a turn one of the two neighbours may see nothing in common with this camera.
  const bool right = random->Index(2) == 1;
  for (const bool side : {right, !right}) {
    match->camera2 = (match->camera1 + (side ? 1 : n - 1)) % n;
    if (DrawSeenMatch(rig, truth, random, match)) return true;
  }
  return false;
}

// Moves the given matches to a car. False if none was found that all their cameras see.
bool MoveToCar(const SceneOptions& options, const FramePair& pair, const int* chosen, int size,
               Random* random, std::vector<Match>* matches) {
  // Cars drawn before giving up: one that all these cameras see may be rare or impossible.
  constexpr int kMaxCars = 100;
  for (int attempt = 0; attempt < kMaxCars; ++attempt) {
    const Car car = DrawCar(*pair.prior.gravity1, random);
    bool seen = true;
    for (int k = 0; k < size && seen; ++k) {
      Match& match = (*matches)[chosen[k]];
      seen = DrawCarMatch(car, pair.rig, *pair.truth, random, &match);
      match.pixel1 += Noise(options.noise_px, random);
      match.pixel2 += Noise(options.noise_px, random);
    }
    if (seen) return true;
  }
  return false;
}

}  // namespace

bool ParseMotionPattern(std::string_view name, MotionPattern* pattern) {
  return FindValue(kMotionNames, name, pattern);
}

bool ParseRotationAxisPattern(std::string_view name, RotationAxisPattern* pattern) {
  return FindValue(kRotationAxisNames, name, pattern);
}

bool SceneOptions::IsValid(std::string* error) const {
  const auto in_unit = [](double x) { return x >= 0.0 && x <= 1.0; };
  const int max_cameras = ring ? kMaxRing : 4;
  if (num_cameras < 1 || num_cameras > max_cameras) {
    *error = "num_cameras must be 1 to " + std::to_string(max_cameras) +
             (ring ? " on a ring" : " without a ring");
  } else if (num_matches < 0) {
    *error = "num_matches must not be negative";
  } else if (!(noise_px >= 0.0) || !std::isfinite(noise_px)) {
    *error = "noise_px must be finite and not negative";
  } else if (!std::isfinite(rotation_deg)) {
    *error = "rotation_deg must be finite";
  } else if (!in_unit(inter_share) || !in_unit(outlier_share)) {
    *error = "inter_share and outlier_share must lie in [0, 1]";
  } else if (!(moving_share >= 0.0) || !(moving_share + outlier_share <= 1.0)) {
    *error = "moving_share must not be negative, nor above 1 together with outlier_share";
  } else if (inter_share > 0.0 && num_cameras < 2) {
    *error = "inter_share needs two cameras";
  } else if (motion == MotionPattern::kPlanar && rotation_axis != RotationAxisPattern::kY) {
    *error = "rotation_axis=random contradicts planar motion, which turns about y";
  } else {
    return true;
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
  truth.R = ExpSO3(DegToRad(options.rotation_deg) * axis);
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
  if (options.noise_px > 0.0) result.noise_px = options.noise_px;
  result.rig = options.ring ? MakeRing(options.num_cameras) : MakeRig(options.num_cameras, &random);
  result.prior.gravity1 = Eigen::Vector3d::UnitY();
  result.prior.gravity2 = truth.R * *result.prior.gravity1;
  const double angle = LogSO3(truth.R).norm();
  result.prior.axis =
      angle > kNoRotation ? Eigen::Vector3d(LogSO3(truth.R) / angle) : Eigen::Vector3d::UnitY();

  const int num_inter = static_cast<int>(std::lround(options.inter_share * options.num_matches));
  const int num_outliers =
      static_cast<int>(std::lround(options.outlier_share * options.num_matches));
  result.matches.reserve(options.num_matches);
  for (int k = 0; k < options.num_matches; ++k) {
    Match match;
    const bool inter = k >= options.num_matches - num_inter;
    if (!DrawMatch(options, result.rig, truth, inter, k, &random, &match)) {
      *error = "the motion leaves hardly any point of camera " + std::to_string(match.camera1) +
               " in the view of camera " + std::to_string(match.camera2);
      if (inter && options.ring && options.num_cameras < kMinRingOfNeighbours) {
        *error += "; neighbours on a ring of fewer than " + std::to_string(kMinRingOfNeighbours) +
                  " see nothing in common without a turn";
      }
      return false;
    }
    match.pixel1 += Noise(options.noise_px, &random);
    match.pixel2 += Noise(options.noise_px, &random);
    result.matches.push_back(match);
  }
  // Outliers among all matches alike: the first num_outliers of a random order.
  std::vector<int> order(options.num_matches);
  for (int k = 0; k < options.num_matches; ++k) order[k] = k;
  for (int k = 0; k < num_outliers; ++k) {
    std::swap(order[k], order[k + random.Index(options.num_matches - k)]);
    Match& match = result.matches[order[k]];
    const PinholeCamera& camera = result.rig.cameras[match.camera2].intrinsics;
    const double u = random.Uniform(0.0, camera.width);
    const double v = random.Uniform(0.0, camera.height);
    match.pixel2 = {u, v};
  }
  // Drawn last, so that the rest of a pair is the same with and without them.
  const int num_moving =
      std::min(static_cast<int>(std::lround(options.moving_share * options.num_matches)),
               options.num_matches - num_outliers);
  for (int k = num_outliers; k < num_outliers + num_moving; ++k) {
    std::swap(order[k], order[k + random.Index(options.num_matches - k)]);
  }
  if (num_moving > 0 && !MoveToCar(options, result, order.data() + num_outliers, num_moving,
                                   &random, &result.matches)) {
    *error = "hardly any point of a car in front of the rig is in view of its cameras";
    return false;
  }
  for (int k = 0; options.match_scores && k < options.num_matches; ++k) {
    const double a = random.Uniform();
    const double b = random.Uniform();
    result.matches[order[k]].score =
        kRatioTest * (k < num_outliers ? std::pow(a, 1.0 / kOutlierDraws) : 0.5 * (a + b));
  }
  *pair = result;
  return true;
}

}  // namespace rigel
