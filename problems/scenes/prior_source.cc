#include "rigel/problems/scenes/prior_source.h"

#include "rigel/core/enum_names.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

constexpr EnumName<PriorSource> kSourceNames[] = {
    {PriorSource::kFile, "file"}, {PriorSource::kBody, "body"}, {PriorSource::kTruth, "truth"}};

constexpr EnumName<PriorNoiseAxis> kNoiseAxisNames[] = {{PriorNoiseAxis::kPitch, "pitch"},
                                                        {PriorNoiseAxis::kRoll, "roll"},
                                                        {PriorNoiseAxis::kRandom, "random"}};

// Radians: a smaller rotation has no axis. prior_source.h states it.
constexpr double kNoRotation = 1e-6;
// Sine of the angle between the axis and t below which both are one line but for rounding.
constexpr double kParallel = 1e-9;

// The body's down, and whether the prior depends on it.
class Down {
 public:
  explicit Down(const Eigen::Vector3d& down) : down_(down) {}
  const Eigen::Vector3d& Use() {
    used_ = true;
    return down_;
  }
  bool used() const { return used_; }

 private:
  Eigen::Vector3d down_;
  bool used_ = false;
};

// The unit vector perpendicular to t that is nearest to the axis.
Eigen::Vector3d NormalNearestTo(const Eigen::Vector3d& axis, const Eigen::Vector3d& t) {
  const Eigen::Vector3d direction = t.normalized();
  const Eigen::Vector3d across = axis - direction * direction.dot(axis);
  // An axis along t does not determine the plane; all normals are as near.
  if (!(across.norm() > kParallel)) return TangentBasis(direction).col(0);
  return across.normalized();
}

void TakePriorOfTruth(const Pose& truth, bool with_distance, Down* down, MotionPrior* prior) {
  if (!prior->gravity1.has_value()) prior->gravity1 = down->Use();
  prior->gravity2 = truth.R * *prior->gravity1;
  const Eigen::Vector3d omega = LogSO3(truth.R);
  const Eigen::Vector3d axis =
      omega.norm() > kNoRotation ? Eigen::Vector3d(omega.normalized()) : down->Use();
  prior->axis = axis;
  prior->normal = axis;
  if (!(truth.t.norm() > 0)) return;
  if (with_distance) prior->distance = truth.t.norm();
  prior->normal = NormalNearestTo(axis, truth.t);
}

// Turns gravity2, axis and normal by options.noise; the sign is random.
void Disturb(const PriorSourceOptions& options, int index, const BodyAxes& axes, Down* down,
             MotionPrior* prior) {
  Random random = Random::Stream(options.seed ^ 0x7072696f72ULL, static_cast<uint64_t>(index));
  const double sign = random.Uniform() < 0.5 ? -1.0 : 1.0;
  Eigen::Vector3d about = random.UnitVector3();
  if (options.noise_axis == PriorNoiseAxis::kPitch) {
    about = axes.Right();
    down->Use();
  }
  if (options.noise_axis == PriorNoiseAxis::kRoll) about = axes.forward;
  const Eigen::Matrix3d disturb = ExpSO3(sign * options.noise * about);
  if (prior->gravity2.has_value()) prior->gravity2 = disturb * *prior->gravity2;
  if (prior->axis.has_value()) prior->axis = disturb * *prior->axis;
  if (prior->normal.has_value()) prior->normal = disturb * *prior->normal;
}

}  // namespace

bool ParsePriorSource(std::string_view name, PriorSource* source) {
  return FindValue(kSourceNames, name, source);
}

bool ParsePriorNoiseAxis(std::string_view name, PriorNoiseAxis* axis) {
  return FindValue(kNoiseAxisNames, name, axis);
}

bool ApplyPriorSource(const PriorSourceOptions& options, int index, FramePair* pair,
                      std::string* error, AppliedAxes* applied) {
  MotionPrior& prior = pair->prior;
  BodyAxes axes;
  const std::optional<Eigen::Vector3d> stated_forward =
      options.forward ? options.forward : prior.forward;
  if (!ResolveBodyAxes(pair->rig, options.down, stated_forward, &axes, error)) {
    *error = pair->name + ": " + *error + "; state --down, --forward or both";
    return false;
  }
  prior.forward = axes.forward;
  Down down(axes.down);
  switch (options.source) {
    case PriorSource::kFile:
      break;
    case PriorSource::kBody:
      prior.gravity1 = prior.gravity2 = prior.axis = prior.normal = down.Use();
      break;
    case PriorSource::kTruth:
      if (!pair->truth.has_value()) {
        *error = pair->name + ": no truth to take the prior from (--prior=truth)";
        return false;
      }
      TakePriorOfTruth(*pair->truth, options.true_distance, &down, &prior);
      break;
  }
  if (options.noise != 0.0) Disturb(options, index, axes, &down, &prior);
  if (options.sigma.has_value()) {
    prior.gravity_sigma = prior.axis_sigma = prior.normal_sigma = options.sigma;
  }
  if (applied != nullptr) {
    applied->axes = axes;
    applied->down_suggested = down.used() && !options.down;
    applied->cameras_off_down = CamerasOffDown(pair->rig, axes.down);
    applied->forward_suggested = !stated_forward;
  }
  return true;
}

}  // namespace rigel
