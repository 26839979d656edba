#include "rigel/minimal/solvers/four_point_sweeney.h"

#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/direct_sample.h"

namespace rigel {

int Solve4ptSweeney(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  double c[7], first_order[4];
  rows.Determinant(c, first_order);
  double roots[6];
  const int num_roots = rows.deflated() ? RealRoots<5>(c, roots) : RealRoots<6>(c, roots);
  for (int n = 0; n < num_roots; ++n) rows.AddSolution(roots[n], solutions);
  return solutions->size();
}

}  // namespace rigel
