// A match's epipolar constraint and its gradient by the pixels, for kernels and for single matches.
//
// Included by kernel files (cpu_path.h): static and always inlined, so that no copy of it is
// shared.
#ifndef RIGEL_CORE_SAMPSON_TERMS_H_
#define RIGEL_CORE_SAMPSON_TERMS_H_

#include <cstddef>

#include "rigel/core/cpu_path.h"
#include "rigel/core/row_arrays.h"

namespace rigel {

// Of a match of pinhole cameras, p = (centred pixel, 1).
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

// A match of any cameras: its points p and their 3 x 2 derivatives J by the pixels (row_point.h),
// row by row.
struct RowOfMatch {
  double p1[3], p2[3];
  double J1[6], J2[6];
};

struct RowTerms {
  double a[2], b[2];  // J2'F p1 and J1'F'p2: dC/d(pixel2) and dC/d(pixel1)
  double A[3], B[3];  // J2 a and J1 b
  double C;           // p2'F p1
  double gradient2;   // |a|^2 + |b|^2
};

// The same for these. `F` is row-major.
static RIGEL_KERNEL_BODY RowTerms TermsOf(const double F[9], const RowOfMatch& m) {
  RowTerms t;
  const double f0 = F[0] * m.p1[0] + F[1] * m.p1[1] + F[2] * m.p1[2];
  const double f1 = F[3] * m.p1[0] + F[4] * m.p1[1] + F[5] * m.p1[2];
  const double f2 = F[6] * m.p1[0] + F[7] * m.p1[1] + F[8] * m.p1[2];
  const double g0 = F[0] * m.p2[0] + F[3] * m.p2[1] + F[6] * m.p2[2];
  const double g1 = F[1] * m.p2[0] + F[4] * m.p2[1] + F[7] * m.p2[2];
  const double g2 = F[2] * m.p2[0] + F[5] * m.p2[1] + F[8] * m.p2[2];
  t.C = f0 * m.p2[0] + f1 * m.p2[1] + f2 * m.p2[2];
  t.a[0] = m.J2[0] * f0 + m.J2[2] * f1 + m.J2[4] * f2;
  t.a[1] = m.J2[1] * f0 + m.J2[3] * f1 + m.J2[5] * f2;
  t.b[0] = m.J1[0] * g0 + m.J1[2] * g1 + m.J1[4] * g2;
  t.b[1] = m.J1[1] * g0 + m.J1[3] * g1 + m.J1[5] * g2;
  t.A[0] = m.J2[0] * t.a[0] + m.J2[1] * t.a[1];
  t.A[1] = m.J2[2] * t.a[0] + m.J2[3] * t.a[1];
  t.A[2] = m.J2[4] * t.a[0] + m.J2[5] * t.a[1];
  t.B[0] = m.J1[0] * t.b[0] + m.J1[1] * t.b[1];
  t.B[1] = m.J1[2] * t.b[0] + m.J1[3] * t.b[1];
  t.B[2] = m.J1[4] * t.b[0] + m.J1[5] * t.b[1];
  t.gradient2 = (t.a[0] * t.a[0] + t.a[1] * t.a[1]) + (t.b[0] * t.b[0] + t.b[1] * t.b[1]);
  return t;
}

// Row k of arrays that have `general`.
static RIGEL_KERNEL_BODY RowOfMatch RowAt(const RowArrays& rows, int k) {
  const double* g = rows.general + k;
  const std::size_t n = rows.stride;
  return {{rows.x1[k], rows.y1[k], g[0]},
          {rows.x2[k], rows.y2[k], g[n]},
          {g[2 * n], g[3 * n], g[4 * n], g[5 * n], g[6 * n], g[7 * n]},
          {g[8 * n], g[9 * n], g[10 * n], g[11 * n], g[12 * n], g[13 * n]}};
}

// Times rounding2: the rounding error of the squared gradient of a match at an epipole.
static RIGEL_KERNEL_BODY double SizeOf(const RowOfMatch& m) {
  const double p1 = m.p1[0] * m.p1[0] + m.p1[1] * m.p1[1] + m.p1[2] * m.p1[2];
  const double p2 = m.p2[0] * m.p2[0] + m.p2[1] * m.p2[1] + m.p2[2] * m.p2[2];
  double J1 = 0.0, J2 = 0.0;
  for (int i = 0; i < 6; ++i) {
    J1 += m.J1[i] * m.J1[i];
    J2 += m.J2[i] * m.J2[i];
  }
  return 0.5 * (p1 * J2 + p2 * J1);
}

}  // namespace rigel

#endif  // RIGEL_CORE_SAMPSON_TERMS_H_
