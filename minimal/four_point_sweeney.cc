#include "rigel/minimal/four_point_sweeney.h"

#include "rigel/minimal/direct_sample.h"
#include "rigel/minimal/polynomial.h"

namespace rigel {

int Solve4ptSweeney(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  // Columns of t'_x and t'_z times sqrt(1 + z^2), of t'_y and 1 times 1 + z^2; k of a deflated
  // sample is divided by z.
  double x[4][2], z[4][2], y[4][2], k[4][3];
  for (int r = 0; r < 4; ++r) {
    const ConstraintRow& m = rows[r];
    x[r][0] = m.X0 + m.Xc;
    x[r][1] = m.Xs - m.Z0;
    z[r][0] = m.Z0 + m.Xs;
    z[r][1] = m.X0 - m.Xc;
    y[r][0] = m.Yc;  // and -Yc z^2
    y[r][1] = 2.0 * m.Ys;
    if (rows.deflated()) {
      k[r][0] = 2.0 * m.Ks;
      k[r][1] = m.K0 - m.Kc;
      k[r][2] = 0.0;
    } else {
      k[r][0] = m.K0 + m.Kc;
      k[r][1] = 2.0 * m.Ks;
      k[r][2] = m.K0 - m.Kc;
    }
  }

  // Laplace expansion: minors of columns (x, z) of rows (i, j) with those of (y, k) of the others.
  double c[7] = {};
  const auto add = [&](int i, int j, int p, int q, double sign) {
    const double a[3] = {
        x[i][0] * z[j][0] - z[i][0] * x[j][0],
        x[i][0] * z[j][1] + x[i][1] * z[j][0] - z[i][0] * x[j][1] - z[i][1] * x[j][0],
        x[i][1] * z[j][1] - z[i][1] * x[j][1]};
    const double* yp = y[p];
    const double* yq = y[q];
    const double* kp = k[p];
    const double* kq = k[q];
    const double yk0 = yp[0] * kq[0] - yq[0] * kp[0];
    const double yk1 = yp[0] * kq[1] - yq[0] * kp[1];
    const double yk2 = yp[0] * kq[2] - yq[0] * kp[2];
    const double b[5] = {sign * yk0, sign * (yk1 + yp[1] * kq[0] - yq[1] * kp[0]),
                         sign * (yk2 - yk0 + yp[1] * kq[1] - yq[1] * kp[1]),
                         sign * (yp[1] * kq[2] - yq[1] * kp[2] - yk1), -sign * yk2};
    for (int n = 0; n < 3; ++n) {
      for (int l = 0; l < 5; ++l) c[n + l] += a[n] * b[l];
    }
  };
  add(0, 1, 2, 3, 1.0);
  add(0, 2, 1, 3, -1.0);
  add(0, 3, 1, 2, 1.0);
  add(1, 2, 0, 3, 1.0);
  add(1, 3, 0, 2, -1.0);
  add(2, 3, 0, 1, 1.0);

  double roots[6];
  const int num_roots = rows.deflated() ? RealRoots<5>(c, roots) : RealRoots<6>(c, roots);
  for (int n = 0; n < num_roots; ++n) rows.AddSolution(roots[n], solutions);
  return solutions->size();
}

}  // namespace rigel
