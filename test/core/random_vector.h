// Random vectors of random length. The order of the draws is stated: in `a.Uniform() *
// a.UnitVector3()` it is the compiler's choice.
#ifndef RIGEL_TEST_CORE_RANDOM_VECTOR_H_
#define RIGEL_TEST_CORE_RANDOM_VECTOR_H_

#include <Eigen/Core>

#include "rigel/core/random.h"

namespace rigel {

// Length uniform in [low, high), direction uniform on the sphere.
inline Eigen::Vector3d RandomVector3(double low, double high, Random* random) {
  const double length = random->Uniform(low, high);
  return length * random->UnitVector3();
}

}  // namespace rigel

#endif  // RIGEL_TEST_CORE_RANDOM_VECTOR_H_
