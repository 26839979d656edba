// Systems of polynomials in three variables with finitely many solutions. A Macaulay matrix is
// reduced to the action of multiplication by the first variable. Its real eigenvalues are the first
// coordinates of the real solutions, and its eigenvectors hold the others.
//
// The method is that of Auzinger, Stetter and Moeller (Cox, Little, O'Shea, "Using Algebraic
// Geometry", chapter 2). A caller must know how many leading monomials of each degree its system
// has (from the Hilbert function, computed once modulo a prime), so that no rank is ever decided
// from numbers.
//
// Monomials x^i y^j z^k are ordered by degree, so those of degree <= d are the first
// NumMonomials(d). A polynomial is the array of its coefficients in that order. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_SYSTEM_H_
#define RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_SYSTEM_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "rigel/minimal/numerics/action_matrix.h"

namespace rigel::polynomial_system {

constexpr int NumMonomials(int degree) { return (degree + 1) * (degree + 2) * (degree + 3) / 6; }

// The largest degree in the table of monomials: that of the products in 6pt-stewenius.
inline constexpr int kMaxDegree = 7;

struct MonomialTable {
  std::array<std::array<uint8_t, 3>, NumMonomials(kMaxDegree)> exponents{};
  std::array<std::array<std::array<uint8_t, kMaxDegree + 1>, kMaxDegree + 1>, kMaxDegree + 1>
      index{};
  // Index of the product of a monomial of degree <= 4 with one of degree <= 2.
  std::array<std::array<uint8_t, NumMonomials(2)>, NumMonomials(4)> product{};
};

constexpr MonomialTable MakeMonomialTable() {
  MonomialTable table;
  int count = 0;
  for (int d = 0; d <= kMaxDegree; ++d) {
    for (int i = d; i >= 0; --i) {
      for (int j = d - i; j >= 0; --j) {
        const int k = d - i - j;
        table.exponents[count] = {static_cast<uint8_t>(i), static_cast<uint8_t>(j),
                                  static_cast<uint8_t>(k)};
        table.index[i][j][k] = static_cast<uint8_t>(count++);
      }
    }
  }
  for (int a = 0; a < NumMonomials(4); ++a) {
    for (int b = 0; b < NumMonomials(2); ++b) {
      const auto& p = table.exponents[a];
      const auto& q = table.exponents[b];
      table.product[a][b] = table.index[p[0] + q[0]][p[1] + q[1]][p[2] + q[2]];
    }
  }
  return table;
}

inline constexpr MonomialTable kMonomials = MakeMonomialTable();

template <int B, size_t kI, size_t... kJ>
inline void UnrolledAddTerm(double value, const double* b, double* __restrict product,
                            std::index_sequence<kJ...>) {
  ((product[kMonomials.product[kI][kJ]] += value * b[kJ]), ...);
}

template <int B, size_t... kI>
inline void UnrolledAddProduct(const double* a, const double* b, double sign,
                               double* __restrict product, std::index_sequence<kI...>) {
  (UnrolledAddTerm<B, kI>(sign * a[kI], b, product, std::make_index_sequence<NumMonomials(B)>()),
   ...);
}

// product += sign a b, where a has degree A <= 4 and b degree B <= 2. Unrolled, so that the places
// of the coefficients are constants. `product` overlaps neither a nor b.
template <int A, int B>
inline void AddProduct(const double* a, const double* b, double sign, double* __restrict product) {
  UnrolledAddProduct<B>(a, b, sign, product, std::make_index_sequence<NumMonomials(A)>());
}

template <size_t kShift, size_t... kI>
inline void UnrolledAddShifted(const double* a, double factor, double* __restrict product,
                               std::index_sequence<kI...>) {
  ((product[kMonomials.product[kI][kShift]] += factor * a[kI]), ...);
}

// product += factor a m, where a has degree A <= 4 and m is the monomial kShift, of degree <= 2.
template <int A, int kShift>
inline void AddShifted(const double* a, double factor, double* __restrict product) {
  UnrolledAddShifted<kShift>(a, factor, product, std::make_index_sequence<NumMonomials(A)>());
}

// Rows are polynomials of degree <= kDegree; columns descend in the order of the monomials.
template <int kDegree, int kMaxRows>
class MacaulayMatrix {
 public:
  static constexpr int kColumns = NumMonomials(kDegree);

