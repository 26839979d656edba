#include "rigel/minimal/numerics/twenty_solutions.h"

#include <cmath>

#include "rigel/core/kernel_lanes.h"
#include "rigel/minimal/numerics/bernstein_roots.h"

namespace rigel::polynomial_system {
namespace {

// Solutions, and monomials in the basis of the action matrix.
constexpr int kSize = 20;

// Relative to the eigenvalue and kFarRoot: a longer Newton step leads to another eigenvalue, and is
// not taken. Both are in the unit of x.
constexpr double kFarStep = 0.1;
constexpr double kFarRoot = 0.1;

// Loops over parts of rows begin at multiples of four, where that takes in zeros or unused
// numbers only, so that they vectorize without remainders.
constexpr int Down(int k) { return k & ~3; }

// Row k of the matrix and column k change places with row and column m; so do those columns of the
// two rows below.
RIGEL_KERNEL_BODY void Exchange(int m, int k, double (*a)[kSize]) {
  for (int j = 0; j < kSize; ++j) {
    const double entry = a[m][j];
    a[m][j] = a[k][j];
    a[k][j] = entry;
  }
  for (int r = 0; r < kSize + 2; ++r) {
    const double entry = a[r][m];
    a[r][m] = a[r][k];
    a[r][k] = entry;
  }
}

// Exchanges row m and column m with those of the largest entry of row m - 1 from column m on.
RIGEL_KERNEL_BODY void BringPivotTo(int m, double (*a)[kSize]) {
  double* row = a[m - 1];
  int pivot = m;
  for (int k = m + 1; k < kSize; ++k) {
    if (std::fabs(row[k]) > std::fabs(row[pivot])) pivot = k;
  }
  if (pivot != m) Exchange(m, pivot, a);
  if (std::fabs(row[m]) < kLeastPivot) row[m] = kLeastPivot;
}

// Factors of the multiples of column m that make row m - 1 zero from column m + 1 on; zeros up to
// m. False if all are zero.
RIGEL_KERNEL_BODY bool EliminationFactors(int m, const double* row, double* factors) {
  const double inv = 1.0 / row[m];
  bool any = false;
  for (int k = Down(m + 1); k < kSize; ++k) {
    factors[k] = k > m ? row[k] * inv : 0.0;
    any = any || factors[k] != 0.0;
  }
  return any;
}

// Subtracts the multiples of column m from the columns after it.
RIGEL_KERNEL_BODY void SubtractColumn(int m, const double* factors, double (*a)[kSize]) {
  // Many monomials times x are monomials: rows with one entry, seldom in this column.
  for (int r = m; r < kSize + 2; ++r) {
    const double entry = a[r][m];
    if (entry == 0.0) continue;
    for (int k = Down(m + 1); k < kSize; k += 4) {
      for (int l = 0; l < 4; ++l) a[r][k + l] -= entry * factors[k + l];
    }
  }
}

// The inverse step on the rows: adds the same multiples of the rows after m to row m.
RIGEL_KERNEL_BODY void AddToRow(int m, const double* factors, double (*a)[kSize]) {
  double sum[kSize];
  for (int k = 0; k < kSize; ++k) sum[k] = a[m][k];
  for (int j = m + 1; j < kSize; ++j) {
    const double factor = factors[j];
    for (int k = 0; k < kSize; ++k) sum[k] += factor * a[j][k];
  }
  for (int k = 0; k < kSize; ++k) a[m][k] = sum[k];
}

RIGEL_KERNEL_BODY void ScaleSuperdiagonal(double (*a)[kSize]) {
  double scale[kSize], inv_scale[kSize];
  scale[0] = 1.0;
  for (int k = 1; k < kSize; ++k) scale[k] = scale[k - 1] * a[k - 1][k];
  for (int k = 0; k < kSize; ++k) inv_scale[k] = 1.0 / scale[k];
  for (int r = 0; r < kSize + 2; ++r) {
    const double row_scale = r < kSize ? scale[r] : 1.0;
    for (int k = 0; k < kSize; ++k) a[r][k] *= row_scale * inv_scale[k];
  }
}

// H = S^-1 A S, zero above the superdiagonal, by Gaussian elimination with pivoting, the
// superdiagonal scaled to 1; rows kSize and kSize + 1 become the rows of y and z of S (Wilkinson,
// "The Algebraic Eigenvalue Problem", ch. 6, transposed). What is above the superdiagonal is left
// as rounding makes it and never read.
RIGEL_KERNEL_BODY void ReduceToHessenberg(double (*a)[kSize]) {
  for (int k = 0; k < kSize; ++k) {
    a[kSize][k] = k == 2 ? 1.0 : 0.0;
    a[kSize + 1][k] = k == 3 ? 1.0 : 0.0;
  }
  for (int m = 1; m < kSize; ++m) {
    BringPivotTo(m, a);
    double factors[kSize];
    if (!EliminationFactors(m, a[m - 1], factors)) continue;
    SubtractColumn(m, factors, a);
    AddToRow(m, factors, a);
  }
  ScaleSuperdiagonal(a);
}

// det(x I - H), c[0..kSize] ascending: the polynomials p of x that an eigenvector consists of, the
// first of which is 1 (Hyman's method).
RIGEL_KERNEL_BODY void CharacteristicPolynomial(const double (*a)[kSize], double* c) {
  double p[kSize + 1][kSize + 4] = {};
  p[0][0] = 1.0;
  for (int k = 0; k < kSize; ++k) {
    double* out = p[k + 1];
    for (int i = 0; i <= k; ++i) out[i + 1] = p[k][i];
    for (int j = 0; j <= k; ++j) {
      const double h = a[k][j];
      for (int i = 0; i < j + 1; i += 4) {
        for (int l = 0; l < 4; ++l) out[i + l] -= h * p[j][i + l];
      }
    }
  }
  for (int i = 0; i <= kSize; ++i) c[i] = p[kSize][i];
}

// The solutions of the `count` <= kLanes eigenvalues near x. All are computed at once: each is a
// chain of dependent operations, and those of the others fill the waiting time.
//
// B = H - x I is made lower triangular from its last row up. Each column takes the larger pivot of
// the two rows that reach it. Hyman's recurrence always takes the 1 of the superdiagonal instead;
// then y and z lose all digits if x is large. The vector v satisfies all rows but the first. The
// vector w has the factors with which the rows sum to the first. The Newton step of the eigenvalue
// is w'B v / w'v. It is needed if a root is close to one of those that were left out.
RIGEL_KERNEL_BODY void Solve(const double (*a)[kSize], int count, const double* x,
                             double (*solutions)[3]) {
  Lanes at;
  for (int l = 0; l < kLanes; ++l) at[l] = x[l < count ? l : count - 1];
  Lanes c[kSize][kSize];           // row k: a sum of the rows of B from k on, up to column k
  Lanes of_c[kSize], of_b[kSize];  // c[k - 1] = of_c c[k] + of_b b, b row k - 1 of B
  for (int j = 0; j < kSize; ++j) c[kSize - 1][j] = a[kSize - 1][j] + Lanes{};
  c[kSize - 1][kSize - 1] -= at;
  for (int k = kSize - 1; k > 0; --k) {
    const Lanes pivot = c[k][k];
    const Lanes size = pivot < 0.0 ? -pivot : pivot;
    of_c[k] = 1.0 / (size > 1.0 ? size : Lanes{} + 1.0);
    of_b[k] = -pivot * of_c[k];
    const Lanes f = of_c[k], g = of_b[k];
    for (int j = 0; j < k; ++j) c[k - 1][j] = f * c[k][j] + g * a[k - 1][j];
    c[k - 1][k - 1] -= g * at;
  }
  Lanes v[kSize];
  v[0] = Lanes{} + 1.0;
  for (int k = 1; k < kSize; ++k) {
    Lanes sum_c = {}, sum_b = {};
    for (int j = 0; j < k; ++j) {
      sum_c += c[k][j] * v[j];
      sum_b += a[k - 1][j] * v[j];
    }
    const Lanes pivot = c[k][k];
    const Lanes size = pivot < 0.0 ? -pivot : pivot;
    v[k] = size > 1.0 ? -sum_c / pivot : at * v[k - 1] - sum_b;
  }
  Lanes y = {}, z = {};
  for (int k = 0; k < kSize; ++k) {
    y += a[kSize][k] * v[k];
    z += a[kSize + 1][k] * v[k];
  }
  Lanes wv = v[kSize - 1];
  for (int k = kSize - 1; k > 0; --k) wv = of_c[k] * wv + of_b[k] * v[k - 1];
  for (int l = 0; l < count; ++l) {
    const double step = c[0][0][l] / wv[l];
    const bool near = std::fabs(step) < kFarStep * (kFarRoot + std::fabs(at[l]));
    solutions[l][0] = near ? at[l] + step : at[l];
    solutions[l][1] = y[l];
    solutions[l][2] = z[l];
  }
}

RIGEL_KERNEL_BODY void Prepare(double (*a)[kSize], double* c) {
  ReduceToHessenberg(a);
  CharacteristicPolynomial(a, c);
}

RIGEL_KERNEL_BODY void SolveAll(const double (*a)[kSize], int count, const double* x,
                                double (*solutions)[3]) {
  for (int first = 0; first < count; first += kLanes) {
    Solve(a, count - first < kLanes ? count - first : kLanes, x + first, solutions + first);
  }
}

#if RIGEL_HAS_AVX2_PATH
RIGEL_TARGET_AVX2 void PrepareAvx2(double (*a)[kSize], double* c) { Prepare(a, c); }

RIGEL_TARGET_AVX2 void SolveAllAvx2(const double (*a)[kSize], int count, const double* x,
                                    double (*solutions)[3]) {
  SolveAll(a, count, x, solutions);
}
#endif

void PrepareBaseline(double (*a)[kSize], double* c) { Prepare(a, c); }

void SolveAllBaseline(const double (*a)[kSize], int count, const double* x,
                      double (*solutions)[3]) {
  SolveAll(a, count, x, solutions);
}

}  // namespace

int FindTwentySolutions(int multiplicity, ActionMatrix<kSize>* action, double (*solutions)[3],
                        CpuPath path) {
#if RIGEL_HAS_AVX2_PATH
  const bool avx2 = path == CpuPath::kAvx2;
  const auto prepare = avx2 ? PrepareAvx2 : PrepareBaseline;
  const auto solve_all = avx2 ? SolveAllAvx2 : SolveAllBaseline;
#else
  (void)path;
  const auto prepare = PrepareBaseline;
  const auto solve_all = SolveAllBaseline;
#endif
  double c[kSize + 1];
  double x[kSize];
  prepare(action->entries, c);
  const int count =
      RootFinder<kSize>(c + multiplicity, kSize - multiplicity).Find(/*near_only=*/false, x);
  solve_all(action->entries, count, x, solutions);
  return count;
}

}  // namespace rigel::polynomial_system
