// A match's epipolar constraint and its gradient by the pixels, for kernels and for single matches.
//
// Included by kernel files (cpu_path.h): static and always inlined, so that no copy of it is
// shared.
#ifndef RIGEL_CORE_SAMPSON_TERMS_H_
#define RIGEL_CORE_SAMPSON_TERMS_H_

#include "rigel/core/cpu_path.h"

namespace rigel {

struct SampsonTerms {
  double a0, a1;     // first two entries of F p1
  double b0, b1;     // of F'p2
  double C;          // p2'F p1
  double gradient2;  // a0^2 + a1^2 + b0^2 + b1^2
};

// `F` is row-major.
static RIGEL_KERNEL_BODY SampsonTerms TermsOf(const double F[9], double x1, double y1, double x2,
                                              double y2) {
  SampsonTerms t;
  t.a0 = F[0] * x1 + F[1] * y1 + F[2];
  t.a1 = F[3] * x1 + F[4] * y1 + F[5];
  const double a2 = F[6] * x1 + F[7] * y1 + F[8];
  t.b0 = F[0] * x2 + F[3] * y2 + F[6];
  t.b1 = F[1] * x2 + F[4] * y2 + F[7];
  t.C = t.a0 * x2 + t.a1 * y2 + a2;
  t.gradient2 = (t.a0 * t.a0 + t.a1 * t.a1) + (t.b0 * t.b0 + t.b1 * t.b1);
  return t;
}

}  // namespace rigel

#endif  // RIGEL_CORE_SAMPSON_TERMS_H_
