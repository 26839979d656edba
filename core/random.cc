#include "rigel/core/random.h"

#include <cmath>

#include "rigel/core/angles.h"

namespace rigel {

Random Random::Stream(uint64_t seed, uint64_t index) {
  Random mixer(seed);
  const uint64_t a = mixer.Next();
  Random stream(a ^ (index * 0xd1342543de82ef95ULL));
  stream.Next();
  return stream;
}

double Random::Normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
  const double angle = 2.0 * kPi * Uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Eigen::Vector3d Random::NormalVector3() {
  const double x = Normal();
  const double y = Normal();
  const double z = Normal();
  return {x, y, z};
}

Eigen::Vector3d Random::UnitVector3() {
  const double z = Uniform(-1.0, 1.0);
  const double angle = Uniform(0.0, 2.0 * kPi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace rigel
