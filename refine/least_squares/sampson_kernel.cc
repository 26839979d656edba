#include "rigel/refine/least_squares/sampson_kernel.h"

// Not <cmath>: its inline functions could be shared with code for other processors.
#include <math.h>  // NOLINT(modernize-deprecated-headers)

#include "rigel/core/kernel_lanes.h"
#include "rigel/core/sampson_terms.h"

// Plain loops and sums of vectors of a fixed width, see cpu_path.h.
namespace rigel {
namespace {

// Long enough for g++ to keep the loops, which it vectorizes.
constexpr int kBlock = 64;
constexpr int kEntries = 9;  // of F

// J = de/dF up to a factor f of the match, which enters by its square: products of rows need no
// square root of it.
struct Rows {
  double row[kEntries - 1][kBlock];  // J / f; its last entry is 1
  double weight[kBlock];             // f^2 h
  double residual[kBlock];           // f rho' e
  double rho[kBlock];                // kCauchy: 1 + s / scale^2
};

// Rounded up to whole vectors, so that no loop ends with single matches.
RIGEL_KERNEL_BODY int WholeLanes(int size) {
  return (size + (kKernelPadding - 1)) & ~(kKernelPadding - 1);
}

// The loss at s: its value rho (for kCauchy the argument of the logarithm), rho', and
// 1 + 2 s rho'' / rho', the factor of the curvature in Newton's method.
RIGEL_KERNEL_BODY void Loss(LossKind kind, double c, double c2, double s, double* rho,
                            double* slope, double* newton) {
  switch (kind) {
    case LossKind::kNone:
      *rho = s;
      *slope = 1.0;
      *newton = 1.0;
      break;
    case LossKind::kHuber: {
      const double root = sqrt(s);
      const bool inside = s <= c2;
      *rho = inside ? s : 2.0 * c * root - c2;
      *slope = inside ? 1.0 : c / root;
      *newton = inside ? 1.0 : 0.0;
      break;
    }
    case LossKind::kCauchy: {
      const double u = 1.0 + s / c2;
      *rho = u;
      *slope = 1.0 / u;
      *newton = 2.0 / u - 1.0;  // (1 - s/c2) / (1 + s/c2)
      break;
    }
    case LossKind::kTukey: {
      const double v = 1.0 - s / c2;
      const double u = v > 0.0 ? v : 0.0;
      *rho = c2 / 3.0 * (1.0 - u * u * u);
      *slope = u * u;
      // rho'' / rho' = -2 / (c2 u).
      *newton = u > 0.25 ? 1.0 - 4.0 * (s / c2) / (u > 0.25 ? u : 1.0) : 0.0;
      break;
    }
    case LossKind::kTruncated:
      *rho = s <= c2 ? s : c2;
      *slope = s <= c2 ? 1.0 : 0.0;
      *newton = 1.0;
      break;
  }
}

// Fills `rows` for the block: rho, and with `derivatives` the rest.
RIGEL_KERNEL_BODY void Linearize(LossKind kind, bool derivatives, double c, const PixelArrays& p,
                                 const double* weights, int begin, int size, const double F[9],
                                 double rounding2, Rows* rows) {
  const double c2 = c * c;
  constexpr double kMinNewton = 1.0 / 3.0;
  for (int i = 0; i < size; ++i) {
    const double x1 = p.x1[begin + i], y1 = p.y1[begin + i];
    const double x2 = p.x2[begin + i], y2 = p.y2[begin + i];
    const SampsonTerms t = TermsOf(F, x1, y1, x2, y2);
    const double floor2 = rounding2 * (((x1 * x1 + y1 * y1) + (x2 * x2 + y2 * y2)) + 2.0);
    // Also false for NaN; infinity would give zero weight below.
    const bool regular = t.gradient2 > floor2;
    const double inverse2 = 1.0 / (regular ? t.gradient2 : 1.0);
    const double w = regular ? weights[i] : 0.0;
    const double f2 = (w * w) * inverse2;
    double rho, slope, newton;
    Loss(kind, c, c2, f2 * (t.C * t.C), &rho, &slope, &newton);
    rows->rho[i] = rho;
    if (!derivatives) continue;
    const double fg = f2 * slope;
    const double fh = fg * (newton > kMinNewton ? newton : 1.0);
    // de/dF = f (u p1' - v b'), where the third entry of b counts as zero.
    const double m = t.C * inverse2;
    const double u0 = x2 - m * t.a0;
    const double u1 = y2 - m * t.a1;
    const double v0 = m * x2;
    const double v1 = m * y2;
    rows->row[0][i] = u0 * x1 - v0 * t.b0;
    rows->row[1][i] = u0 * y1 - v0 * t.b1;
    rows->row[2][i] = u0;
    rows->row[3][i] = u1 * x1 - v1 * t.b0;
    rows->row[4][i] = u1 * y1 - v1 * t.b1;
    rows->row[5][i] = u1;
    rows->row[6][i] = x1 - m * t.b0;
    rows->row[7][i] = y1 - m * t.b1;
    rows->weight[i] = fh;
    rows->residual[i] = fg * t.C;
  }
}

RIGEL_KERNEL_BODY double SumRho(LossKind kind, double c, const double* rho, int size) {
  if (kind != LossKind::kCauchy) {
    Lanes sum = {};
    for (int i = 0; i < size; i += kLanes) sum += LanesAt(rho + i);
    return SumOf(sum);
  }
  // One logarithm for the product of eight: of more it could overflow.
  Lanes low = LanesAt(rho), high = LanesAt(rho + kLanes);
  for (int i = 2 * kLanes; i < size; i += 2 * kLanes) {
    low *= LanesAt(rho + i);
    high *= LanesAt(rho + kLanes + i);
  }
  double sum = 0.0;
  for (int l = 0; l < kLanes; ++l) sum += log(low[l]) + log(high[l]);
  return c * c * sum;
}

struct Accumulated {
  double cost;
  Lanes g[kEntries];
  Lanes H[kEntries][kEntries];  // the lower triangle
};

// Adds the first kRow + 1 entries of row kRow of H, and its entry in the last column.
template <int kRow>
RIGEL_KERNEL_BODY void AddRow(const Rows& rows, int size, Accumulated* sums) {
  Lanes sum[kRow + 1];
  for (Lanes& s : sum) s = Lanes{};
  Lanes last = {};
  for (int i = 0; i < size; i += kLanes) {
    const Lanes weighted = LanesAt(rows.weight + i) * LanesAt(rows.row[kRow] + i);
    for (int k = 0; k <= kRow; ++k) sum[k] += LanesAt(rows.row[k] + i) * weighted;
    last += weighted;
  }
  for (int k = 0; k <= kRow; ++k) sums->H[kRow][k] += sum[k];
  sums->H[8][kRow] += last;
}

RIGEL_KERNEL_BODY void AddGradient(const Rows& rows, int size, Accumulated* sums) {
  Lanes sum[kEntries];
  for (Lanes& s : sum) s = Lanes{};
  Lanes weight = {};
  for (int i = 0; i < size; i += kLanes) {
    const Lanes residual = LanesAt(rows.residual + i);
    for (int k = 0; k < kEntries - 1; ++k) sum[k] += LanesAt(rows.row[k] + i) * residual;
    sum[8] += residual;
    weight += LanesAt(rows.weight + i);
  }
  for (int k = 0; k < kEntries; ++k) sums->g[k] += sum[k];
  sums->H[8][8] += weight;
}

RIGEL_KERNEL_BODY void AddRowsBody(const Rows& rows, int size, Accumulated* sums) {
  AddRow<0>(rows, size, sums);
  AddRow<1>(rows, size, sums);
  AddRow<2>(rows, size, sums);
  AddRow<3>(rows, size, sums);
  AddRow<4>(rows, size, sums);
  AddRow<5>(rows, size, sums);
  AddRow<6>(rows, size, sums);
  AddRow<7>(rows, size, sums);
  AddGradient(rows, size, sums);
}

// Separate functions, so that the sums of a loop stay in registers.
using AddRowsFunction = void(const Rows& rows, int size, Accumulated* sums);
__attribute__((noinline)) void AddGradientAlone(const Rows& rows, int size, Accumulated* sums) {
  AddGradient(rows, size, sums);
}
RIGEL_TARGET_AVX2 __attribute__((noinline)) void AddGradientAloneAvx2(const Rows& rows, int size,
                                                                      Accumulated* sums) {
  AddGradient(rows, size, sums);
}
__attribute__((noinline)) void AddRows(const Rows& rows, int size, Accumulated* sums) {
  AddRowsBody(rows, size, sums);
}
RIGEL_TARGET_AVX2 __attribute__((noinline)) void AddRowsAvx2(const Rows& rows, int size,
                                                             Accumulated* sums) {
  AddRowsBody(rows, size, sums);
}

// Adds matches begin to begin + size. A size that the compiler knows makes faster loops.
RIGEL_KERNEL_BODY void AddBlock(LossKind kind, bool derivatives, double c,
                                const PixelArrays& pixels, const double* weights, int begin,
                                int size, const double F[9], double rounding2,
                                AddRowsFunction* add_rows, Accumulated* sum) {
  Rows rows;
  Linearize(kind, derivatives, c, pixels, weights, begin, size, F, rounding2, &rows);
  sum->cost += SumRho(kind, c, rows.rho, size);
  if (!derivatives) return;
  add_rows(rows, size, sum);
}

// The weights of the last `size` matches, filled up to whole lanes with zeros; returns their
// number.
RIGEL_KERNEL_BODY int FillUp(const double* weights, int size, double filled[kBlock]) {
  const int whole = WholeLanes(size);
  for (int i = 0; i < size; ++i) filled[i] = weights[i];
  for (int i = size; i < whole; ++i) filled[i] = 0.0;
  return whole;
}

RIGEL_KERNEL_BODY void Sum(LossKind kind, bool derivatives, double c, const PixelArrays& pixels,
                           const double* weights, const double F[9], double rounding2,
                           AddRowsFunction* add_rows, SampsonSums* sums) {
  Accumulated sum;
  sum.cost = 0.0;
  for (int i = 0; i < kEntries; ++i) {
    sum.g[i] = Lanes{};
    for (int j = 0; j <= i; ++j) sum.H[i][j] = Lanes{};
  }
  int begin = 0;
  for (; begin + kBlock <= pixels.size; begin += kBlock) {
    AddBlock(kind, derivatives, c, pixels, weights + begin, begin, kBlock, F, rounding2, add_rows,
             &sum);
  }
  if (begin < pixels.size) {
    double rest[kBlock];
    const int whole = FillUp(weights + begin, pixels.size - begin, rest);
    AddBlock(kind, derivatives, c, pixels, rest, begin, whole, F, rounding2, add_rows, &sum);
  }
  sums->cost = 0.5 * sum.cost;
  if (!derivatives) return;
  for (int i = 0; i < kEntries; ++i) {
    sums->g[i] = SumOf(sum.g[i]);
    for (int j = 0; j <= i; ++j) sums->H[9 * i + j] = sums->H[9 * j + i] = SumOf(sum.H[i][j]);
  }
}

// One copy of the loops for each loss, so that none has a branch in it.
RIGEL_KERNEL_BODY void Dispatch(const SampsonKernelOptions& options, SampsonParts parts,
                                const PixelArrays& pixels, const double* weights, const double F[9],
                                double rounding2, AddRowsFunction* add_rows,
                                AddRowsFunction* add_gradient, SampsonSums* sums) {
  const double c = options.loss_scale;
  const bool derivatives = parts != SampsonParts::kCost;
  AddRowsFunction* add = parts == SampsonParts::kAll ? add_rows : add_gradient;
#define RIGEL_SUM(kind)                                              \
  case kind:                                                         \
    if (derivatives) {                                               \
      Sum(kind, true, c, pixels, weights, F, rounding2, add, sums);  \
    } else {                                                         \
      Sum(kind, false, c, pixels, weights, F, rounding2, add, sums); \
    }                                                                \
    break
  switch (options.loss) {
    RIGEL_SUM(LossKind::kNone);
    RIGEL_SUM(LossKind::kHuber);
    RIGEL_SUM(LossKind::kCauchy);
    RIGEL_SUM(LossKind::kTukey);
    RIGEL_SUM(LossKind::kTruncated);
  }
#undef RIGEL_SUM
}

// Lower triangle of C, with the entries off the diagonal doubled.
struct QuadraticForm {
  double q[kEntries][kEntries];
};

RIGEL_KERNEL_BODY void BlockLeverages(const PixelArrays& pixels, const double* weights, int begin,
                                      int size, const double F[9], const QuadraticForm& form,
                                      double rounding2, double* leverages) {
  Rows rows;
  Linearize(LossKind::kNone, true, 1.0, pixels, weights, begin, size, F, rounding2, &rows);
  for (int i = 0; i < size; i += kLanes) {
    Lanes row[kEntries];
    for (int k = 0; k < kEntries - 1; ++k) row[k] = LanesAt(rows.row[k] + i);
    row[8] = Lanes{} + 1.0;
    Lanes sum = {};
    for (int k = 0; k < kEntries; ++k) {
      Lanes product = {};
      for (int j = 0; j <= k; ++j) product += form.q[k][j] * row[j];
      sum += product * row[k];
    }
    const Lanes leverage = sum * LanesAt(rows.weight + i);
    for (int m = 0; m < kLanes; ++m) leverages[i + m] = leverage[m];
  }
}

RIGEL_KERNEL_BODY void Leverages(const PixelArrays& pixels, const double* weights,
                                 const double F[9], const double C[81], double rounding2,
                                 double* leverages) {
  QuadraticForm form;
  for (int k = 0; k < kEntries; ++k) {
    for (int j = 0; j < k; ++j) form.q[k][j] = C[9 * k + j] + C[9 * j + k];
    form.q[k][k] = C[10 * k];
  }
  int begin = 0;
  for (; begin + kBlock <= pixels.size; begin += kBlock) {
    BlockLeverages(pixels, weights + begin, begin, kBlock, F, form, rounding2, leverages + begin);
  }
  if (begin < pixels.size) {
    double rest[kBlock], last[kBlock];
    const int whole = FillUp(weights + begin, pixels.size - begin, rest);
    BlockLeverages(pixels, rest, begin, whole, F, form, rounding2, last);
    for (int i = begin; i < pixels.size; ++i) leverages[i] = last[i - begin];
  }
}

RIGEL_KERNEL_BODY void GradientWeightsBody(const PixelArrays& pixels, const double F[9],
                                           double floor2, double* weights) {
  for (int i = 0; i < pixels.size; ++i) {
    const double gradient2 =
        TermsOf(F, pixels.x1[i], pixels.y1[i], pixels.x2[i], pixels.y2[i]).gradient2;
    const double weight = gradient2 / (gradient2 + floor2);
    weights[i] = gradient2 > 0.0 ? weight : 0.0;
  }
}

RIGEL_KERNEL_BODY void AddProjectedBody(const SampsonSums& sums, const FundamentalDerivatives& D,
                                        double* gradient, double* curvature) {
  // D'H D = sum d_i' (sum H_ij d_j) over the rows d of D, each of two times kLanes numbers.
  Lanes HD[kEntries][2], g[2] = {};
  for (int i = 0; i < kEntries; ++i) {
    Lanes low = {}, high = {};
    for (int j = 0; j < kEntries; ++j) {
      low += sums.H[9 * i + j] * LanesAt(D.d[j]);
      high += sums.H[9 * i + j] * LanesAt(D.d[j] + kLanes);
    }
    HD[i][0] = low;
    HD[i][1] = high;
    g[0] += sums.g[i] * LanesAt(D.d[i]);
    g[1] += sums.g[i] * LanesAt(D.d[i] + kLanes);
  }
  for (int a = 0; a < 6; ++a) gradient[a] += g[a / kLanes][a % kLanes];
  for (int a = 0; a < 6; ++a) {
    Lanes low = {}, high = {};
    for (int i = 0; i < kEntries; ++i) {
      low += D.d[i][a] * HD[i][0];
      high += D.d[i][a] * HD[i][1];
    }
    for (int m = 0; m < kLanes; ++m) curvature[6 * a + m] += low[m];
    for (int m = kLanes; m < 6; ++m) curvature[6 * a + m] += high[m - kLanes];
  }
}

RIGEL_TARGET_AVX2 void AddProjectedAvx2(const SampsonSums& sums, const FundamentalDerivatives& D,
                                        double* gradient, double* curvature) {
  AddProjectedBody(sums, D, gradient, curvature);
}

RIGEL_TARGET_AVX2 void SumAvx2(const SampsonKernelOptions& options, SampsonParts parts,
                               const PixelArrays& pixels, const double* weights, const double F[9],
                               double rounding2, SampsonSums* sums) {
  Dispatch(options, parts, pixels, weights, F, rounding2, AddRowsAvx2, AddGradientAloneAvx2, sums);
}

RIGEL_TARGET_AVX2 void LeveragesAvx2(const PixelArrays& pixels, const double* weights,
                                     const double F[9], const double C[81], double rounding2,
                                     double* leverages) {
  Leverages(pixels, weights, F, C, rounding2, leverages);
}

RIGEL_TARGET_AVX2 void GradientWeightsAvx2(const PixelArrays& pixels, const double F[9],
                                           double floor2, double* weights) {
  GradientWeightsBody(pixels, F, floor2, weights);
}

}  // namespace

void SumSampson(const SampsonKernelOptions& options, const PixelArrays& pixels,
                const double* weights, const double F[9], double rounding2, SampsonParts parts,
                SampsonSums* sums, CpuPath path) {
  if (path == CpuPath::kAvx2) {
    SumAvx2(options, parts, pixels, weights, F, rounding2, sums);
  } else {
    Dispatch(options, parts, pixels, weights, F, rounding2, AddRows, AddGradientAlone, sums);
  }
}

void AddProjected(const SampsonSums& sums, const FundamentalDerivatives& D, double* gradient,
                  double* curvature, CpuPath path) {
  if (path == CpuPath::kAvx2) {
    AddProjectedAvx2(sums, D, gradient, curvature);
  } else {
    AddProjectedBody(sums, D, gradient, curvature);
  }
}

void SampsonLeverages(const PixelArrays& pixels, const double* weights, const double F[9],
                      const double C[81], double rounding2, double* leverages, CpuPath path) {
  if (path == CpuPath::kAvx2) {
    LeveragesAvx2(pixels, weights, F, C, rounding2, leverages);
  } else {
    Leverages(pixels, weights, F, C, rounding2, leverages);
  }
}

void GradientWeights(const PixelArrays& pixels, const double F[9], double floor2, double* weights,
                     CpuPath path) {
  if (path == CpuPath::kAvx2) {
    GradientWeightsAvx2(pixels, F, floor2, weights);
  } else {
    GradientWeightsBody(pixels, F, floor2, weights);
  }
}

}  // namespace rigel
