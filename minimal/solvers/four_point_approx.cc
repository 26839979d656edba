#include "rigel/minimal/solvers/four_point_approx.h"

#include "rigel/minimal/numerics/polish.h"
#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/depth_system.h"
#include "rigel/minimal/solvers/direct_sample.h"

namespace rigel {

int Solve4ptApprox(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  DepthSystem<RotationModel::kFirstOrder> system;
  system.SetFourPoint(matches, sample);
  double c[4];
  double roots[3];
  const int degree = system.Determinant(c);
  const int num_roots = degree == 0   ? 0
                        : degree <= 2 ? RealRoots<2>(c, roots)
                                      : RealRoots<3>(c, roots);
  for (int k = 0; k < num_roots; ++k) system.AddSolution(matches, roots[k], solutions);
  return solutions->size();
}

int Solve4ptApproxPolished(const PreparedMatches& matches, const int* sample,
                           Solutions* solutions) {
  solutions->clear();
  const DirectSample rows(matches, sample);
  if (!rows.has_parallax()) return 0;
  double c[7], first_order[4], starts[3], roots[3];
  rows.Determinant(c, first_order);
  // Of samples that are not deflated the Taylor polynomial of order 3.
  const int num_starts = CubicStarts(rows.deflated() ? first_order : c, starts);
  const int num_roots = rows.deflated() ? PolishRoots<5>(c, starts, num_starts, roots)
                                        : PolishRoots<6>(c, starts, num_starts, roots);
  for (int k = 0; k < num_roots; ++k) rows.AddSolution(roots[k], solutions);
  return solutions->size();
}

}  // namespace rigel
