#include "rigel/minimal/four_point_liu.h"

#include <cmath>

#include "rigel/minimal/direct_sample.h"
#include "rigel/minimal/polynomial.h"

namespace rigel {

namespace {

// tan(x), to 1e-13 where x is small: then faster than std::tan.
double Tangent(double x) {
  if (!(std::abs(x) < 0.2)) return std::tan(x);
  const double x2 = x * x;
  return x * (945.0 + x2 * (x2 - 105.0)) / (945.0 + x2 * (15.0 * x2 - 420.0));
}

}  // namespace

int Solve4ptLiu(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  // Columns of t_x, t_y, t_z and 1 as p + q a; k of a deflated sample is divided by a, a constant.
  double p[4][4], q[4][4];
  for (int r = 0; r < 4; ++r) {
    const ConstraintRow& m = rows[r];
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
  const bool deflated = rows.deflated();
  const auto add = [&](int i, int j, int k, int l, double sign) {
    const double a0 = p[i][0] * p[j][2] - p[i][2] * p[j][0];
    const double a1 = p[i][0] * q[j][2] + q[i][0] * p[j][2] - p[i][2] * q[j][0] - q[i][2] * p[j][0];
    const double a2 = q[i][0] * q[j][2] - q[i][2] * q[j][0];
    const double b0 = sign * (p[k][1] * p[l][3] - p[k][3] * p[l][1]);
    double b1 = q[k][1] * p[l][3] - p[k][3] * q[l][1];
    if (!deflated) b1 += p[k][1] * q[l][3] - q[k][3] * p[l][1];
    b1 *= sign;
    c[0] += a0 * b0;
    c[1] += a0 * b1 + a1 * b0;
    c[2] += a1 * b1 + a2 * b0;
    c[3] += a2 * b1;
    if (deflated) return;
    const double b2 = sign * (q[k][1] * q[l][3] - q[k][3] * q[l][1]);
    c[2] += a0 * b2;
    c[3] += a1 * b2;
    c[4] += a2 * b2;
  };
  add(0, 1, 2, 3, 1.0);
  add(0, 2, 1, 3, -1.0);
  add(0, 3, 1, 2, 1.0);
  add(1, 2, 0, 3, 1.0);
  add(1, 3, 0, 2, -1.0);
  add(2, 3, 0, 1, 1.0);

  double roots[4];
  const int num_roots = rows.deflated() ? RealRoots<3>(c, roots) : RealRoots<4>(c, roots);
  for (int n = 0; n < num_roots; ++n) rows.AddSolution(Tangent(0.5 * roots[n]), solutions);
  return solutions->size();
}

}  // namespace rigel