  // All products of the polynomial p of degree `degree` with the monomials that keep it within
  // kDegree, p scaled to largest coefficient 1. False if p is zero or not finite.
  bool AddMultiples(const double* p, int degree) {
    const int num_coefficients = NumMonomials(degree);
    double largest = 0.0;
    double zero = 0.0;  // NaN if a coefficient is not finite
    for (int k = 0; k < num_coefficients; ++k) {
      zero += p[k] - p[k];
      largest = std::max(largest, std::abs(p[k]));
    }
    const int num_shifts = NumMonomials(kDegree - degree);
    if (zero != 0.0 || !(largest > 0.0) || num_rows_ + num_shifts > kMaxRows) return false;
    const double scale = 1.0 / largest;
    double* unshifted = rows_[num_rows_++];
    std::fill(unshifted, unshifted + kStride, 0.0);
    for (int k = 0; k < num_coefficients; ++k) unshifted[kColumns - 1 - k] = scale * p[k];
    for (int m = 1; m < num_shifts; ++m) {
      const auto& shift = kMonomials.exponents[m];
      double* row = rows_[num_rows_++];
      std::fill(row, row + kStride, 0.0);
      for (int k = 0; k < num_coefficients; ++k) {
        const auto& e = kMonomials.exponents[k];
        row[kColumns - 1 - kMonomials.index[e[0] + shift[0]][e[1] + shift[1]][e[2] + shift[2]]] =
            scale * p[k];
      }
    }
    return true;
  }

  // `leading[k]`: how many monomials of degree kDegree - k are leading monomials; all, or else the
  // best conditioned ones are taken. None may be of degree 1 or 0, and at most one of degree
  // kDegree is left over. False if a pivot vanishes or not exactly kSize monomials are left.
  template <int kSize>
  bool Reduce(const int* leading, int num_degrees, ActionMatrix<kSize>* action) {
    NormalForms<kSize> forms;
    if (!EliminateLeading(leading, num_degrees, forms.pivot_of)) return false;
    if (!forms.FindBasis(monomial_)) return false;
    // One monomial of degree kDegree is left over, and x times it is in no row.
    const bool left_over = forms.basis[kSize - 1] >= NumMonomials(kDegree - 1);
    const int num_direct = kSize - (left_over ? 1 : 0);
    SubstituteBack(left_over ? 0 : FirstPivotOf(forms, num_direct), &forms);
    for (int b = 0; b < kSize; ++b) std::fill_n(action->entries[b], kSize, 0.0);
    for (int b = 0; b < num_direct; ++b) {
      forms.Add(Times(forms.basis[b], 1, 0), 1.0, action->entries[b]);
    }
    return !left_over || ActionOnLeftOver(forms, action->entries[kSize - 1]);
  }

 private:
  static constexpr int kStride = (kColumns + 3) & ~3;  // of a row, with zeros behind it
  // Entries that a search for the largest pivot may look at. More searches condition the matrix
  // better and take more time: rigel_benchmark --solvers=6pt-stewenius prints both effects.
  static constexpr int kMaxSearch = 1000;
  static constexpr int kMaxPivots = kMaxRows < kColumns ? kMaxRows : kColumns;
  // Rows are scaled to largest coefficient 1: a pivot below this is what rounding left of a zero.
  static constexpr double kLeastPivotOfRows = 1e-14;

  // Index of the monomial m times x^i y^j.
  static int Times(int m, int i, int j) {
    const auto& e = kMonomials.exponents[m];
    return kMonomials.index[e[0] + i][e[1] + j][e[2]];
  }

