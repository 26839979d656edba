// The signs of a match's depths, for kernels and for single matches.
//
// Included by kernel files (cpu_path.h): static and always inlined, so that no copy of it is
// shared.
#ifndef RIGEL_CORE_DEPTH_TERMS_H_
#define RIGEL_CORE_DEPTH_TERMS_H_

#include "rigel/core/cpu_path.h"

namespace rigel {

// Numerators of the depths and their common denominator, so that signs need no division.
struct DepthTerms {
  double n1, n2;  // d1 sin2 and d2 sin2, metres
  double sin2;    // squared sine of the parallax
};

// From the unit directions g = R x_i and f = x_j in f2 and the baseline b. The rays meet where
// b + d1 g = d2 f. Crossed with f and with g: d1 n = f x b and d2 n = g x b for n = g x f.
static RIGEL_KERNEL_BODY DepthTerms DepthTermsOf(double gx, double gy, double gz, double fx,
                                                 double fy, double fz, double bx, double by,
                                                 double bz) {
  const double nx = gy * fz - gz * fy;
  const double ny = gz * fx - gx * fz;
  const double nz = gx * fy - gy * fx;
  DepthTerms t;
  t.sin2 = nx * nx + ny * ny + nz * nz;
  t.n1 = (fy * bz - fz * by) * nx + (fz * bx - fx * bz) * ny + (fx * by - fy * bx) * nz;
  t.n2 = (gy * bz - gz * by) * nx + (gz * bx - gx * bz) * ny + (gx * by - gy * bx) * nz;
  return t;
}

}  // namespace rigel

#endif  // RIGEL_CORE_DEPTH_TERMS_H_
