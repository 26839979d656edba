#include "rigel/refine/normal_equations.h"

namespace rigel {

void AddNormalEquations(const SampsonKernelOptions& options, const GroupLinearization& linear,
                        const PixelArrays& pixels, const double* weights, double* cost,
                        ParameterVector* gradient, ParameterMatrix* curvature) {
  using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const int n = static_cast<int>(gradient->size());
  const RowMajor3d F = linear.F;
  SampsonSums sums;
  SumSampson(options, pixels, weights, F.data(), linear.rounding2, true, &sums);
  *cost += sums.cost;
  Eigen::Matrix<double, 9, Eigen::Dynamic, Eigen::ColMajor, 9, 6> D(9, n);
  for (int m = 0; m < n; ++m) Eigen::Map<RowMajor3d>(D.col(m).data()) = linear.dF[m];
  const Eigen::Map<const Eigen::Matrix<double, 9, 9>> H(sums.H);
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> g(sums.g);
  const Eigen::Matrix<double, 9, Eigen::Dynamic, Eigen::ColMajor, 9, 6> HD = H.lazyProduct(D);
  gradient->noalias() += D.transpose().lazyProduct(g);
  curvature->noalias() += D.transpose().lazyProduct(HD);
}

}  // namespace rigel
