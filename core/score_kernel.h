// The inner loops of RANSAC: Sampson errors and cheirality of many matches of one camera pair.
//
// Plain loops over structure-of-arrays data, in a file of their own; every path gives the same bits
// (cpu_path.h).
#ifndef RIGEL_CORE_SCORE_KERNEL_H_
#define RIGEL_CORE_SCORE_KERNEL_H_

#include "rigel/core/cpu_path.h"
#include "rigel/core/row_arrays.h"

namespace rigel {

// Unit directions of their rays in the body frames.
struct RayArrays {
  const double* x1;
  const double* y1;
  const double* z1;
  const double* x2;
  const double* y2;
  const double* z2;
};

// What depths of one camera pair depend on.
struct GroupMotion {
  double R[9];            // row-major
  double b[3];            // R s_i + t - s_j, metres
  double min_sin2 = 0.0;  // of the parallax: below it noise decides the depths
};

// Adds sum min(r^2, t2) over the matches to `sum` and returns it. r is the Sampson error in pixels
// under the row-major matrix F of the camera pair. `num_inliers`, unless null, grows by the number
// of matches with r^2 < t2. A match with r = 0/0 (F = 0, an epipole) counts t2. Stops once
// the sum exceeds `bound`. A sum up to `bound` is complete. One above it is a lower limit of the
// complete sum, as no term is negative.
double TruncatedSampsonSum(const RowArrays& rows, const double F[9], double t2, double bound,
                           double sum, int* num_inliers, CpuPath path = BestCpuPath());

// The same, but matches behind a camera count t2 too (TestCheirality() in cheirality.h says kBehind
// or kMixed). The order of the terms is the same, so this sum is never below the one above.
double TruncatedSampsonSumInFront(const RowArrays& rows, const RayArrays& rays, const double F[9],
                                  const GroupMotion& motion, double t2, double bound, double sum,
                                  int* num_inliers, CpuPath path = BestCpuPath());

// Squared Sampson errors one by one; infinite where r = 0/0.
void SquaredSampsonErrors(const RowArrays& rows, const double F[9], double* squared_errors,
                          CpuPath path = BestCpuPath());

// The same errors. `inliers` gets 1 where the error is below t2 and the match does not lie behind a
// camera, else 0. Returns the number of ones.
int SelectInFront(const RowArrays& rows, const RayArrays& rays, const double F[9],
                  const GroupMotion& motion, double t2, double* squared_errors, char* inliers,
                  CpuPath path = BestCpuPath());

// Squared sines of the parallax: of the angle between the rays of each match once the first is
// turned by the row-major rotation R.
void SquaredParallax(const RayArrays& rays, const double R[9], int size, double* sin2,
                     CpuPath path = BestCpuPath());

// Where the matches with r^2 < t2 lie: kInFront, kBehind, and both with kMixed, which are decided.
struct DepthCounts {
  int in_front = 0;
  int behind = 0;
  int decided = 0;
};

// Adds those of a group.
void CountDepths(const RowArrays& rows, const RayArrays& rays, const double F[9],
                 const GroupMotion& motion, double t2, DepthCounts* counts,
                 CpuPath path = BestCpuPath());

}  // namespace rigel

#endif  // RIGEL_CORE_SCORE_KERNEL_H_
