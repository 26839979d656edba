// Newton steps on the exact determinant: what makes a first-order solver exact.
#ifndef RIGEL_MINIMAL_POLISH_H_
#define RIGEL_MINIMAL_POLISH_H_

#include <cmath>

#include "rigel/minimal/polynomial.h"

namespace rigel {

// Improves the approximate real roots `starts` of the polynomial c of degree N. Starts that do not
// converge in six steps (three are enough at one degree of rotation) and duplicates are dropped.
// Returns the number of roots.
template <int N>
int PolishRoots(const double* c, const double* starts, int num_starts, double* roots) {
  int count = 0;
  for (int k = 0; k < num_starts; ++k) {
    double z = starts[k];
    double step = 0.0;
    for (int n = 0; n < 6; ++n) {
      double slope = 0.0;
      const double value = EvaluatePolynomial<N>(c, z, &slope);
      step = value / slope;
      z -= step;
      // Quadratic convergence: the error left is of the order of the step squared.
      if (!(std::abs(step) > 1e-7 * std::abs(z))) break;
    }
    if (!std::isfinite(z) || !(std::abs(step) <= 1e-5 * (1e-6 + std::abs(z)))) continue;
    bool duplicate = false;
    for (int n = 0; n < count; ++n) {
      duplicate = duplicate || std::abs(roots[n] - z) <= 1e-9 * std::abs(z);
    }
    if (!duplicate) roots[count++] = z;
  }
  return count;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_POLISH_H_
