#include "rigel/minimal/solvers/four_point_liu.h"

#include "rigel/minimal/numerics/laplace.h"
#include "rigel/minimal/numerics/polish.h"
#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/direct_sample.h"

namespace rigel {

namespace {

using laplace::Column;
using laplace::Pair;

// Coefficients of the first-order determinant, ascending in h = a / 2, where the columns x and z
// are x0 + h x1 and z0 + h z1, in the frame of the second moment.
void FirstOrderDeterminant(const DirectSample& rows, const Column& x1, const Column& z1,
                           double* c) {
  Pair sum[5];
  for (Pair& s : sum) s.setZero();
  laplace::ForEachTerm([&](auto term) {
    const auto xz = term.MinorsIJ(rows.x0, x1, rows.z0, z1);
    const Pair yk0 = term.MinorPQ(rows.y0, rows.k0);
    Pair yk1 = term.MinorPQ(rows.y1, rows.k0);
    // k of a deflated sample is divided by h: a constant.
    if (!rows.deflated()) {
      yk1 += term.MinorPQ(rows.y0, rows.k1);
      const Pair yk2 = term.MinorPQ(rows.y1, rows.k1);
      for (int m = 0; m < 3; ++m) sum[m + 2] += xz[m] * yk2;
    }
    for (int m = 0; m < 3; ++m) {
      sum[m] += xz[m] * yk0;
      sum[m + 1] += xz[m] * yk1;
    }
  });
  for (int n = 0; n < 5; ++n) c[n] = sum[n].sum();
}

}  // namespace

int Solve4ptLiu(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  // sin a = a and cos a = 1 in the frame of the second moment: the columns turned back by a / 2.
  const Column x1 = rows.x1 + rows.z0;
  const Column z1 = rows.z1 - rows.x0;
  double c[5];
  FirstOrderDeterminant(rows, x1, z1, c);
  double roots[4], starts[3];
  // One Newton step, as a rule: far below the error of the first order.
  const int num_roots = rows.deflated() ? PolishRoots<3>(c, starts, CubicStarts(c, starts), roots)
                                        : RealRoots<4>(c, roots);
  for (int n = 0; n < num_roots; ++n) rows.AddSolution(roots[n], solutions);
  return solutions->size();
}

}  // namespace rigel
