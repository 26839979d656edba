// The inner loop of RANSAC: squared Sampson errors of many matches under one fundamental matrix.
//
// Plain loops over structure-of-arrays data, in a file of their own.
#ifndef RIGEL_MINIMAL_SCORE_KERNEL_H_
#define RIGEL_MINIMAL_SCORE_KERNEL_H_

namespace rigel {

// Matches of one camera pair in centred pixels (epipolar.h): (x1, y1) at time 1, (x2, y2) at
// time 2.
struct PixelArrays {
  const double* x1;
  const double* y1;
  const double* x2;
  const double* y2;
  int size;
};

// sum min(r^2, t2) over the matches, where r is the Sampson error in pixels under the row-major
// centred fundamental matrix F; `num_inliers` grows by the number of matches with r^2 < t2. Stops
// early, with a sum above `bound`, once the sum exceeds `bound`. A match with r = 0/0 (F = 0, an
// epipole) counts t2.
double TruncatedSampsonSum(const PixelArrays& pixels, const double F[9], double t2, double bound,
                           int* num_inliers);

// Squared Sampson errors one by one; infinite where r = 0/0.
void SquaredSampsonErrors(const PixelArrays& pixels, const double F[9], double* squared_errors);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SCORE_KERNEL_H_
