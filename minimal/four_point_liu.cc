#include "rigel/minimal/four_point_liu.h"

#include <cmath>

#include "rigel/minimal/direct_sample.h"
#include "rigel/minimal/polynomial.h"

namespace rigel {

int Solve4ptLiu(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  // Columns of t_x, t_y, t_z and 1 as p + q a; k of a deflated sample is divided by a.
  double p[4][4], q[4][4];
  for (int r = 0; r < 4; ++r) {
    const DirectSample::Row& m = rows[r];
    p[r][0] = m.X0 + m.Xc;
    q[r][0] = m.Xs;
    p[r][1] = m.Yc;
    q[r][1] = m.Ys;
    p[r][2] = m.Z0 + m.Xs;
    q[r][2] = -m.Xc;
    p[r][3] = rows.deflated() ? m.Ks : m.K0 + m.Kc;
    q[r][3] = rows.deflated() ? 0.0 : m.Ks;
  }

  // Laplace expansion: minors of columns (0, 2) of rows (i, j) with those of (1, 3) of the others.
  double c[5] = {};
  const auto minor = [&](int i, int j, int u, int v, double* m) {
    m[0] = p[i][u] * p[j][v] - p[i][v] * p[j][u];
    m[1] = p[i][u] * q[j][v] + q[i][u] * p[j][v] - p[i][v] * q[j][u] - q[i][v] * p[j][u];
    m[2] = q[i][u] * q[j][v] - q[i][v] * q[j][u];
  };
  const auto add = [&](int i, int j, int k, int l, double sign) {
    double a[3], b[3];
    minor(i, j, 0, 2, a);
    minor(k, l, 1, 3, b);
    c[0] += sign * (a[0] * b[0]);
    c[1] += sign * (a[0] * b[1] + a[1] * b[0]);
    c[2] += sign * (a[0] * b[2] + a[1] * b[1] + a[2] * b[0]);
    c[3] += sign * (a[1] * b[2] + a[2] * b[1]);
    c[4] += sign * (a[2] * b[2]);
  };
  add(0, 1, 2, 3, 1.0);
  add(0, 2, 1, 3, -1.0);
  add(0, 3, 1, 2, 1.0);
  add(1, 2, 0, 3, 1.0);
  add(1, 3, 0, 2, -1.0);
  add(2, 3, 0, 1, 1.0);

  double roots[4];
  const int num_roots = rows.deflated() ? RealRoots<3>(c, roots) : RealRoots<4>(c, roots);
  for (int n = 0; n < num_roots; ++n) rows.AddSolution(std::tan(0.5 * roots[n]), solutions);
  return solutions->size();
}

}  // namespace rigel