  // What every monomial is in terms of those that are left, the basis.
  template <int kSize>
  struct NormalForms {
    int pivot_of[kColumns];  // of a monomial; -1: none, it is in the basis
    int basis[kSize];        // monomials
    int basis_column[kSize];
    int basis_of[kColumns];                         // of a monomial in it
    alignas(32) double reduced[kMaxPivots][kSize];  // the leading monomial of a pivot

    // False unless kSize monomials are left.
    bool FindBasis(const int* monomial_of_column) {
      int size = 0;
      for (int m = 0; m < kColumns; ++m) {
        if (pivot_of[m] >= 0) continue;
        if (size == kSize) return false;
        basis_of[m] = size;
        basis[size++] = m;
      }
      for (int c = 0; c < kColumns; ++c) {
        const int m = monomial_of_column[c];
        if (pivot_of[m] < 0) basis_column[basis_of[m]] = c;
      }
      return size == kSize;
    }

    // sum += factor m.
    void Add(int m, double factor, double* sum) const {
      if (pivot_of[m] < 0) {
        sum[basis_of[m]] += factor;
      } else {
        for (int k = 0; k < kSize; ++k) sum[k] += factor * reduced[pivot_of[m]][k];
      }
    }

    // The share of the last monomial of the basis in the monomial m.
    double ShareOfLast(int m) const {
      if (m == basis[kSize - 1]) return 1.0;
      return pivot_of[m] >= 0 ? reduced[pivot_of[m]][kSize - 1] : 0.0;
    }
  };

  // Gaussian elimination, one pivot for each leading monomial. Writes the pivot of each monomial.
  // False if a pivot vanishes.
  bool EliminateLeading(const int* leading, int num_degrees, int* pivot_of) {
    for (int c = 0; c < kColumns; ++c) monomial_[c] = kColumns - 1 - c;
    std::fill(pivot_of, pivot_of + kColumns, -1);
    num_pivots_ = 0;
    int begin = 0;
    for (int k = 0; k < num_degrees; ++k) {
      const int end = kColumns - NumMonomials(kDegree - k - 1);
      for (int c = begin; c < begin + leading[k]; ++c, ++num_pivots_) {
        // A search of all columns pays only where there are few left.
        const bool choose =
            leading[k] < end - begin && (num_rows_ - num_pivots_) * (end - c) <= kMaxSearch;
        if (!Pivot(num_pivots_, c, choose ? end : c + 1)) return false;
        column_[num_pivots_] = c;
        pivot_of[monomial_[c]] = num_pivots_;
      }
      begin = end;
    }
    return true;
  }

  // The first pivot that x times one of the first `count` monomials of the basis needs.
  template <int kSize>
  int FirstPivotOf(const NormalForms<kSize>& forms, int count) const {
    int first = num_pivots_;
    for (int b = 0; b < count; ++b) {
      const int pivot = forms.pivot_of[Times(forms.basis[b], 1, 0)];
      if (pivot >= 0) first = std::min(first, pivot);
    }
    return first;
  }

  // The leading monomials in terms of the basis, from the last pivot back to `first`.
  template <int kSize>
  void SubstituteBack(int first, NormalForms<kSize>* forms) const {
    for (int p = num_pivots_ - 1; p >= first; --p) {
      const double* row = rows_[p];
      double* out = forms->reduced[p];
      for (int k = 0; k < kSize; ++k) {
        const int column = forms->basis_column[k];
        out[k] = column > column_[p] ? -row[column] : 0.0;
      }
      for (int q = p + 1; q < num_pivots_; ++q) {
        const double factor = row[column_[q]];
        if (factor == 0.0) continue;
        for (int k = 0; k < kSize; ++k) out[k] -= factor * forms->reduced[q][k];
      }
    }
  }

