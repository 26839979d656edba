#include "rigel/minimal/score_kernel.h"

#include <limits>

namespace rigel {
namespace {

inline void NumeratorAndGradient(const double F[9], double x1, double y1, double x2, double y2,
                                 double* C2, double* g2) {
  const double a0 = F[0] * x1 + F[1] * y1 + F[2];
  const double a1 = F[3] * x1 + F[4] * y1 + F[5];
  const double a2 = F[6] * x1 + F[7] * y1 + F[8];
  const double b0 = F[0] * x2 + F[3] * y2 + F[6];
  const double b1 = F[1] * x2 + F[4] * y2 + F[7];
  const double C = a0 * x2 + a1 * y2 + a2;
  *C2 = C * C;
  *g2 = (a0 * a0 + a1 * a1) + (b0 * b0 + b1 * b1);
}

}  // namespace

double TruncatedSampsonSum(const PixelArrays& pixels, const double F[9], double t2, double bound,
                           int* num_inliers) {
  // Blocks that the compiler turns into vector code; the order of the additions is fixed, so the
  // sum does not depend on the width of the vectors.
  constexpr int kBlock = 32;
  double sum = 0.0;
  int count = 0;
  int k = 0;
  for (; k + kBlock <= pixels.size; k += kBlock) {
    double e[kBlock];
    for (int i = 0; i < kBlock; ++i) {
      double C2, g2;
      NumeratorAndGradient(F, pixels.x1[k + i], pixels.y1[k + i], pixels.x2[k + i],
                           pixels.y2[k + i], &C2, &g2);
      const double r2 = C2 / g2;
      // A NaN fails the comparison and counts t2.
      e[i] = r2 < t2 ? r2 : t2;
    }
    double lanes[4] = {0, 0, 0, 0};
    for (int i = 0; i < kBlock; i += 4) {
      for (int j = 0; j < 4; ++j) lanes[j] += e[i + j];
    }
    int inliers = 0;
    for (int i = 0; i < kBlock; ++i) inliers += e[i] < t2 ? 1 : 0;
    count += inliers;
    sum += (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    if (sum > bound) break;
  }
  if (sum <= bound) {
    for (; k < pixels.size; ++k) {
      double C2, g2;
      NumeratorAndGradient(F, pixels.x1[k], pixels.y1[k], pixels.x2[k], pixels.y2[k], &C2, &g2);
      const double r2 = C2 / g2;
      const bool inlier = r2 < t2;
      sum += inlier ? r2 : t2;
      count += inlier ? 1 : 0;
    }
  }
  *num_inliers += count;
  return sum;
}

void SquaredSampsonErrors(const PixelArrays& pixels, const double F[9], double* squared_errors) {
  for (int k = 0; k < pixels.size; ++k) {
    double C2, g2;
    NumeratorAndGradient(F, pixels.x1[k], pixels.y1[k], pixels.x2[k], pixels.y2[k], &C2, &g2);
    squared_errors[k] = g2 > 0 ? C2 / g2 : std::numeric_limits<double>::infinity();
  }
}

}  // namespace rigel
