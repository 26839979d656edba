// Newton steps on the exact determinant: what makes a first-order solver exact.
#ifndef RIGEL_MINIMAL_POLISH_H_
#define RIGEL_MINIMAL_POLISH_H_

#include <cmath>

#include "rigel/minimal/polynomial.h"

namespace rigel {

// Improves the approximate real roots `starts`, at most four, of the polynomial c of degree N.
// Starts that do not converge in six steps (three are enough at one degree of rotation) and
// duplicates are dropped. Returns the number of roots.
template <int N>
int PolishRoots(const double* c, const double* starts, int num_starts, double* roots) {
  constexpr int kMaxSteps = 6;
  // Quadratic convergence: the error left is of the order of the step squared.
  constexpr double kConverged = 1e-7;
  constexpr int kLanes = 4;
  if (num_starts == 0) return 0;
  double z[kLanes], step[kLanes];
  for (int l = 0; l < kLanes; ++l) z[l] = starts[l < num_starts ? l : 0];
  // All at once: a step of one depends on its last one, and the others fill the time.
  for (int n = 0; n < kMaxSteps; ++n) {
    double value[kLanes], slope[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      value[l] = c[N] * z[l] + c[N - 1];
      slope[l] = c[N];
    }
    for (int k = N - 2; k >= 0; --k) {
      for (int l = 0; l < kLanes; ++l) {
        slope[l] = slope[l] * z[l] + value[l];
        value[l] = value[l] * z[l] + c[k];
      }
    }
    bool all = true;
    for (int l = 0; l < kLanes; ++l) {
      step[l] = value[l] / slope[l];
      z[l] -= step[l];
    }
    for (int l = 0; l < kLanes; ++l) all &= !(std::abs(step[l]) > kConverged * std::abs(z[l]));
    if (all) break;
  }
  int count = 0;
  for (int k = 0; k < num_starts; ++k) {
    if (!std::isfinite(z[k]) || !(std::abs(step[k]) <= 1e-5 * (1e-6 + std::abs(z[k])))) continue;
    bool duplicate = false;
    for (int n = 0; n < count; ++n) {
      duplicate = duplicate || std::abs(roots[n] - z[k]) <= 1e-9 * std::abs(z[k]);
    }
    if (!duplicate) roots[count++] = z[k];
  }
  return count;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_POLISH_H_
