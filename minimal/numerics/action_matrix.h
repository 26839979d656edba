// The real solutions of a system of polynomials in three variables from the action of
// multiplication by the first one (polynomial_system.h makes it).
//
// The real eigenvalues come from the characteristic polynomial of the Hessenberg form, by
// Descartes' rule: less work than the QR algorithm, and accurate for roots near the centre
// about which it is expanded. So variables should be scaled such that the solutions of interest are
// below 1. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_ACTION_MATRIX_H_
#define RIGEL_MINIMAL_NUMERICS_ACTION_MATRIX_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "rigel/minimal/numerics/bernstein_roots.h"

namespace rigel::polynomial_system {

// The action of multiplication by x on the kSize monomials that are a basis of the solutions'
// coordinate ring: row b holds x times monomial b. The first four monomials are 1, x, y, z.
template <int kSize>
struct ActionMatrix {
  // The two rows at the end are room for the solution.
  double entries[kSize + 2][kSize];
};

// Least pivot of the reduction to Hessenberg form. A zero would split the matrix; a number as tiny
// as this, where entries are near 1, does not move its eigenvalues.
inline constexpr double kLeastPivot = 1e-30;

// The real solutions of a reduced system. Loops over parts of rows begin at multiples of four where
// the additional entries are zero: they vectorize without remainders.
template <int kSize>
class RealSolutions {
 public:
  // Destroys `action`.
  explicit RealSolutions(ActionMatrix<kSize>* action) : a_(action->entries) {
    ReduceToHessenberg();
  }

  // Appends the values of x to the `count` in `x`, up to kSize in all; returns their new number.
  // The characteristic polynomial is expanded about `centre`, which finds the roots near it best;
  // only those nearer than 1 if `near_only`.
  int FindX(double centre, bool near_only, double* x, int count) const;

  // The roots x of the characteristic polynomial by the secant method on the matrix itself, which
  // knows roots in a cluster better than the coefficients do. To the accuracy that an iteration on
  // the original equations needs.
  void Refine(int count, double* x) const {
    for (int first = 0; first < count; first += kLanes) {
      double at[kLanes], last[kLanes], value[kLanes], last_value[kLanes];
      bool done[kLanes];
      for (int l = 0; l < kLanes; ++l) {
        at[l] = x[std::min(first + l, count - 1)];
        last[l] = at[l] + kSecantStart * (kLeastScale + std::abs(at[l]));
        done[l] = false;
      }
      Determinants(last, last_value);
      for (int k = 0; k < kSecantSteps; ++k) {
        Determinants(at, value);
        bool all = true;
        for (int l = 0; l < kLanes; ++l) {
          const double step = value[l] * (last[l] - at[l]) / (last_value[l] - value[l]);
          done[l] = done[l] || !(std::abs(step) < kFarSecantStep * (kFarRoot + std::abs(at[l])));
          if (!done[l]) {
            last[l] = at[l];
            last_value[l] = value[l];
            at[l] -= step;
            done[l] = std::abs(step) < kRefined * (kLeastScale + std::abs(at[l]));
          }
          all = all && done[l];
        }
        if (all) break;
      }
      for (int l = 0; l < kLanes && first + l < count; ++l) x[first + l] = at[l];
    }
  }

  // The solutions of the `count` values of x, to their accuracy.
  void Solve(int count, const double* x, std::array<double, 3>* solutions) const {
    for (int first = 0; first < count; first += kLanes) {
      double at[kLanes], v[kSize][kLanes];
      for (int l = 0; l < kLanes; ++l) at[l] = x[std::min(first + l, count - 1)];
      EvaluateVectors(at, v);
      double y[kLanes] = {}, z[kLanes] = {};
      for (int k = 0; k < kSize; ++k) {
        for (int l = 0; l < kLanes; ++l) {
          y[l] += a_[kSize][k] * v[k][l];
          z[l] += a_[kSize + 1][k] * v[k][l];
        }
      }
      for (int l = 0; l < kLanes && first + l < count; ++l) {
        solutions[first + l] = {at[l], y[l] / v[0][l], z[l] / v[0][l]};
      }
    }
  }

 private:
  static_assert(kSize % 4 == 0);
  // Values of x at once. The steps for one x depend on one another; those for others run meanwhile.
  static constexpr int kLanes = 4;
  // The constants of Refine(). A root below this, in the unit of x, counts as one of this size.
  static constexpr double kLeastScale = 0.01;
  // The second point of the secant method, relative to the root: beyond the error of the first.
  static constexpr double kSecantStart = 1e-7;
  // The step after which it ends, relative to the root: well above rounding, and the next step
  // would be far smaller.
  static constexpr double kRefined = 1e-12;
  static constexpr int kSecantSteps = 4;  // at most: from 1e-7 three reach rounding
  // A step that is not shorter than these say leads to another root, and is not taken: a share of
  // the root, where that is larger than the second number, in the unit of x.
  static constexpr double kFarSecantStep = 0.05;
  static constexpr double kFarRoot = 0.1;

  static constexpr int Down(int k) { return k & ~3; }
  static constexpr int Up(int k) { return (k + 3) & ~3; }

