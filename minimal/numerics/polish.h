// Newton steps on the exact determinant: what makes a first-order solver exact.
#ifndef RIGEL_MINIMAL_NUMERICS_POLISH_H_
#define RIGEL_MINIMAL_NUMERICS_POLISH_H_

#include <cmath>

#include "rigel/minimal/numerics/newton_lanes.h"

namespace rigel {

// Improves the approximate real roots `starts`, at most four, of the polynomial c of degree N.
// Starts that do not converge in six steps (three are enough at one degree of rotation) and
// duplicates are dropped. Returns the number of roots.
template <int N>
int PolishRoots(const double* c, const double* starts, int num_starts, double* roots) {
  // At one degree of rotation three are enough. Each doubles the digits: a start that needs more
  // than these has no root near.
  constexpr int kMaxSteps = 6;
  // Relative to the root, as are those below. Quadratic convergence: the error left is of the order
  // of the step squared.
  constexpr double kLastStep = 1e-7;
  constexpr double kLargestLastStep = 1e-5;  // more does not converge
  constexpr double kDuplicate = 1e-9;        // less is one root, found twice
  constexpr double kZeroRoot = 1e-6;         // radians: for roots below it, relative to it
  if (num_starts == 0) return 0;
  const polynomial_internal::PolynomialInLanes<N> p(c);
  auto z = polynomial_internal::LanesOf<4>(starts, num_starts);
  auto step = z;
  for (int n = 0; n < kMaxSteps; ++n) {
    step = p.NewtonStep(z);
    z -= step;
    if (!(step.abs() > kLastStep * z.abs()).any()) break;
  }
  int count = 0;
  for (int k = 0; k < num_starts; ++k) {
    const double size = kZeroRoot + std::abs(z[k]);
    if (!std::isfinite(z[k]) || !(std::abs(step[k]) <= kLargestLastStep * size)) continue;
    bool duplicate = false;
    for (int n = 0; n < count; ++n) {
      duplicate = duplicate || std::abs(roots[n] - z[k]) <= kDuplicate * size;
    }
    if (!duplicate) roots[count++] = z[k];
  }
  return count;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_NUMERICS_POLISH_H_
