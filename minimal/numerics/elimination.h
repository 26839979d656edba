// Small linear systems in the inner loops of solvers.
#ifndef RIGEL_MINIMAL_NUMERICS_ELIMINATION_H_
#define RIGEL_MINIMAL_NUMERICS_ELIMINATION_H_

#include <Eigen/Core>

namespace rigel {

// Solves the six equations a[r][0..5] . x = a[r][6] by elimination with partial pivoting, in place;
// not finite if they are dependent. a[r][7] is padding. By hand, as Eigen's PartialPivLU takes 6 to
// 15 percent more: kernels_benchmark --benchmark_filter=SixEquations.
void SolveSixBySix(double (*a)[8], double* x);

// The null vector of a rank 3 approximation of the six rows of M, by Eigen's complete
// pivoting.
Eigen::Vector4d NullVector(const double (*M)[4]);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_NUMERICS_ELIMINATION_H_