  // H = S^-1 A S by Gaussian elimination with pivoting, its subdiagonal scaled to 1; rows kSize and
  // kSize + 1 become the rows of y and z of S (Wilkinson, "The Algebraic Eigenvalue Problem", ch.
  // 6). What is below the subdiagonal is left as rounding makes it and never read.
  void ReduceToHessenberg() {
    for (int k = 0; k < kSize; ++k) {
      a_[kSize][k] = k == 2 ? 1.0 : 0.0;
      a_[kSize + 1][k] = k == 3 ? 1.0 : 0.0;
    }
    double factors[kSize] = {};
    for (int m = 1; m < kSize; ++m) {
      BringPivotTo(m);
      if (EliminateBelow(m, factors)) AddToColumn(m, factors);
    }
    ScaleSubdiagonal();
  }

  // Exchanges row m and column m with those of the largest entry of column m - 1 from row m on.
  void BringPivotTo(int m) {
    int pivot = m;
    for (int i = m + 1; i < kSize; ++i) {
      if (std::abs(a_[i][m - 1]) > std::abs(a_[pivot][m - 1])) pivot = i;
    }
    if (pivot != m) {
      for (int k = Down(m - 1); k < kSize; ++k) std::swap(a_[m][k], a_[pivot][k]);
      for (int r = 0; r < kSize + 2; ++r) std::swap(a_[r][m], a_[r][pivot]);
    }
    if (std::abs(a_[m][m - 1]) < kLeastPivot) a_[m][m - 1] = kLeastPivot;
  }

  // Subtracts multiples of row m from the rows i below it, which makes column m - 1 zero there.
  // Writes their factors from m on, that of m itself as 0. False if all are zero.
  bool EliminateBelow(int m, double* factors) {
    const int begin = Down(m);
    const double inv = 1.0 / a_[m][m - 1];
    factors[m] = 0.0;
    bool any = false;
    for (int i = m + 1; i < kSize; ++i) {
      const double factor = a_[i][m - 1] * inv;
      factors[i] = factor;
      if (factor == 0.0) continue;
      any = true;
      for (int k = begin; k < kSize; k += 4) {
        for (int l = 0; l < 4; ++l) a_[i][k + l] -= factor * a_[m][k + l];
      }
    }
    return any;
  }

  // The inverse step on the columns: adds the same multiples of the columns after m to column m.
  void AddToColumn(int m, const double* factors) {
    for (int r = 0; r < kSize + 2; ++r) {
      double sum[4] = {0.0, 0.0, 0.0, 0.0};
      for (int i = Down(m); i < kSize; i += 4) {
        for (int l = 0; l < 4; ++l) sum[l] += factors[i + l] * a_[r][i + l];
      }
      a_[r][m] += (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
  }

  void ScaleSubdiagonal() {
    double scale[kSize];
    scale[0] = 1.0;
    for (int k = 1; k < kSize; ++k) scale[k] = scale[k - 1] * a_[k][k - 1];
    for (int r = 0; r < kSize + 2; ++r) {
      const double inv = r < kSize ? 1.0 / scale[r] : 1.0;
      for (int k = r < kSize ? Down(r) : 0; k < kSize; ++k) a_[r][k] *= inv * scale[k];
    }
  }

  // Hyman's method: the vectors v for which all rows of (H - x I) v but the first vanish.
  void EvaluateVectors(const double* x, double (*v)[kLanes]) const {
    for (int l = 0; l < kLanes; ++l) v[kSize - 1][l] = 1.0;
    for (int k = kSize - 1; k > 0; --k) {
      double sum[kLanes];
      for (int l = 0; l < kLanes; ++l) sum[l] = 0.0;
      // The latest v comes last.
      for (int j = kSize - 1; j >= k; --j) {
        const double h = a_[k][j];
        for (int l = 0; l < kLanes; ++l) sum[l] += h * v[j][l];
      }
      for (int l = 0; l < kLanes; ++l) v[k - 1][l] = x[l] * v[k][l] - sum[l];
    }
  }

  // det(x I - H).
  void Determinants(const double* x, double* values) const {
    double v[kSize][kLanes];
    EvaluateVectors(x, v);
    for (int l = 0; l < kLanes; ++l) values[l] = x[l] * v[0][l];
    for (int k = 0; k < kSize; ++k) {
      for (int l = 0; l < kLanes; ++l) values[l] -= a_[0][k] * v[k][l];
    }
  }

  // det((x + centre) I - H): the same recurrence in polynomials, c[0..kSize] ascending.
  void CharacteristicPolynomial(double centre, double* c) const {
    double p[kSize][kSize];
    double out[kSize + 1];
    std::fill(p[kSize - 1], p[kSize - 1] + kSize, 0.0);
    p[kSize - 1][0] = 1.0;
    for (int k = kSize - 1; k >= 0; --k) {
      out[0] = 0.0;
      std::copy(p[k], p[k] + kSize, out + 1);
      for (int j = k; j < kSize; ++j) {
        const double h = a_[k][j] - (j == k ? centre : 0.0);
        const int end = Up(kSize - j);
        for (int i = 0; i < end; ++i) out[i] -= h * p[j][i];
      }
      std::copy(out, out + kSize + (k > 0 ? 0 : 1), k > 0 ? p[k - 1] : c);
    }
  }

  double (*a_)[kSize];
};

template <int kSize>
int RealSolutions<kSize>::FindX(double centre, bool near_only, double* x, int count) const {
  double c[kSize + 1];
  double roots[kSize];
  CharacteristicPolynomial(centre, c);
  const int num_roots = RootFinder<kSize>(c, kSize).Find(near_only, roots);
  for (int k = 0; k < num_roots && count < kSize; ++k) x[count++] = roots[k] + centre;
  return count;
}

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_NUMERICS_ACTION_MATRIX_H_
