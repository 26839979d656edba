#include "rigel/minimal/solvers/three_point.h"

#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/depth_system.h"

namespace rigel {

int Solve3pt(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  DepthSystem<RotationModel::kExact> system;
  system.SetPlanar(matches, sample);
  double c[7];
  double roots[4];
  const int degree = system.Determinant(c);
  const int num_roots = degree == 0   ? 0
                        : degree <= 3 ? RealRoots<3>(c, roots)
                                      : RealRoots<4>(c, roots);
  for (int k = 0; k < num_roots; ++k) system.AddSolution(matches, roots[k], solutions);
  return solutions->size();
}

}  // namespace rigel
