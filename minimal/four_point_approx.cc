#include "rigel/minimal/four_point_approx.h"

#include "rigel/minimal/depth_system.h"
#include "rigel/minimal/direct_system.h"
#include "rigel/minimal/polish.h"
#include "rigel/minimal/polynomial.h"

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
  DepthSystem<RotationModel::kExact> system;
  system.SetFourPoint(matches, sample);
  double c[7];
  const int degree = system.Determinant(c);
  if (degree == 0) return 0;
  // Starts: the direct form where it is a cubic; else the cubic Taylor polynomial of det F.
  double start_c[4] = {c[0], c[1], c[2], c[3]};
  if (degree == 5) DirectDeterminantIntra(matches, sample, start_c);
  double starts[3];
  const int num_starts = CubicStarts(start_c, starts);
  double roots[3];
  const int num_roots = degree == 6 ? PolishRoots<6>(c, starts, num_starts, roots)
                                    : PolishRoots<5>(c, starts, num_starts, roots);
  for (int k = 0; k < num_roots; ++k) system.AddSolution(matches, roots[k], solutions);
  return solutions->size();
}

}  // namespace rigel
