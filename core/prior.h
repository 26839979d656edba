// What is known of the motion before any image is looked at.
#ifndef RIGEL_CORE_PRIOR_H_
#define RIGEL_CORE_PRIOR_H_

#include <optional>
#include <string>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"

namespace rigel {

// Each part is optional. Directions are unit vectors. A sigma is the standard deviation per axis,
// radians. A prior without a sigma makes hypotheses; RefineSettings::use_prior cannot weight it and
// leaves it out. The forms kPrior and kPriorDepths take the prior as exact, and hold_distance
// the distance, with or without a sigma.
struct MotionPrior {
  // "Down" in the body frame at time 1 and 2 (from an IMU): g2 = R g1.
  std::optional<Eigen::Vector3d> gravity1;
  std::optional<Eigen::Vector3d> gravity2;
  std::optional<double> gravity_sigma;

  // Rotation axis in the body frame: R axis = axis.
  std::optional<Eigen::Vector3d> axis;
  std::optional<double> axis_sigma;

  // Normal of the motion plane in the body frame: R normal = normal, t . normal = 0.
  std::optional<Eigen::Vector3d> normal;
  std::optional<double> normal_sigma;

  // Where the vehicle's front is in the body frame: for Ackermann motion.
  std::optional<Eigen::Vector3d> forward;

  // |t| from odometry, metres, and its standard deviation.
  std::optional<double> distance;
  double distance_sigma = 0.0;

  // False with a message if a direction is not of unit length within kMaxUnitError, a sigma is not
  // positive (that of the distance: negative) or anything is not finite.
  bool IsValid(std::string* error) const;
};
static_assert(kSameLayoutEverywhere<MotionPrior>, "no member of MotionPrior may be aligned");

// Directions that are off by less are normalized where they are used.
inline constexpr double kMaxUnitError = 1e-3;

// What a minimal solver needs to be known.
enum class PriorKind {
  kNone,      // 6 degrees of freedom
  kVertical,  // gravity1 and gravity2
  kAxis,      // axis
  kPlanar,    // normal
};

// True if `prior` has what `kind` needs.
inline bool HasPrior(const MotionPrior& prior, PriorKind kind) {
  switch (kind) {
    case PriorKind::kNone:
      return true;
    case PriorKind::kVertical:
      return prior.gravity1.has_value() && prior.gravity2.has_value();
    case PriorKind::kAxis:
      return prior.axis.has_value();
    case PriorKind::kPlanar:
      return prior.normal.has_value();
  }
  return false;
}

}  // namespace rigel

#endif  // RIGEL_CORE_PRIOR_H_
