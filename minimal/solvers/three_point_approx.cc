#include "rigel/minimal/solvers/three_point_approx.h"

#include "rigel/minimal/numerics/polish.h"
#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/depth_system.h"

namespace rigel {

int Solve3ptApprox(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  DepthSystem<RotationModel::kFirstOrder> system;
  system.SetPlanar(matches, sample);
  double c[4];
  double roots[2];
  const int degree = system.Determinant(c);
  const int num_roots = degree == 0 ? 0 : RealRoots<2>(c, roots);
  for (int k = 0; k < num_roots; ++k) system.AddSolution(matches, roots[k], solutions);
  return solutions->size();
}

int Solve3ptApproxPolished(const PreparedMatches& matches, const int* sample,
                           Solutions* solutions) {
  solutions->clear();
  DepthSystem<RotationModel::kExact> system;
  system.SetPlanar(matches, sample);
  double c[7];
  if (system.Determinant(c) == 0) return 0;
  // The cubic Taylor polynomial of det F; for intra-camera samples that is det F itself.
  double starts[3];
  const int num_starts = CubicStarts(c, starts);
  double roots[3];
  const int num_roots = PolishRoots<4>(c, starts, num_starts, roots);
  for (int k = 0; k < num_roots; ++k) system.AddSolution(matches, roots[k], solutions);
  return solutions->size();
}

}  // namespace rigel
