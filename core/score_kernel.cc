#include "rigel/core/score_kernel.h"

#include <limits>

#include "rigel/core/depth_terms.h"
#include "rigel/core/kernel_lanes.h"
#include "rigel/core/sampson_terms.h"

namespace rigel {
namespace {

// So many matches at a time; their sum is a tree of a fixed form, so it does not depend on the
// width of the vectors.
constexpr int kBlock = 32;

// `size`, at most kBlock, rounded up to whole vectors of any path: no loop has a rest.
RIGEL_KERNEL_BODY int Rounded(int size) {
  return (size + (kKernelPadding - 1)) / kKernelPadding * kKernelPadding;
}

// The rows from `begin` on, at most kBlock of them.
RIGEL_KERNEL_BODY RowArrays BlockAt(const RowArrays& rows, int begin) {
  const int size = rows.size - begin < kBlock ? rows.size - begin : kBlock;
  return RowsFrom(rows, begin, size);
}

// C^2 and the squared norm of its gradient; their quotient is r^2.
template <bool kGeneral>
RIGEL_KERNEL_BODY void NumeratorAndGradient(const RowArrays& p, int i, const double F[9],
                                            double* C2, double* g2) {
  if (kGeneral) {
    const RowTerms t = TermsOf(F, RowAt(p, i));
    *C2 = t.C * t.C;
    *g2 = t.gradient2;
  } else {
    const SampsonTerms t = TermsOf(F, p.x1[i], p.y1[i], p.x2[i], p.y2[i]);
    *C2 = t.C * t.C;
    *g2 = t.gradient2;
  }
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void TruncatedErrors(const RowArrays& block, const double F[9], double t2,
                                       double e[kBlock]) {
  for (int i = 0; i < Rounded(block.size); ++i) {
    double C2, g2;
    NumeratorAndGradient<kGeneral>(block, i, F, &C2, &g2);
    const double r2 = C2 / g2;
    // A NaN fails the comparison and counts t2.
    e[i] = r2 < t2 ? r2 : t2;
  }
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void Errors(const RowArrays& block, const double F[9], double e[kBlock]) {
  for (int i = 0; i < Rounded(block.size); ++i) {
    double C2, g2;
    NumeratorAndGradient<kGeneral>(block, i, F, &C2, &g2);
    const double r2 = C2 / g2;
    e[i] = g2 > 0 ? r2 : std::numeric_limits<double>::infinity();
  }
}

// The terms of match k for the row-major rotation R and the baseline b.
RIGEL_KERNEL_BODY DepthTerms TermsOfMatch(const RayArrays& rays, int k, const double R[9],
                                          const double b[3]) {
  const double x = rays.x1[k], y = rays.y1[k], z = rays.z1[k];
  return DepthTermsOf(R[0] * x + R[1] * y + R[2] * z, R[3] * x + R[4] * y + R[5] * z,
                      R[6] * x + R[7] * y + R[8] * z, rays.x2[k], rays.y2[k], rays.z2[k], b[0],
                      b[1], b[2]);
}

// Sets e to t2 where the match at begin + i lies behind a camera.
RIGEL_KERNEL_BODY void RejectBehind(const RayArrays& rays, int begin, int size,
                                    const GroupMotion& m, double t2, double e[kBlock]) {
  for (int i = 0; i < Rounded(size); ++i) {
    const DepthTerms depth = TermsOfMatch(rays, begin + i, m.R, m.b);
    const double error = e[i];
    double kept = depth.n1 > 0 ? error : t2;
    kept = depth.n2 > 0 ? kept : t2;
    // A NaN of sin2 is undecided.
    e[i] = depth.sin2 > m.min_sin2 ? kept : error;
  }
}

// `rays` and `motion` are null where depths are not looked at.
template <bool kGeneral>
RIGEL_KERNEL_BODY double Sum(const RowArrays& rows, const RayArrays* rays, const double F[9],
                             const GroupMotion* motion, double t2, double bound, double sum,
                             int* num_inliers) {
  int inliers = 0;
  for (int begin = 0; begin < rows.size && !(sum > bound); begin += kBlock) {
    const RowArrays block = BlockAt(rows, begin);
    double e[kBlock];
    TruncatedErrors<kGeneral>(block, F, t2, e);
    if (rays != nullptr) RejectBehind(*rays, begin, block.size, *motion, t2, e);
    // What is not there counts as an outlier, and then adds nothing.
    for (int i = block.size; i < kBlock; ++i) e[i] = t2;
    if (num_inliers != nullptr) {
      int count = 0;
      for (int i = 0; i < kBlock; ++i) count += e[i] < t2 ? 1 : 0;
      inliers += count;
    }
    for (int i = block.size; i < kBlock; ++i) e[i] = 0.0;
    static_assert(kBlock == 8 * kLanes, "the sum is over eight vectors");
    const Lanes even = (LanesAt(e) + LanesAt(e + 16)) + (LanesAt(e + 8) + LanesAt(e + 24));
    const Lanes odd = (LanesAt(e + 4) + LanesAt(e + 20)) + (LanesAt(e + 12) + LanesAt(e + 28));
    sum += SumOf(even + odd);
  }
  if (num_inliers != nullptr) *num_inliers += inliers;
  return sum;
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void AllErrors(const RowArrays& rows, const double F[9], double* squared_errors) {
  for (int begin = 0; begin < rows.size; begin += kBlock) {
    const RowArrays block = BlockAt(rows, begin);
    double e[kBlock];
    Errors<kGeneral>(block, F, e);
    for (int i = 0; i < block.size; ++i) squared_errors[begin + i] = e[i];
  }
}

template <bool kGeneral>
RIGEL_KERNEL_BODY int Select(const RowArrays& rows, const RayArrays& rays, const double F[9],
                             const GroupMotion& motion, double t2, double* squared_errors,
                             char* inliers) {
  int total = 0;
  for (int begin = 0; begin < rows.size; begin += kBlock) {
    const RowArrays block = BlockAt(rows, begin);
    double e[kBlock];
    Errors<kGeneral>(block, F, e);
    for (int i = 0; i < block.size; ++i) squared_errors[begin + i] = e[i];
    RejectBehind(rays, begin, block.size, motion, t2, e);
    int count = 0;
    for (int i = 0; i < block.size; ++i) {
      const bool inlier = e[i] < t2;
      inliers[begin + i] = inlier ? 1 : 0;
      count += inlier ? 1 : 0;
    }
    total += count;
  }
  return total;
}

RIGEL_KERNEL_BODY void AllParallax(const RayArrays& rays, const double R[9], int size,
                                   double* sin2) {
  const double no_baseline[3] = {0.0, 0.0, 0.0};
  for (int k = 0; k < size; ++k) sin2[k] = TermsOfMatch(rays, k, R, no_baseline).sin2;
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void Count(const RowArrays& rows, const RayArrays& rays, const double F[9],
                             const GroupMotion& motion, double t2, DepthCounts* counts) {
  int in_front = 0, behind = 0, decided = 0;
  for (int begin = 0; begin < rows.size; begin += kBlock) {
    const RowArrays block = BlockAt(rows, begin);
    double e[kBlock], sign1[kBlock], sign2[kBlock];
    Errors<kGeneral>(block, F, e);
    for (int i = 0; i < Rounded(block.size); ++i) {
      const DepthTerms depth = TermsOfMatch(rays, begin + i, motion.R, motion.b);
      sign1[i] = depth.n1;
      sign2[i] = depth.n2;
      e[i] = depth.sin2 > motion.min_sin2 ? e[i] : t2;
    }
    for (int i = 0; i < block.size; ++i) {
      // All are set above, for Rounded(size) of them.
      // NOLINTBEGIN(clang-analyzer-core.UndefinedBinaryOperatorResult)
      const int one = e[i] < t2 ? 1 : 0;
      decided += one;
      in_front += sign1[i] > 0 && sign2[i] > 0 ? one : 0;
      behind += sign1[i] < 0 && sign2[i] < 0 ? one : 0;
      // NOLINTEND(clang-analyzer-core.UndefinedBinaryOperatorResult)
    }
  }
  counts->in_front += in_front;
  counts->behind += behind;
  counts->decided += decided;
}

#if RIGEL_HAS_AVX2_PATH
RIGEL_TARGET_AVX2 void AllParallaxAvx2(const RayArrays& rays, const double R[9], int size,
                                       double* sin2) {
  AllParallax(rays, R, size, sin2);
}

RIGEL_TARGET_AVX2 void CountAvx2(const RowArrays& rows, const RayArrays& rays, const double F[9],
                                 const GroupMotion& motion, double t2, DepthCounts* counts) {
  if (rows.general != nullptr) {
    Count<true>(rows, rays, F, motion, t2, counts);
  } else {
    Count<false>(rows, rays, F, motion, t2, counts);
  }
}

RIGEL_TARGET_AVX2 double SumAvx2(const RowArrays& rows, const double F[9], double t2, double bound,
                                 double sum, int* num_inliers) {
  return rows.general != nullptr
             ? Sum<true>(rows, nullptr, F, nullptr, t2, bound, sum, num_inliers)
             : Sum<false>(rows, nullptr, F, nullptr, t2, bound, sum, num_inliers);
}

RIGEL_TARGET_AVX2 double SumInFrontAvx2(const RowArrays& rows, const RayArrays& rays,
                                        const double F[9], const GroupMotion& motion, double t2,
                                        double bound, double sum, int* num_inliers) {
  return rows.general != nullptr ? Sum<true>(rows, &rays, F, &motion, t2, bound, sum, num_inliers)
                                 : Sum<false>(rows, &rays, F, &motion, t2, bound, sum, num_inliers);
}

RIGEL_TARGET_AVX2 void AllErrorsAvx2(const RowArrays& rows, const double F[9],
                                     double* squared_errors) {
  if (rows.general != nullptr) {
    AllErrors<true>(rows, F, squared_errors);
  } else {
    AllErrors<false>(rows, F, squared_errors);
  }
}

RIGEL_TARGET_AVX2 int SelectAvx2(const RowArrays& rows, const RayArrays& rays, const double F[9],
                                 const GroupMotion& motion, double t2, double* squared_errors,
                                 char* inliers) {
  return rows.general != nullptr
             ? Select<true>(rows, rays, F, motion, t2, squared_errors, inliers)
             : Select<false>(rows, rays, F, motion, t2, squared_errors, inliers);
}
#endif

}  // namespace

double TruncatedSampsonSum(const RowArrays& rows, const double F[9], double t2, double bound,
                           double sum, int* num_inliers, [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return SumAvx2(rows, F, t2, bound, sum, num_inliers);
#endif
  return rows.general != nullptr
             ? Sum<true>(rows, nullptr, F, nullptr, t2, bound, sum, num_inliers)
             : Sum<false>(rows, nullptr, F, nullptr, t2, bound, sum, num_inliers);
}

double TruncatedSampsonSumInFront(const RowArrays& rows, const RayArrays& rays, const double F[9],
                                  const GroupMotion& motion, double t2, double bound, double sum,
                                  int* num_inliers, [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) {
    return SumInFrontAvx2(rows, rays, F, motion, t2, bound, sum, num_inliers);
  }
#endif
  return rows.general != nullptr ? Sum<true>(rows, &rays, F, &motion, t2, bound, sum, num_inliers)
                                 : Sum<false>(rows, &rays, F, &motion, t2, bound, sum, num_inliers);
}

void SquaredSampsonErrors(const RowArrays& rows, const double F[9], double* squared_errors,
                          [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return AllErrorsAvx2(rows, F, squared_errors);
#endif
  if (rows.general != nullptr) {
    AllErrors<true>(rows, F, squared_errors);
  } else {
    AllErrors<false>(rows, F, squared_errors);
  }
}

int SelectInFront(const RowArrays& rows, const RayArrays& rays, const double F[9],
                  const GroupMotion& motion, double t2, double* squared_errors, char* inliers,
                  [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) {
    return SelectAvx2(rows, rays, F, motion, t2, squared_errors, inliers);
  }
#endif
  return rows.general != nullptr
             ? Select<true>(rows, rays, F, motion, t2, squared_errors, inliers)
             : Select<false>(rows, rays, F, motion, t2, squared_errors, inliers);
}

void SquaredParallax(const RayArrays& rays, const double R[9], int size, double* sin2,
                     [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return AllParallaxAvx2(rays, R, size, sin2);
#endif
  AllParallax(rays, R, size, sin2);
}

void CountDepths(const RowArrays& rows, const RayArrays& rays, const double F[9],
                 const GroupMotion& motion, double t2, DepthCounts* counts,
                 [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return CountAvx2(rows, rays, F, motion, t2, counts);
#endif
  if (rows.general != nullptr) {
    Count<true>(rows, rays, F, motion, t2, counts);
  } else {
    Count<false>(rows, rays, F, motion, t2, counts);
  }
}

}  // namespace rigel
