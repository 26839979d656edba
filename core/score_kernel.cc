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

// The matches from `begin` on, at most kBlock of them.
RIGEL_KERNEL_BODY PixelArrays BlockAt(const PixelArrays& p, int begin) {
  const int size = p.size - begin < kBlock ? p.size - begin : kBlock;
  return {p.x1 + begin, p.y1 + begin, p.x2 + begin, p.y2 + begin, size};
}

// C^2 and the squared norm of its gradient; their quotient is r^2.
RIGEL_KERNEL_BODY void NumeratorAndGradient(const PixelArrays& p, int i, const double F[9],
                                            double* C2, double* g2) {
  const SampsonTerms t = TermsOf(F, p.x1[i], p.y1[i], p.x2[i], p.y2[i]);
  *C2 = t.C * t.C;
  *g2 = t.gradient2;
}

RIGEL_KERNEL_BODY void TruncatedErrors(const PixelArrays& block, const double F[9], double t2,
                                       double e[kBlock]) {
  for (int i = 0; i < Rounded(block.size); ++i) {
    double C2, g2;
    NumeratorAndGradient(block, i, F, &C2, &g2);
    const double r2 = C2 / g2;
    // A NaN fails the comparison and counts t2.
    e[i] = r2 < t2 ? r2 : t2;
  }
}

RIGEL_KERNEL_BODY void Errors(const PixelArrays& block, const double F[9], double e[kBlock]) {
  for (int i = 0; i < Rounded(block.size); ++i) {
    double C2, g2;
    NumeratorAndGradient(block, i, F, &C2, &g2);
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
RIGEL_KERNEL_BODY double Sum(const PixelArrays& pixels, const RayArrays* rays, const double F[9],
                             const GroupMotion* motion, double t2, double bound, double sum,
                             int* num_inliers) {
  int inliers = 0;
  for (int begin = 0; begin < pixels.size && !(sum > bound); begin += kBlock) {
    const PixelArrays block = BlockAt(pixels, begin);
    double e[kBlock];
    TruncatedErrors(block, F, t2, e);
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

RIGEL_KERNEL_BODY void AllErrors(const PixelArrays& pixels, const double F[9],
                                 double* squared_errors) {
  for (int begin = 0; begin < pixels.size; begin += kBlock) {
    const PixelArrays block = BlockAt(pixels, begin);
    double e[kBlock];
    Errors(block, F, e);
    for (int i = 0; i < block.size; ++i) squared_errors[begin + i] = e[i];
  }
}

RIGEL_KERNEL_BODY int Select(const PixelArrays& pixels, const RayArrays& rays, const double F[9],
                             const GroupMotion& motion, double t2, double* squared_errors,
                             char* inliers) {
  int total = 0;
  for (int begin = 0; begin < pixels.size; begin += kBlock) {
    const PixelArrays block = BlockAt(pixels, begin);
    double e[kBlock];
    Errors(block, F, e);
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

RIGEL_KERNEL_BODY void Count(const PixelArrays& pixels, const RayArrays& rays, const double F[9],
                             const GroupMotion& motion, double t2, DepthCounts* counts) {
  int in_front = 0, behind = 0, decided = 0;
  for (int begin = 0; begin < pixels.size; begin += kBlock) {
    const PixelArrays block = BlockAt(pixels, begin);
    double e[kBlock], sign1[kBlock], sign2[kBlock];
    Errors(block, F, e);
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

RIGEL_TARGET_AVX2 void CountAvx2(const PixelArrays& pixels, const RayArrays& rays,
                                 const double F[9], const GroupMotion& motion, double t2,
                                 DepthCounts* counts) {
  Count(pixels, rays, F, motion, t2, counts);
}

RIGEL_TARGET_AVX2 double SumAvx2(const PixelArrays& pixels, const double F[9], double t2,
                                 double bound, double sum, int* num_inliers) {
  return Sum(pixels, nullptr, F, nullptr, t2, bound, sum, num_inliers);
}

RIGEL_TARGET_AVX2 double SumInFrontAvx2(const PixelArrays& pixels, const RayArrays& rays,
                                        const double F[9], const GroupMotion& motion, double t2,
                                        double bound, double sum, int* num_inliers) {
  return Sum(pixels, &rays, F, &motion, t2, bound, sum, num_inliers);
}

RIGEL_TARGET_AVX2 void AllErrorsAvx2(const PixelArrays& pixels, const double F[9],
                                     double* squared_errors) {
  AllErrors(pixels, F, squared_errors);
}

RIGEL_TARGET_AVX2 int SelectAvx2(const PixelArrays& pixels, const RayArrays& rays,
                                 const double F[9], const GroupMotion& motion, double t2,
                                 double* squared_errors, char* inliers) {
  return Select(pixels, rays, F, motion, t2, squared_errors, inliers);
}
#endif

}  // namespace

double TruncatedSampsonSum(const PixelArrays& pixels, const double F[9], double t2, double bound,
                           double sum, int* num_inliers, [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return SumAvx2(pixels, F, t2, bound, sum, num_inliers);
#endif
  return Sum(pixels, nullptr, F, nullptr, t2, bound, sum, num_inliers);
}

double TruncatedSampsonSumInFront(const PixelArrays& pixels, const RayArrays& rays,
                                  const double F[9], const GroupMotion& motion, double t2,
                                  double bound, double sum, int* num_inliers,
                                  [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) {
    return SumInFrontAvx2(pixels, rays, F, motion, t2, bound, sum, num_inliers);
  }
#endif
  return Sum(pixels, &rays, F, &motion, t2, bound, sum, num_inliers);
}

void SquaredSampsonErrors(const PixelArrays& pixels, const double F[9], double* squared_errors,
                          [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return AllErrorsAvx2(pixels, F, squared_errors);
#endif
  AllErrors(pixels, F, squared_errors);
}

int SelectInFront(const PixelArrays& pixels, const RayArrays& rays, const double F[9],
                  const GroupMotion& motion, double t2, double* squared_errors, char* inliers,
                  [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) {
    return SelectAvx2(pixels, rays, F, motion, t2, squared_errors, inliers);
  }
#endif
  return Select(pixels, rays, F, motion, t2, squared_errors, inliers);
}

void SquaredParallax(const RayArrays& rays, const double R[9], int size, double* sin2,
                     [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return AllParallaxAvx2(rays, R, size, sin2);
#endif
  AllParallax(rays, R, size, sin2);
}

void CountDepths(const PixelArrays& pixels, const RayArrays& rays, const double F[9],
                 const GroupMotion& motion, double t2, DepthCounts* counts,
                 [[maybe_unused]] CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  if (path == CpuPath::kAvx2) return CountAvx2(pixels, rays, F, motion, t2, counts);
#endif
  Count(pixels, rays, F, motion, t2, counts);
}

}  // namespace rigel
