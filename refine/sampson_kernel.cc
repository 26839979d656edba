#include "rigel/refine/sampson_kernel.h"

#include <math.h>

#include "rigel/minimal/sampson_terms.h"

// Plain loops, see cpu_path.h.
namespace rigel {
namespace {

// Long enough for g++ to keep the loops, which it vectorizes; half of it is unrolled into scalars.
constexpr int kBlock = 64;
constexpr int kLanes = 8;
constexpr int kEntries = 9;  // of F

// A block of matches, filled up to whole lanes with matches of weight zero.
struct Block {
  double x1[kBlock], y1[kBlock], x2[kBlock], y2[kBlock], w[kBlock];
};

// J = de/dF up to a factor f of the match, which enters by its square: products of rows need no
// square root of it.
struct Rows {
  double row[kEntries][kBlock];       // J / f
  double weighted[kEntries][kBlock];  // f h J
  double residual[kBlock];            // f rho' e
  double rho[kBlock];                 // kCauchy: 1 + s / scale^2
};

// No loop has a rest of single matches.
RIGEL_KERNEL_BODY int WholeLanes(int size) { return (size + (kLanes - 1)) & ~(kLanes - 1); }

// What the loss makes of s: its value (kCauchy: what the logarithm is taken of), rho', and
// D = 1 + 2 s rho'' / rho', Newton's share of the curvature.
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

// Returns the sum of rho over the block (kCauchy: of what is left of it, see below).
RIGEL_KERNEL_BODY void Linearize(LossKind kind, bool newton_curvature, bool derivatives, double c,
                                 const Block& p, int size, const double F[9], double rounding2,
                                 Rows* rows) {
  const double c2 = c * c;
  constexpr double kMinNewton = 1.0 / 3.0;
  for (int i = 0; i < size; ++i) {
    const double x1 = p.x1[i], y1 = p.y1[i], x2 = p.x2[i], y2 = p.y2[i];
    const SampsonTerms t = TermsOf(F, x1, y1, x2, y2);
    const double floor2 = rounding2 * (((x1 * x1 + y1 * y1) + (x2 * x2 + y2 * y2)) + 2.0);
    // Also false for NaN; infinity would give zero weight below.
    const bool regular = t.gradient2 > floor2;
    const double inverse2 = 1.0 / (regular ? t.gradient2 : 1.0);
    const double w = regular ? p.w[i] : 0.0;
    const double f2 = (w * w) * inverse2;
    double rho, slope, newton;
    Loss(kind, c, c2, f2 * (t.C * t.C), &rho, &slope, &newton);
    rows->rho[i] = rho;
    if (!derivatives) continue;
    const double fg = f2 * slope;
    const double fh = newton_curvature ? fg * (newton > kMinNewton ? newton : 1.0) : fg;
    // de/dF = f (u p1' - v b'), where the third entry of b counts as zero.
    const double m = t.C * inverse2;
    const double u0 = x2 - m * t.a0;
    const double u1 = y2 - m * t.a1;
    const double v0 = m * x2;
    const double v1 = m * y2;
    const double row0 = u0 * x1 - v0 * t.b0;
    const double row1 = u0 * y1 - v0 * t.b1;
    const double row3 = u1 * x1 - v1 * t.b0;
    const double row4 = u1 * y1 - v1 * t.b1;
    const double row6 = x1 - m * t.b0;
    const double row7 = y1 - m * t.b1;
    rows->row[0][i] = row0;
    rows->row[1][i] = row1;
    rows->row[2][i] = u0;
    rows->row[3][i] = row3;
    rows->row[4][i] = row4;
    rows->row[5][i] = u1;
    rows->row[6][i] = row6;
    rows->row[7][i] = row7;
    rows->row[8][i] = 1.0;
    rows->weighted[0][i] = fh * row0;
    rows->weighted[1][i] = fh * row1;
    rows->weighted[2][i] = fh * u0;
    rows->weighted[3][i] = fh * row3;
    rows->weighted[4][i] = fh * row4;
    rows->weighted[5][i] = fh * u1;
    rows->weighted[6][i] = fh * row6;
    rows->weighted[7][i] = fh * row7;
    rows->weighted[8][i] = fh;
    rows->residual[i] = fg * t.C;
  }
}

RIGEL_KERNEL_BODY double Dot(const double* a, const double* b, int size) {
  double lane[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (int i = 0; i < size; i += kLanes) {
    for (int l = 0; l < kLanes; ++l) lane[l] += a[i + l] * b[i + l];
  }
  return ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
}

RIGEL_KERNEL_BODY double SumRho(LossKind kind, double c, const double* rho, int size) {
  if (kind != LossKind::kCauchy) {
    double lane[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int i = 0; i < size; i += kLanes) {
      for (int l = 0; l < kLanes; ++l) lane[l] += rho[i + l];
    }
    return ((lane[0] + lane[4]) + (lane[1] + lane[5])) +
           ((lane[2] + lane[6]) + (lane[3] + lane[7]));
  }
  // One logarithm for the product of eight.
  double product[kLanes];
  for (int l = 0; l < kLanes; ++l) product[l] = rho[l];
  for (int i = kLanes; i < size; i += kLanes) {
    for (int l = 0; l < kLanes; ++l) product[l] *= rho[i + l];
  }
  double sum = 0.0;
  for (int l = 0; l < kLanes; ++l) sum += log(product[l]);
  return c * c * sum;
}

struct Accumulated {
  double cost;
  double g[kEntries];
  double H[45];  // the upper triangle, row by row
};

// Adds matches begin to begin + size. A size that the compiler knows makes faster loops.
RIGEL_KERNEL_BODY void AddBlock(LossKind kind, bool newton, bool derivatives, double c,
                                const PixelArrays& pixels, const double* weights, int begin,
                                int size, const double F[9], double rounding2, Accumulated* sum) {
  Block block;
  Rows rows;
  for (int i = 0; i < size; ++i) block.x1[i] = pixels.x1[begin + i];
  for (int i = 0; i < size; ++i) block.y1[i] = pixels.y1[begin + i];
  for (int i = 0; i < size; ++i) block.x2[i] = pixels.x2[begin + i];
  for (int i = 0; i < size; ++i) block.y2[i] = pixels.y2[begin + i];
  for (int i = 0; i < size; ++i) block.w[i] = weights[begin + i];
  const int whole = WholeLanes(size);
  for (int i = size; i < whole; ++i) {
    block.x1[i] = block.y1[i] = block.x2[i] = block.y2[i] = block.w[i] = 0.0;
  }
  Linearize(kind, newton, derivatives, c, block, whole, F, rounding2, &rows);
  sum->cost += SumRho(kind, c, rows.rho, whole);
  if (!derivatives) return;
  int k = 0;
  for (int i = 0; i < kEntries; ++i) {
    for (int j = i; j < kEntries; ++j) sum->H[k++] += Dot(rows.row[i], rows.weighted[j], whole);
  }
  for (int i = 0; i < kEntries; ++i) sum->g[i] += Dot(rows.row[i], rows.residual, whole);
}

RIGEL_KERNEL_BODY void Sum(LossKind kind, bool newton, bool derivatives, double c,
                           const PixelArrays& pixels, const double* weights, const double F[9],
                           double rounding2, SampsonSums* sums) {
  Accumulated sum;
  sum.cost = 0.0;
  for (int i = 0; i < kEntries; ++i) sum.g[i] = 0.0;
  for (int i = 0; i < 45; ++i) sum.H[i] = 0.0;
  int begin = 0;
  for (; begin + kBlock <= pixels.size; begin += kBlock) {
    AddBlock(kind, newton, derivatives, c, pixels, weights, begin, kBlock, F, rounding2, &sum);
  }
  if (begin < pixels.size) {
    AddBlock(kind, newton, derivatives, c, pixels, weights, begin, pixels.size - begin, F,
             rounding2, &sum);
  }
  sums->cost = 0.5 * sum.cost;
  if (!derivatives) return;
  int k = 0;
  for (int i = 0; i < kEntries; ++i) {
    sums->g[i] = sum.g[i];
    for (int j = i; j < kEntries; ++j, ++k) sums->H[9 * i + j] = sums->H[9 * j + i] = sum.H[k];
  }
}

// One copy of the loops for each loss, so that none has a branch in it.
RIGEL_KERNEL_BODY void Dispatch(const SampsonKernelOptions& options, bool derivatives,
                                const PixelArrays& pixels, const double* weights, const double F[9],
                                double rounding2, SampsonSums* sums) {
  const double c = options.loss_scale;
  const bool newton = options.curvature == Curvature::kNewton;
#define RIGEL_SUM(kind)                                                \
  case kind:                                                           \
    if (!derivatives) {                                                \
      Sum(kind, false, false, c, pixels, weights, F, rounding2, sums); \
    } else if (newton) {                                               \
      Sum(kind, true, true, c, pixels, weights, F, rounding2, sums);   \
    } else {                                                           \
      Sum(kind, false, true, c, pixels, weights, F, rounding2, sums);  \
    }                                                                  \
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
  double C[6][8], g[8];
  for (int m = 0; m < 8; ++m) g[m] = 0.0;
  for (int a = 0; a < 6; ++a) {
    for (int m = 0; m < 8; ++m) C[a][m] = 0.0;
  }
  for (int i = 0; i < 9; ++i) {
    double HD[8];
    for (int m = 0; m < 8; ++m) HD[m] = 0.0;
    for (int j = 0; j < 9; ++j) {
      for (int m = 0; m < 8; ++m) HD[m] += sums.H[9 * i + j] * D.d[j][m];
    }
    for (int m = 0; m < 8; ++m) g[m] += sums.g[i] * D.d[i][m];
    for (int a = 0; a < 6; ++a) {
      for (int m = 0; m < 8; ++m) C[a][m] += D.d[i][a] * HD[m];
    }
  }
  for (int a = 0; a < 6; ++a) {
    gradient[a] += g[a];
    for (int m = 0; m < 6; ++m) curvature[6 * a + m] += C[a][m];
  }
}

RIGEL_TARGET_AVX2 void AddProjectedAvx2(const SampsonSums& sums, const FundamentalDerivatives& D,
                                        double* gradient, double* curvature) {
  AddProjectedBody(sums, D, gradient, curvature);
}

RIGEL_TARGET_AVX2 void SumAvx2(const SampsonKernelOptions& options, bool derivatives,
                               const PixelArrays& pixels, const double* weights, const double F[9],
                               double rounding2, SampsonSums* sums) {
  Dispatch(options, derivatives, pixels, weights, F, rounding2, sums);
}

RIGEL_TARGET_AVX2 void GradientWeightsAvx2(const PixelArrays& pixels, const double F[9],
                                           double floor2, double* weights) {
  GradientWeightsBody(pixels, F, floor2, weights);
}

}  // namespace

void SumSampson(const SampsonKernelOptions& options, const PixelArrays& pixels,
                const double* weights, const double F[9], double rounding2, bool derivatives,
                SampsonSums* sums, CpuPath path) {
  if (path == CpuPath::kAvx2) {
    SumAvx2(options, derivatives, pixels, weights, F, rounding2, sums);
  } else {
    Dispatch(options, derivatives, pixels, weights, F, rounding2, sums);
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

void GradientWeights(const PixelArrays& pixels, const double F[9], double floor2, double* weights,
                     CpuPath path) {
  if (path == CpuPath::kAvx2) {
    GradientWeightsAvx2(pixels, F, floor2, weights);
  } else {
    GradientWeightsBody(pixels, F, floor2, weights);
  }
}

}  // namespace rigel
