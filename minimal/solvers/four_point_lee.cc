#include "rigel/minimal/solvers/four_point_lee.h"

#include <algorithm>

#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/direct_sample.h"

namespace rigel {
namespace {

// p q' - q p' of two quadratics each.
void Minor(const double* p0, const double* q0, const double* p1, const double* q1, double* m) {
  m[0] = p0[0] * q1[0] - q0[0] * p1[0];
  m[1] = p0[0] * q1[1] + p0[1] * q1[0] - q0[0] * p1[1] - q0[1] * p1[0];
  m[2] =
      p0[0] * q1[2] + p0[1] * q1[1] + p0[2] * q1[0] - q0[0] * p1[2] - q0[1] * p1[1] - q0[2] * p1[0];
  m[3] = p0[1] * q1[2] + p0[2] * q1[1] - q0[1] * p1[2] - q0[2] * p1[1];
  m[4] = p0[2] * q1[2] - q0[2] * p1[2];
}

// Rows i, j of the minors of (x, z) and p, q of those of (y, k): even permutations.
constexpr int kSplits[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                               {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};

// Coefficients c[0..8], ascending in z = tan(a/2), of the determinant.
void Determinant(const DirectSample& rows, double c[9]) {
  // (1 + z^2) times each entry in the frame of the second moment: the columns of `rows` turned back
  // by a / 2; k of a deflated sample is divided by z.
  double x[4][3], y[4][3], z[4][3], k[4][3];
  for (int r = 0; r < 4; ++r) {
    x[r][0] = rows.x0[r];
    x[r][1] = rows.x1[r] + rows.z0[r];
    x[r][2] = rows.z1[r];
    y[r][0] = rows.y0[r];
    y[r][1] = rows.y1[r];
    y[r][2] = -rows.y0[r];
    z[r][0] = rows.z0[r];
    z[r][1] = rows.z1[r] - rows.x0[r];
    z[r][2] = -rows.x1[r];
    k[r][0] = rows.k0[r];
    k[r][1] = rows.k1[r];
    k[r][2] = rows.k2[r];
  }

  // Laplace expansion: minors of columns (x, z) of rows (i, j) with those of (y, k) of the others.
  std::fill(c, c + 9, 0.0);
  for (const auto& [i, j, p, q] : kSplits) {
    double a[5], b[5];
    Minor(x[i], z[i], x[j], z[j], a);
    Minor(y[p], k[p], y[q], k[q], b);
    for (int n = 0; n < 5; ++n) {
      for (int l = 0; l < 5; ++l) c[n + l] += a[n] * b[l];
    }
  }
}

}  // namespace

int Solve4ptLee(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  double c[9];
  Determinant(rows, c);
  // The determinant of degree 8 is 1 + z^2 times one of degree 6, as (x, z) turn by a rotation: the
  // quotient has the same real roots. That of a deflated sample is a quintic.
  double sextic[7];
  // From both ends: what rounding leaves of c[n] must not reach smaller coefficients.
  for (int n = 0; n < 4; ++n) sextic[n] = c[n] - (n >= 2 ? sextic[n - 2] : 0.0);
  for (int n = 6; n >= 4; --n) sextic[n] = c[n + 2] - (n <= 4 ? sextic[n + 2] : 0.0);
  double roots[6];
  const int num_roots = rows.deflated() ? RealRoots<5>(sextic, roots) : RealRoots<6>(sextic, roots);
  for (int n = 0; n < num_roots; ++n) rows.AddSolution(roots[n], solutions);
  return solutions->size();
}

}  // namespace rigel