  // The row of x m for the monomial m of degree kDegree that is left over. For s of degree
  // kDegree - 1 let y s = a m + A and x s = b m + B, A and B of lower degree. Then
  // x (y s) = y (x s) says a (x m) - b (y m) = y B - x A. Two such s give x m.
  template <int kSize>
  static bool ActionOnLeftOver(const NormalForms<kSize>& forms, double* row) {
    constexpr int kFirst = NumMonomials(kDegree - 2);
    constexpr int kCount = NumMonomials(kDegree - 1) - kFirst;
    double as[kCount], bs[kCount];
    int s1 = 0;
    for (int s = 0; s < kCount; ++s) {
      as[s] = forms.ShareOfLast(Times(kFirst + s, 0, 1));
      bs[s] = forms.ShareOfLast(Times(kFirst + s, 1, 0));
      if (as[s] * as[s] + bs[s] * bs[s] > as[s1] * as[s1] + bs[s1] * bs[s1]) s1 = s;
    }
    int s2 = 0;
    double det = 0.0;
    for (int s = 0; s < kCount; ++s) {
      const double value = as[s1] * bs[s] - as[s] * bs[s1];
      if (std::abs(value) > std::abs(det)) {
        det = value;
        s2 = s;
      }
    }
    if (!(std::abs(det) > kLeastPivotOfRows)) return false;
    AddCommutator(forms, kFirst + s1, bs[s2] / det, row);
    AddCommutator(forms, kFirst + s2, -bs[s1] / det, row);
    return true;
  }

  // row += weight (y B - x A) of the monomial s.
  template <int kSize>
  static void AddCommutator(const NormalForms<kSize>& forms, int s, double weight, double* row) {
    double A[kSize] = {};
    double B[kSize] = {};
    forms.Add(Times(s, 0, 1), 1.0, A);
    forms.Add(Times(s, 1, 0), 1.0, B);
    for (int k = 0; k < kSize - 1; ++k) {
      if (B[k] != 0.0) forms.Add(Times(forms.basis[k], 0, 1), weight * B[k], row);
      if (A[k] != 0.0) forms.Add(Times(forms.basis[k], 1, 0), -weight * A[k], row);
    }
  }

  // Brings the largest entry of the rows from `rank` on and the columns [c, end) to (rank, c),
  // makes it 1 and clears the column below it.
  bool Pivot(int rank, int c, int end) {
    double best = 0.0;
    int best_row = rank;
    int best_column = c;
    for (int r = rank; r < num_rows_; ++r) {
      for (int k = c; k < end; ++k) {
        if (std::abs(rows_[r][k]) > best) {
          best = std::abs(rows_[r][k]);
          best_row = r;
          best_column = k;
        }
      }
    }
    if (!(best > kLeastPivotOfRows) || !std::isfinite(best)) return false;
    if (best_column != c) {
      for (int r = 0; r < num_rows_; ++r) std::swap(rows_[r][c], rows_[r][best_column]);
      std::swap(monomial_[c], monomial_[best_column]);
    }
    double* top = rows_[rank];
    if (best_row != rank) std::swap_ranges(top + c, top + kColumns, rows_[best_row] + c);
    const double inv = 1.0 / top[c];
    top[c] = 1.0;
    for (int k = c + 1; k < kColumns; ++k) top[k] *= inv;
    // From a multiple of four on: what is left of a pivot is not read again.
    const int first = (c + 1) & ~3;
    for (int r = rank + 1; r < num_rows_; ++r) {
      double* row = rows_[r];
      const double factor = row[c];
      if (factor == 0.0) continue;
      for (int k = first; k < kStride; k += 4) {
        for (int l = 0; l < 4; ++l) row[k + l] -= factor * top[k + l];
      }
    }
    return true;
  }

  int num_rows_ = 0;
  int num_pivots_ = 0;
  int column_[kMaxRows];    // of a pivot
  int monomial_[kColumns];  // of a column
  alignas(32) double rows_[kMaxRows][kStride];
};

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_SYSTEM_H_
