// The inner loop of the refinement: normal equations of the Sampson errors of one camera pair by
// the nine entries of its fundamental matrix.
//
// The residual of a match depends on the motion only through F. So the sums over the matches need
// no derivative by the motion. H = sum (dr/dF)(dr/dF)' is converted to the normal equations of any
// parameters by dF/d(parameters), once for each camera pair.
#ifndef RIGEL_REFINE_LEAST_SQUARES_SAMPSON_KERNEL_H_
#define RIGEL_REFINE_LEAST_SQUARES_SAMPSON_KERNEL_H_

#include "rigel/core/cpu_path.h"
#include "rigel/core/score_kernel.h"
#include "rigel/refine/least_squares/least_squares.h"

namespace rigel {

// For e = w r, the Sampson error in pixels times the weight of the match, and s = e^2.
struct SampsonSums {
  double cost;  // 1/2 sum rho(s)
  double g[9];  // sum rho'(s) e de/dF, F row by row
  // sum h(s) (de/dF)(de/dF)', full and symmetric. h = rho' + 2 s rho'' (Newton's) where that is
  // above rho'/3, else rho': near the minimum a step leaves next to nothing, and outliers do not
  // make it too long.
  double H[81];
};

// Which of them are wanted: the cost; also the gradient g; also H.
enum class SampsonParts { kCost, kGradient, kAll };

struct SampsonKernelOptions {
  LossKind loss = LossKind::kNone;
  double loss_scale = 1.0;  // pixels, > 0
};

// `F` is the row-major matrix of the camera pair. `weights` has one number for each match; 0
// leaves it out. The rows are read up to a multiple of kKernelPadding, where any finite numbers
// may be. A match whose squared gradient is not above rounding2 (|p1|^2 |J2|^2 + |p2|^2 |J1|^2) / 2
// is at an epipole: its residual and derivative are zero. The bits do not depend on the path.
void SumSampson(const SampsonKernelOptions& options, const RowArrays& matches,
                const double* weights, const double F[9], double rounding2, SampsonParts parts,
                SampsonSums* sums, CpuPath path = BestCpuPath());

// The derivatives of F's entries by six parameters, F row by row; the last two columns are zero.
struct FundamentalDerivatives {
  double d[9][8];
};

// Adds D'g and D'H D for the first six columns of D: `gradient` has 6 entries, `curvature` 36.
void AddProjected(const SampsonSums& sums, const FundamentalDerivatives& D, double* gradient,
                  double* curvature, CpuPath path = BestCpuPath());

// w^2 (dr/dF) C (dr/dF)' of each match: the variance of its residual r because of the error of F. C
// (row-major) is the covariance of F's entries. F, weights, padding and rounding2 as above.
void SampsonLeverages(const RowArrays& matches, const double* weights, const double F[9],
                      const double C[81], double rounding2, double* leverages,
                      CpuPath path = BestCpuPath());

// g^2 / (g^2 + noise2 |J2'F J1|^2), g the gradient of a match by its pixels, J2'F J1 how it changes
// with them: EpipoleWeights() of uncertainty.h.
void GradientWeights(const RowArrays& matches, const double F[9], double noise2, double* weights,
                     CpuPath path = BestCpuPath());

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_SAMPSON_KERNEL_H_
