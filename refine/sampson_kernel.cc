#include "rigel/refine/sampson_kernel.h"

#include <math.h>

#include "rigel/minimal/sampson_terms.h"

// Plain loops, see cpu_path.h.
namespace rigel {
namespace {

// Long enough for g++ to keep the loops, which it vectorizes; half of it is unrolled into scalars.
constexpr int kBlock = 64;
constexpr int kLanes = 8;
constexpr int kRows = 10;  // de/dF and the residual

// A block of matches, short ones filled up with matches of weight zero.
struct Block {
  double x1[kBlock], y1[kBlock], x2[kBlock], y2[kBlock], w[kBlock];
};

struct Rows {
  double row[kRows][kBlock];  // sqrt(h) de/dF, rho' / sqrt(h) e
  double rho[kBlock];         // kCauchy: 1 + s / scale^2
};

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
                                 const Block& p, const double F[9], double rounding2, Rows* rows) {
  const double c2 = c * c;
  constexpr double kMinNewton = 1.0 / 3.0;
  for (int i = 0; i < kBlock; ++i) {
    const double x1 = p.x1[i], y1 = p.y1[i], x2 = p.x2[i], y2 = p.y2[i];
    const SampsonTerms t = TermsOf(F, x1, y1, x2, y2);
    const double floor2 = rounding2 * (((x1 * x1 + y1 * y1) + (x2 * x2 + y2 * y2)) + 2.0);
    // Also false for NaN; infinity would give zero weight below.
    const bool regular = t.gradient2 > floor2;
    const double inverse = 1.0 / sqrt(regular ? t.gradient2 : 1.0);
    const double w = regular ? p.w[i] : 0.0;
    const double we = w * inverse;
    const double e = we * t.C;
    double rho, slope, newton;
    Loss(kind, c, c2, e * e, &rho, &slope, &newton);
    rows->rho[i] = rho;
    if (!derivatives) continue;
    double q, qe;  // sqrt(h) and rho' / sqrt(h)
    const double root = sqrt(slope);
    if (newton_curvature) {
      const double share = sqrt(newton > kMinNewton ? newton : 1.0);
      q = root * share;
      qe = root / share;
    } else {
      q = root;
      qe = root;
    }
    // de/dF = u p1' - v b', where the third entry of b counts as zero.
    const double k = q * we;
    const double m = t.C * inverse * inverse;
    const double u0 = k * (x2 - m * t.a0);
    const double u1 = k * (y2 - m * t.a1);
    const double v0 = k * m * x2;
    const double v1 = k * m * y2;
    const double v2 = k * m;
    rows->row[0][i] = u0 * x1 - v0 * t.b0;
    rows->row[1][i] = u0 * y1 - v0 * t.b1;
    rows->row[2][i] = u0;
    rows->row[3][i] = u1 * x1 - v1 * t.b0;
    rows->row[4][i] = u1 * y1 - v1 * t.b1;
    rows->row[5][i] = u1;
    rows->row[6][i] = k * x1 - v2 * t.b0;
    rows->row[7][i] = k * y1 - v2 * t.b1;
    rows->row[8][i] = k;
    rows->row[9][i] = qe * e;
  }
}

RIGEL_KERNEL_BODY double Dot(const double* a, const double* b) {
  double lane[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (int i = 0; i < kBlock; i += kLanes) {
    for (int l = 0; l < kLanes; ++l) lane[l] += a[i + l] * b[i + l];
  }
  return ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
}

RIGEL_KERNEL_BODY double SumRho(LossKind kind, double c, const double* rho) {
  if (kind != LossKind::kCauchy) {
    double lane[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int i = 0; i < kBlock; i += kLanes) {
      for (int l = 0; l < kLanes; ++l) lane[l] += rho[i + l];
    }
    return ((lane[0] + lane[4]) + (lane[1] + lane[5])) +
           ((lane[2] + lane[6]) + (lane[3] + lane[7]));
  }
  // One logarithm for the product of eight.
  double product[kLanes];
  for (int l = 0; l < kLanes; ++l) product[l] = rho[l];
  for (int i = kLanes; i < kBlock; i += kLanes) {
    for (int l = 0; l < kLanes; ++l) product[l] *= rho[i + l];
  }
  double sum = 0.0;
  for (int l = 0; l < kLanes; ++l) sum += log(product[l]);
  return c * c * sum;
}

RIGEL_KERNEL_BODY void Sum(LossKind kind, bool newton, bool derivatives, double c,
                           const PixelArrays& pixels, const double* weights, const double F[9],
                           double rounding2, SampsonSums* sums) {
  Block block;
  Rows rows;
  double cost = 0.0;
  double g[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  double H[45];
  for (int i = 0; i < 45; ++i) H[i] = 0.0;
  for (int begin = 0; begin < pixels.size; begin += kBlock) {
    const int left = pixels.size - begin;
    const int size = left < kBlock ? left : kBlock;
    for (int i = 0; i < size; ++i) block.x1[i] = pixels.x1[begin + i];
    for (int i = 0; i < size; ++i) block.y1[i] = pixels.y1[begin + i];
    for (int i = 0; i < size; ++i) block.x2[i] = pixels.x2[begin + i];
    for (int i = 0; i < size; ++i) block.y2[i] = pixels.y2[begin + i];
    for (int i = 0; i < size; ++i) block.w[i] = weights[begin + i];
    for (int i = size; i < kBlock; ++i) {
      block.x1[i] = block.y1[i] = block.x2[i] = block.y2[i] = block.w[i] = 0.0;
    }
    Linearize(kind, newton, derivatives, c, block, F, rounding2, &rows);
    cost += SumRho(kind, c, rows.rho);
    if (!derivatives) continue;
    int k = 0;
    for (int i = 0; i < 9; ++i) {
      for (int j = i; j < 9; ++j) H[k++] += Dot(rows.row[i], rows.row[j]);
    }
    for (int i = 0; i < 9; ++i) g[i] += Dot(rows.row[i], rows.row[9]);
  }
  sums->cost = 0.5 * cost;
  if (!derivatives) return;
  int k = 0;
  for (int i = 0; i < 9; ++i) {
    sums->g[i] = g[i];
    for (int j = i; j < 9; ++j, ++k) sums->H[9 * i + j] = sums->H[9 * j + i] = H[k];
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

void GradientWeights(const PixelArrays& pixels, const double F[9], double floor2, double* weights,
                     CpuPath path) {
  if (path == CpuPath::kAvx2) {
    GradientWeightsAvx2(pixels, F, floor2, weights);
  } else {
    GradientWeightsBody(pixels, F, floor2, weights);
  }
}

}  // namespace rigel
