#include "rigel/core/prior.h"

#include <cmath>

namespace rigel {

bool MotionPrior::IsValid(std::string* error) const {
  const struct {
    const char* name;
    const std::optional<Eigen::Vector3d>& direction;
  } directions[] = {{"gravity1", gravity1},
                    {"gravity2", gravity2},
                    {"axis", axis},
                    {"normal", normal},
                    {"forward", forward}};
  for (const auto& [name, direction] : directions) {
    // Also false for NaN.
    if (direction && !(std::abs(direction->norm() - 1.0) < kMaxUnitError)) {
      *error = std::string("the prior's ") + name + " is not a unit vector";
      return false;
    }
  }
  const struct {
    const char* name;
    const std::optional<double>& sigma;
  } sigmas[] = {
      {"gravity_sigma", gravity_sigma}, {"axis_sigma", axis_sigma}, {"normal_sigma", normal_sigma}};
  for (const auto& [name, sigma] : sigmas) {
    if (sigma && !(*sigma > 0 && std::isfinite(*sigma))) {
      *error = std::string("the prior's ") + name + ": a sigma must be positive and finite";
      return false;
    }
  }
  if (distance && !(*distance >= 0 && std::isfinite(*distance))) {
    *error = "the prior's distance is negative or not finite";
    return false;
  }
  if (!(distance_sigma >= 0) || !std::isfinite(distance_sigma)) {
    *error = "the prior's distance_sigma: a sigma must not be negative, and finite";
    return false;
  }
  return true;
}

}  // namespace rigel
