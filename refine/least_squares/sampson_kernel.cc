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
  double row[kEntries][kBlock];  // J / f; of pinholes the last entry, which is not here, is 1
  double weight[kBlock];         // f^2 h
  double residual[kBlock];       // f rho' e
  double rho[kBlock];            // kCauchy: 1 + s / scale^2
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

// Sets the row of match i: de/dF = f (u p1' - v B'), u = p2 - m A, v = m p2, m = C / |gradient|^2.
RIGEL_KERNEL_BODY void SetRow(const SampsonTerms& t, double x1, double y1, double x2, double y2,
                              double m, int i, Rows* rows) {
  // The third entries of A = (a, 0) and B = (b, 0) are zero.
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
}

RIGEL_KERNEL_BODY void SetRow(const RowTerms& t, const RowOfMatch& match, double m, int i,
                              Rows* rows) {
  for (int j = 0; j < 3; ++j) {
    const double u = match.p2[j] - m * t.A[j];
    const double v = m * match.p2[j];
    for (int k = 0; k < 3; ++k) rows->row[3 * j + k][i] = u * match.p1[k] - v * t.B[k];
  }
}

// What the loss makes of match i with the constraint C: rho, and with `derivatives` the weights.
// Returns m.
RIGEL_KERNEL_BODY double SetWeights(LossKind kind, bool derivatives, double c, double weight,
                                    double C, double gradient2, double floor2, int i, Rows* rows) {
  constexpr double kMinNewton = 1.0 / 3.0;
  // Also false for NaN; infinity would give zero weight below.
  const bool regular = gradient2 > floor2;
  const double inverse2 = 1.0 / (regular ? gradient2 : 1.0);
  const double w = regular ? weight : 0.0;
  const double f2 = (w * w) * inverse2;
  double rho, slope, newton;
  Loss(kind, c, c * c, f2 * (C * C), &rho, &slope, &newton);
  rows->rho[i] = rho;
  if (derivatives) {
    const double fg = f2 * slope;
    rows->weight[i] = fg * (newton > kMinNewton ? newton : 1.0);
    rows->residual[i] = fg * C;
  }
  return C * inverse2;
}

