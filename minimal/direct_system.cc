#include "rigel/minimal/direct_system.h"

namespace rigel {

void DirectDeterminantIntra(const PreparedMatches& matches, const int* sample, double* c) {
  // Entries a + b z of the columns x and z, y; column k is the constant Ks after division by 2 z.
  double xa[4], xb[4], za[4], zb[4], ya[4], yb[4], k[4];
  for (int r = 0; r < 4; ++r) {
    const PreparedMatch& m = matches[sample[r]];
    xa[r] = m.X0 + m.Xc;
    xb[r] = m.Xs - m.Z0;
    za[r] = m.Z0 + m.Xs;
    zb[r] = m.X0 - m.Xc;
    ya[r] = m.Yc;
    yb[r] = 2.0 * m.Ys;
    k[r] = m.Ks;
  }
  c[0] = c[1] = c[2] = c[3] = 0.0;
  // Laplace expansion: minors of columns (x, z) of rows (i, j) with those of (y, k) of the others.
  const auto add = [&](int i, int j, int p, int q, double sign) {
    const double m0 = xa[i] * za[j] - za[i] * xa[j];
    const double m1 = xa[i] * zb[j] + xb[i] * za[j] - za[i] * xb[j] - zb[i] * xa[j];
    const double m2 = xb[i] * zb[j] - zb[i] * xb[j];
    const double n0 = sign * (ya[p] * k[q] - k[p] * ya[q]);
    const double n1 = sign * (yb[p] * k[q] - k[p] * yb[q]);
    c[0] += m0 * n0;
    c[1] += m0 * n1 + m1 * n0;
    c[2] += m1 * n1 + m2 * n0;
    c[3] += m2 * n1;
  };
  add(0, 1, 2, 3, 1.0);
  add(0, 2, 1, 3, -1.0);
  add(0, 3, 1, 2, 1.0);
  add(1, 2, 0, 3, 1.0);
  add(1, 3, 0, 2, -1.0);
  add(2, 3, 0, 1, 1.0);
}

}  // namespace rigel
