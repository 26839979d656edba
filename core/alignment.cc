#include "rigel/core/alignment.h"

#include <cmath>
#include <optional>

#include "rigel/core/pose.h"

namespace rigel {
namespace {

bool UnitDirection(const std::optional<Eigen::Vector3d>& v, const char* name, Eigen::Vector3d* unit,
                   std::string* error) {
  if (!v.has_value()) {
    *error = std::string("the prior has no ") + name;
    return false;
  }
  if (!(std::abs(v->norm() - 1.0) < kMaxUnitError)) {
    *error = std::string("the prior's ") + name + " is not a unit vector";
    return false;
  }
  *unit = v->normalized();
  return true;
}

}  // namespace

double Alignment::NearestAngle(const Eigen::Matrix3d& R) const {
  const Eigen::Matrix3d M = A2 * R * A1.transpose();
  return std::atan2(M(0, 2) - M(2, 0), M(0, 0) + M(2, 2));
}

bool MakeAlignment(const MotionPrior& prior, PriorKind kind, Alignment* alignment,
                   std::string* error) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  Alignment result;
  result.kind = kind;
  Eigen::Vector3d n;
  switch (kind) {
    case PriorKind::kNone:
      break;
    case PriorKind::kVertical: {
      Eigen::Vector3d g1, g2;
      if (!UnitDirection(prior.gravity1, "gravity1", &g1, error) ||
          !UnitDirection(prior.gravity2, "gravity2", &g2, error)) {
        return false;
      }
      result.A1 = SmallestRotation(g1, y);
      result.A2 = result.A1 * SmallestRotation(g2, g1);
      break;
    }
    case PriorKind::kAxis:
    case PriorKind::kPlanar: {
      const bool planar = kind == PriorKind::kPlanar;
      if (!UnitDirection(planar ? prior.normal : prior.axis, planar ? "normal" : "axis", &n,
                         error)) {
        return false;
      }
      result.A1 = SmallestRotation(n, y);
      result.A2 = result.A1;
      Eigen::Vector3d forward;
      if (planar && prior.forward.has_value()) {
        if (!UnitDirection(prior.forward, "forward", &forward, error)) return false;
        result.forward = result.A1 * forward;
      }
      break;
    }
  }
  constexpr double kSameFrames = 1e-12;  // of the norm of A1 - A2: rounding
  result.contains_identity = (result.A1 - result.A2).norm() < kSameFrames;

  Eigen::Matrix3d along = Eigen::Matrix3d::Zero();
  along(1, 1) = 1.0;
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  turn(0, 2) = 1.0;
  turn(2, 0) = -1.0;
  result.B0 = result.A2.transpose() * along * result.A1;
  result.Bc = result.A2.transpose() * across * result.A1;
  result.Bs = result.A2.transpose() * turn * result.A1;
  *alignment = result;
  return true;
}

}  // namespace rigel
