// Systems of polynomials in three variables with finitely many solutions: a Macaulay matrix is
// reduced to the action of multiplication by the first variable, whose real eigenvalues are the
// first coordinates of the real solutions and whose eigenvectors hold the others.
//
// The method is that of Stetter's and Moeller's eigenvectors (Cox, Little, O'Shea, "Using Algebraic
// Geometry", chapter 2); what a caller must know of its system is how many leading monomials each
// degree has (the Hilbert function), so that no rank is ever decided from numbers.
//
// Monomials x^i y^j z^k are ordered by degree, so those of degree <= d are the first
// NumMonomials(d). A polynomial is the array of its coefficients in that order. No heap.
#ifndef RIGEL_MINIMAL_POLYNOMIAL_SYSTEM_H_
#define RIGEL_MINIMAL_POLYNOMIAL_SYSTEM_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace rigel::polynomial_system {

constexpr int NumMonomials(int degree) {
  return (degree + 1) * (degree + 2) * (degree + 3) / 6;
}

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

// product += sign a b, where a has degree A <= 4 and b degree B <= 2.
template <int A, int B>
inline void AddProduct(const double* a, const double* b, double sign, double* product) {
  for (int i = 0; i < NumMonomials(A); ++i) {
    const double value = sign * a[i];
    for (int j = 0; j < NumMonomials(B); ++j) {
      product[kMonomials.product[i][j]] += value * b[j];
    }
  }
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
    for (int k = 0; k < num_coefficients; ++k) {
      if (!std::isfinite(p[k])) return false;
      largest = std::max(largest, std::abs(p[k]));
    }
    if (!(largest > 0.0)) return false;
    const double scale = 1.0 / largest;
    for (int m = 0; m < NumMonomials(kDegree - degree); ++m) {
      const auto& shift = kMonomials.exponents[m];
      double* row = rows_[num_rows_++];
      std::fill(row, row + kColumns, 0.0);
      for (int k = 0; k < num_coefficients; ++k) {
        const auto& e = kMonomials.exponents[k];
        row[kColumns - 1 -
            kMonomials.index[e[0] + shift[0]][e[1] + shift[1]][e[2] + shift[2]]] = scale * p[k];
      }
    }
    return true;
  }

  // `leading[k]`: the number of leading monomials of degree kDegree - k; all of that degree, or
  // the best conditioned ones. Writes the action of multiplication by x on the other monomials of
  // degree < kDegree, n x n with leading dimension `stride`; the first four of them are
  // 1, x, y, z. Returns n; 0 if a pivot vanishes.
  int ActionOfX(const int* leading, int num_degrees, double* action, int stride) {
    for (int c = 0; c < kColumns; ++c) monomial_[c] = kColumns - 1 - c;
    int rank = 0;
    int end = 0;
    // Free columns of finished degrees are moved behind the pivots of the next ones; what they
    // hold is carried along.
    for (int k = 0; k < num_degrees; ++k) {
      const int size = NumMonomials(kDegree - k) - NumMonomials(kDegree - k - 1);
      const int num_free_before = end - rank;
      // The block of this degree comes directly after the pivots found so far.
      for (int c = 0; num_free_before > 0 && c < size; ++c) SwapColumns(rank + c, end + c, size);
      (void)num_free_before;
      end += size;
      if (!Eliminate(rank, rank + leading[k], rank + size, leading[k] < size)) return 0;
      rank += leading[k];
    }
    return 0;
  }
};

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_POLYNOMIAL_SYSTEM_H_
