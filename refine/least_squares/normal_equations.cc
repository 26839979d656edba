#include "rigel/refine/least_squares/normal_equations.h"

#include <limits>

#include "rigel/refine/least_squares/fundamental_derivatives.h"

namespace rigel {
namespace {

// As the kernel takes them.
FundamentalDerivatives Padded(const ByMotionMatrix& by_motion) {
  FundamentalDerivatives D;
  for (int k = 0; k < 9; ++k) {
    for (int m = 0; m < 6; ++m) D.d[k][m] = by_motion(k, m);
    D.d[k][6] = D.d[k][7] = 0.0;
  }
  return D;
}

}  // namespace

double Rounding2(const Eigen::Matrix3d& F) {
  constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();
  return kRounding * kRounding * F.squaredNorm();
}

void AddNormalEquations(const SampsonKernelOptions& options, const GroupedMatches& matches,
                        const MatchGroup& group, const RowArrays& rows, const double* weights,
                        const Pose& pose, SampsonParts parts, MotionNormalEquations* sum) {
  const RowMajor3d F = matches.Fundamental(group, pose);
  SampsonSums sums;
  SumSampson(options, rows, weights, F.data(), Rounding2(F), parts, &sums);
  sum->cost += sums.cost;
  if (parts == SampsonParts::kCost) return;
  const ByMotionMatrix by_motion = FundamentalByMotion(matches, group, pose, false);
  if (parts == SampsonParts::kAll) {
    AddProjected(sums, Padded(by_motion), sum->gradient.data(), sum->curvature.data());
  } else {
    sum->gradient += by_motion.transpose() * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(sums.g);
  }
}

void AddRobustEquations(LossKind loss, double loss_scale_sigmas, double sigma,
                        const GroupedMatches& matches, const MatchGroup& group,
                        const double* weights, const Pose& pose, SampsonParts parts,
                        MotionNormalEquations* sum) {
  SampsonKernelOptions options;
  options.loss = loss;
  options.loss_scale = loss_scale_sigmas * sigma;
  MotionNormalEquations equations;
  AddNormalEquations(options, matches, group, matches.Rows(group), weights, pose, parts,
                     &equations);
  const double variance = sigma * sigma;
  sum->cost += equations.cost / variance;
  sum->gradient += equations.gradient / variance;
  sum->curvature += equations.curvature / variance;
}

void Leverages(const GroupedMatches& matches, const MatchGroup& group, const Pose& pose,
               const double* weights, const Matrix6d& covariance, double* leverages) {
  const RowMajor3d F = matches.Fundamental(group, pose);
  const ByMotionMatrix by_motion = FundamentalByMotion(matches, group, pose, false);
  const Eigen::Matrix<double, 9, 9> C = by_motion * covariance * by_motion.transpose();
  SampsonLeverages(matches.Rows(group), weights, F.data(), C.data(), Rounding2(F), leverages);
}

}  // namespace rigel