// Fills `rows` for the block: rho, and with `derivatives` the rest.
template <bool kGeneral>
RIGEL_KERNEL_BODY void Linearize(LossKind kind, bool derivatives, double c,
                                 const RowArrays& matches, const double* weights, int begin,
                                 int size, const double F[9], double rounding2, Rows* rows) {
  for (int i = 0; i < size; ++i) {
    if (kGeneral) {
      const RowOfMatch match = RowAt(matches, begin + i);
      const RowTerms t = TermsOf(F, match);
      const double m = SetWeights(kind, derivatives, c, weights[i], t.C, t.gradient2,
                                  rounding2 * SizeOf(match), i, rows);
      if (derivatives) SetRow(t, match, m, i, rows);
    } else {
      const double x1 = matches.x1[begin + i], y1 = matches.y1[begin + i];
      const double x2 = matches.x2[begin + i], y2 = matches.y2[begin + i];
      const SampsonTerms t = TermsOf(F, x1, y1, x2, y2);
      const double floor2 = rounding2 * (((x1 * x1 + y1 * y1) + (x2 * x2 + y2 * y2)) + 2.0);
      const double m =
          SetWeights(kind, derivatives, c, weights[i], t.C, t.gradient2, floor2, i, rows);
      if (derivatives) SetRow(t, x1, y1, x2, y2, m, i, rows);
    }
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

// Adds the first kRow + 1 entries of row kRow of H; of pinholes also its entry in the last row.
template <bool kGeneral, int kRow>
RIGEL_KERNEL_BODY void AddRow(const Rows& rows, int size, Accumulated* sums) {
  Lanes sum[kRow + 1];
  for (Lanes& s : sum) s = Lanes{};
  Lanes last = {};
  for (int i = 0; i < size; i += kLanes) {
    const Lanes weighted = LanesAt(rows.weight + i) * LanesAt(rows.row[kRow] + i);
    for (int k = 0; k <= kRow; ++k) sum[k] += LanesAt(rows.row[k] + i) * weighted;
    if (!kGeneral) last += weighted;
  }
  for (int k = 0; k <= kRow; ++k) sums->H[kRow][k] += sum[k];
  if (!kGeneral) sums->H[8][kRow] += last;
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void AddGradient(const Rows& rows, int size, Accumulated* sums) {
  Lanes sum[kEntries];
  for (Lanes& s : sum) s = Lanes{};
  Lanes weight = {};
  for (int i = 0; i < size; i += kLanes) {
    const Lanes residual = LanesAt(rows.residual + i);
    for (int k = 0; k < kEntries - 1; ++k) sum[k] += LanesAt(rows.row[k] + i) * residual;
    if (kGeneral) {
      sum[8] += LanesAt(rows.row[8] + i) * residual;
    } else {
      sum[8] += residual;
      weight += LanesAt(rows.weight + i);
    }
  }
  for (int k = 0; k < kEntries; ++k) sums->g[k] += sum[k];
  if (!kGeneral) sums->H[8][8] += weight;
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void AddRowsBody(const Rows& rows, int size, Accumulated* sums) {
  AddRow<kGeneral, 0>(rows, size, sums);
  AddRow<kGeneral, 1>(rows, size, sums);
  AddRow<kGeneral, 2>(rows, size, sums);
  AddRow<kGeneral, 3>(rows, size, sums);
  AddRow<kGeneral, 4>(rows, size, sums);
  AddRow<kGeneral, 5>(rows, size, sums);
  AddRow<kGeneral, 6>(rows, size, sums);
  AddRow<kGeneral, 7>(rows, size, sums);
  if (kGeneral) AddRow<kGeneral, 8>(rows, size, sums);
  AddGradient<kGeneral>(rows, size, sums);
}

// Separate functions, so that the sums of a loop stay in registers.
using AddRowsFunction = void(const Rows& rows, int size, Accumulated* sums);
template <bool kGeneral>
__attribute__((noinline)) void AddGradientAlone(const Rows& rows, int size, Accumulated* sums) {
  AddGradient<kGeneral>(rows, size, sums);
}
template <bool kGeneral>
RIGEL_TARGET_AVX2 __attribute__((noinline)) void AddGradientAloneAvx2(const Rows& rows, int size,
                                                                      Accumulated* sums) {
  AddGradient<kGeneral>(rows, size, sums);
}
template <bool kGeneral>
__attribute__((noinline)) void AddRows(const Rows& rows, int size, Accumulated* sums) {
  AddRowsBody<kGeneral>(rows, size, sums);
}
template <bool kGeneral>
RIGEL_TARGET_AVX2 __attribute__((noinline)) void AddRowsAvx2(const Rows& rows, int size,
                                                             Accumulated* sums) {
  AddRowsBody<kGeneral>(rows, size, sums);
}

// Adds matches begin to begin + size. A size that the compiler knows makes faster loops.
template <bool kGeneral>
RIGEL_KERNEL_BODY void AddBlock(LossKind kind, bool derivatives, double c, const RowArrays& matches,
                                const double* weights, int begin, int size, const double F[9],
                                double rounding2, AddRowsFunction* add_rows, Accumulated* sum) {
  Rows rows;
  Linearize<kGeneral>(kind, derivatives, c, matches, weights, begin, size, F, rounding2, &rows);
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

template <bool kGeneral>
RIGEL_KERNEL_BODY void Sum(LossKind kind, bool derivatives, double c, const RowArrays& matches,
                           const double* weights, const double F[9], double rounding2,
                           AddRowsFunction* add_rows, SampsonSums* sums) {
  Accumulated sum;
  sum.cost = 0.0;
  for (int i = 0; i < kEntries; ++i) {
    sum.g[i] = Lanes{};
    for (int j = 0; j <= i; ++j) sum.H[i][j] = Lanes{};
  }
  int begin = 0;
  for (; begin + kBlock <= matches.size; begin += kBlock) {
    AddBlock<kGeneral>(kind, derivatives, c, matches, weights + begin, begin, kBlock, F, rounding2,
                       add_rows, &sum);
  }
  if (begin < matches.size) {
    double rest[kBlock];
    const int whole = FillUp(weights + begin, matches.size - begin, rest);
    AddBlock<kGeneral>(kind, derivatives, c, matches, rest, begin, whole, F, rounding2, add_rows,
                       &sum);
  }
  sums->cost = 0.5 * sum.cost;
  if (!derivatives) return;
  for (int i = 0; i < kEntries; ++i) {
    sums->g[i] = SumOf(sum.g[i]);
    for (int j = 0; j <= i; ++j) sums->H[9 * i + j] = sums->H[9 * j + i] = SumOf(sum.H[i][j]);
  }
}

// One copy of the loops for each loss, so that none has a branch in it.
template <bool kGeneral>
RIGEL_KERNEL_BODY void Dispatch(const SampsonKernelOptions& options, SampsonParts parts,
                                const RowArrays& matches, const double* weights, const double F[9],
                                double rounding2, AddRowsFunction* add_rows,
                                AddRowsFunction* add_gradient, SampsonSums* sums) {
  const double c = options.loss_scale;
  const bool derivatives = parts != SampsonParts::kCost;
  AddRowsFunction* add = parts == SampsonParts::kAll ? add_rows : add_gradient;
#define RIGEL_SUM(kind)                                                         \
  case kind:                                                                    \
    if (derivatives) {                                                          \
      Sum<kGeneral>(kind, true, c, matches, weights, F, rounding2, add, sums);  \
    } else {                                                                    \
      Sum<kGeneral>(kind, false, c, matches, weights, F, rounding2, add, sums); \
    }                                                                           \
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

template <bool kGeneral>
RIGEL_KERNEL_BODY void BlockLeverages(const RowArrays& matches, const double* weights, int begin,
                                      int size, const double F[9], const QuadraticForm& form,
                                      double rounding2, double* leverages) {
  Rows rows;
  Linearize<kGeneral>(LossKind::kNone, true, 1.0, matches, weights, begin, size, F, rounding2,
                      &rows);
  for (int i = 0; i < size; i += kLanes) {
    Lanes row[kEntries];
    for (int k = 0; k < kEntries - 1; ++k) row[k] = LanesAt(rows.row[k] + i);
    row[8] = kGeneral ? LanesAt(rows.row[8] + i) : Lanes{} + 1.0;
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

template <bool kGeneral>
RIGEL_KERNEL_BODY void Leverages(const RowArrays& matches, const double* weights, const double F[9],
                                 const double C[81], double rounding2, double* leverages) {
  QuadraticForm form;
  for (int k = 0; k < kEntries; ++k) {
    for (int j = 0; j < k; ++j) form.q[k][j] = C[9 * k + j] + C[9 * j + k];
    form.q[k][k] = C[10 * k];
  }
  int begin = 0;
  for (; begin + kBlock <= matches.size; begin += kBlock) {
    BlockLeverages<kGeneral>(matches, weights + begin, begin, kBlock, F, form, rounding2,
                             leverages + begin);
  }
  if (begin < matches.size) {
    double rest[kBlock], last[kBlock];
    const int whole = FillUp(weights + begin, matches.size - begin, rest);
    BlockLeverages<kGeneral>(matches, rest, begin, whole, F, form, rounding2, last);
    for (int i = begin; i < matches.size; ++i) leverages[i] = last[i - begin];
  }
}

// |J2'F J1|^2: how fast the gradient by one pixel changes with the other pixel, squared.
RIGEL_KERNEL_BODY double MixedDerivative2(const double F[9], const RowOfMatch& m) {
  double sum = 0.0;
  for (int c = 0; c < 2; ++c) {
    double q[3];
    for (int i = 0; i < 3; ++i) {
      q[i] = F[3 * i] * m.J1[c] + F[3 * i + 1] * m.J1[2 + c] + F[3 * i + 2] * m.J1[4 + c];
    }
    for (int d = 0; d < 2; ++d) {
      const double entry = m.J2[d] * q[0] + m.J2[2 + d] * q[1] + m.J2[4 + d] * q[2];
      sum += entry * entry;
    }
  }
  return sum;
}

template <bool kGeneral>
RIGEL_KERNEL_BODY void GradientWeightsBody(const RowArrays& matches, const double F[9],
                                           double noise2, double* weights) {
  const double pinhole_floor2 =
      noise2 * ((F[0] * F[0] + F[1] * F[1]) + (F[3] * F[3] + F[4] * F[4]));
  for (int i = 0; i < matches.size; ++i) {
    double gradient2, floor2;
    if (kGeneral) {
      const RowOfMatch match = RowAt(matches, i);
      gradient2 = TermsOf(F, match).gradient2;
      floor2 = noise2 * MixedDerivative2(F, match);
    } else {
      gradient2 = TermsOf(F, matches.x1[i], matches.y1[i], matches.x2[i], matches.y2[i]).gradient2;
      floor2 = pinhole_floor2;
    }
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

// Each public function of matches on one path: for pinholes, or for any cameras.
RIGEL_KERNEL_BODY void SumBody(const SampsonKernelOptions& options, SampsonParts parts,
                               const RowArrays& matches, const double* weights, const double F[9],
                               double rounding2, AddRowsFunction* const functions[4],
                               SampsonSums* sums) {
  if (matches.general != nullptr) {
    Dispatch<true>(options, parts, matches, weights, F, rounding2, functions[2], functions[3],
                   sums);
  } else {
    Dispatch<false>(options, parts, matches, weights, F, rounding2, functions[0], functions[1],
                    sums);
  }
}

RIGEL_KERNEL_BODY void LeveragesBody(const RowArrays& matches, const double* weights,
                                     const double F[9], const double C[81], double rounding2,
                                     double* leverages) {
  if (matches.general != nullptr) {
    Leverages<true>(matches, weights, F, C, rounding2, leverages);
  } else {
    Leverages<false>(matches, weights, F, C, rounding2, leverages);
  }
}

RIGEL_KERNEL_BODY void WeightsBody(const RowArrays& matches, const double F[9], double noise2,
                                   double* weights) {
  if (matches.general != nullptr) {
    GradientWeightsBody<true>(matches, F, noise2, weights);
  } else {
    GradientWeightsBody<false>(matches, F, noise2, weights);
  }
}

RIGEL_TARGET_AVX2 void SumAvx2(const SampsonKernelOptions& options, SampsonParts parts,
                               const RowArrays& matches, const double* weights, const double F[9],
                               double rounding2, SampsonSums* sums) {
  AddRowsFunction* const functions[4] = {AddRowsAvx2<false>, AddGradientAloneAvx2<false>,
                                         AddRowsAvx2<true>, AddGradientAloneAvx2<true>};
  SumBody(options, parts, matches, weights, F, rounding2, functions, sums);
}

RIGEL_TARGET_AVX2 void LeveragesAvx2(const RowArrays& matches, const double* weights,
                                     const double F[9], const double C[81], double rounding2,
                                     double* leverages) {
  LeveragesBody(matches, weights, F, C, rounding2, leverages);
}

RIGEL_TARGET_AVX2 void GradientWeightsAvx2(const RowArrays& matches, const double F[9],
                                           double noise2, double* weights) {
  WeightsBody(matches, F, noise2, weights);
}

}  // namespace

void SumSampson(const SampsonKernelOptions& options, const RowArrays& matches,
                const double* weights, const double F[9], double rounding2, SampsonParts parts,
                SampsonSums* sums, CpuPath path) {
  if (path == CpuPath::kAvx2) {
    SumAvx2(options, parts, matches, weights, F, rounding2, sums);
  } else {
    AddRowsFunction* const functions[4] = {AddRows<false>, AddGradientAlone<false>, AddRows<true>,
                                           AddGradientAlone<true>};
    SumBody(options, parts, matches, weights, F, rounding2, functions, sums);
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

void SampsonLeverages(const RowArrays& matches, const double* weights, const double F[9],
                      const double C[81], double rounding2, double* leverages, CpuPath path) {
  if (path == CpuPath::kAvx2) {
    LeveragesAvx2(matches, weights, F, C, rounding2, leverages);
  } else {
    LeveragesBody(matches, weights, F, C, rounding2, leverages);
  }
}

void GradientWeights(const RowArrays& matches, const double F[9], double noise2, double* weights,
                     CpuPath path) {
  if (path == CpuPath::kAvx2) {
    GradientWeightsAvx2(matches, F, noise2, weights);
  } else {
    WeightsBody(matches, F, noise2, weights);
  }
}

}  // namespace rigel
