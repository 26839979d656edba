// Systems of polynomials in three variables with finitely many solutions: a Macaulay matrix is
// reduced to the action of multiplication by the first variable, whose real eigenvalues are the
// first coordinates of the real solutions and whose eigenvectors hold the others.
//
// The method is that of Auzinger, Stetter and Moeller (Cox, Little, O'Shea, "Using Algebraic
// Geometry", chapter 2). A caller must know how many leading monomials of each degree its system
// has (from the Hilbert function, computed once modulo a prime), so that no rank is ever decided
// from numbers.
//
// The real eigenvalues come from the characteristic polynomial of the Hessenberg form, by
// Descartes' rule: less work than the QR algorithm, and accurate for roots near the centre
// about which it is expanded. So variables should be scaled such that the solutions of interest are
// below 1.
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

constexpr int NumMonomials(int degree) { return (degree + 1) * (degree + 2) * (degree + 3) / 6; }

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

// The n x n action of multiplication by x on the monomials that are a basis of the solutions'
// coordinate ring: row b holds x times monomial b. The first four monomials are 1, x, y, z.
template <int kMaxSize>
struct ActionMatrix {
  int size = 0;
  // Two more rows for RealSolutions.
  double entries[kMaxSize + 2][kMaxSize];
};

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
    const int num_shifts = NumMonomials(kDegree - degree);
    if (!(largest > 0.0) || num_rows_ + num_shifts > kMaxRows) return false;
    const double scale = 1.0 / largest;
    for (int m = 0; m < num_shifts; ++m) {
      const auto& shift = kMonomials.exponents[m];
      double* row = rows_[num_rows_++];
      std::fill(row, row + kColumns, 0.0);
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
  // kDegree is left over. False if a pivot vanishes or more than kMaxSize monomials are left.
  template <int kMaxSize>
  bool Reduce(const int* leading, int num_degrees, ActionMatrix<kMaxSize>* action) {
    int monomial[kColumns];  // of a column
    for (int c = 0; c < kColumns; ++c) monomial[c] = kColumns - 1 - c;
    int pivot_of[kColumns];  // of a monomial; -1: none
    std::fill(pivot_of, pivot_of + kColumns, -1);
    int rank = 0;
    int begin = 0;
    for (int k = 0; k < num_degrees; ++k) {
      const int end = kColumns - NumMonomials(kDegree - k - 1);
      for (int c = begin; c < begin + leading[k]; ++c, ++rank) {
        // A search of all columns pays only where there are few left.
        const bool choose =
            leading[k] < end - begin && (num_rows_ - rank) * (end - c) <= kMaxSearch;
        if (!Pivot(rank, c, choose ? end : c + 1, monomial)) return false;
        column_[rank] = c;
        pivot_of[monomial[c]] = rank;
      }
      begin = end;
    }

    int basis[kMaxSize];
    int basis_column[kMaxSize];
    int basis_of[kColumns];  // of a monomial
    int n = 0;
    for (int m = 0; m < kColumns; ++m) {
      if (pivot_of[m] >= 0) continue;
      if (n == kMaxSize) return false;
      basis_of[m] = n;
      basis[n++] = m;
    }
    for (int c = 0; c < kColumns; ++c) {
      if (pivot_of[monomial[c]] < 0) basis_column[basis_of[monomial[c]]] = c;
    }
    const auto times = [](int m, int i, int j) {
      const auto& e = kMonomials.exponents[m];
      return kMonomials.index[e[0] + i][e[1] + j][e[2]];
    };
    const bool top_left = basis[n - 1] >= NumMonomials(kDegree - 1);
    int first = rank;
    for (int b = 0; b < n - (top_left ? 1 : 0); ++b) {
      const int pivot = pivot_of[times(basis[b], 1, 0)];
      if (pivot >= 0) first = std::min(first, pivot);
    }
    if (top_left) first = 0;

    // The leading monomials in terms of the others, from the last pivot back.
    double reduced[kMaxPivots][kMaxSize];
    for (int p = rank - 1; p >= first; --p) {
      const double* row = rows_[p];
      double* out = reduced[p];
      for (int k = 0; k < n; ++k) {
        out[k] = basis_column[k] > column_[p] ? -row[basis_column[k]] : 0.0;
      }
      for (int q = p + 1; q < rank; ++q) {
        const double factor = row[column_[q]];
        if (factor == 0.0) continue;
        for (int k = 0; k < n; ++k) out[k] -= factor * reduced[q][k];
      }
    }
    const auto add = [&](int m, double factor, double* out) {
      if (pivot_of[m] < 0) {
        out[basis_of[m]] += factor;
      } else {
        for (int k = 0; k < n; ++k) out[k] += factor * reduced[pivot_of[m]][k];
      }
    };
    action->size = n;
    for (int b = 0; b < n; ++b) std::fill(action->entries[b], action->entries[b] + n, 0.0);
    for (int b = 0; b < n - (top_left ? 1 : 0); ++b) {
      add(times(basis[b], 1, 0), 1.0, action->entries[b]);
    }
    if (!top_left) return true;

    // One monomial m of degree kDegree is left over, and x m is in no row. For s of degree
    // kDegree - 1 let y s = a m + A and x s = b m + B, A and B of lower degree; then
    // x (y s) = y (x s) says a (x m) - b (y m) = y B - x A. Two such s give x m.
    const int top = basis[n - 1];
    const auto share = [&](int m) {
      return m == top ? 1.0 : pivot_of[m] >= 0 ? reduced[pivot_of[m]][n - 1] : 0.0;
    };
    constexpr int kFirst = NumMonomials(kDegree - 2);
    constexpr int kCount = NumMonomials(kDegree - 1) - kFirst;
    double as[kCount], bs[kCount];
    int s1 = 0;
    for (int s = 0; s < kCount; ++s) {
      as[s] = share(times(kFirst + s, 0, 1));
      bs[s] = share(times(kFirst + s, 1, 0));
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
    if (!(std::abs(det) > 1e-14)) return false;
    double* out = action->entries[n - 1];
    for (const int side : {0, 1}) {
      const int s = side == 0 ? s1 : s2;
      const double weight = side == 0 ? bs[s2] / det : -bs[s1] / det;
      double A[kMaxSize] = {};
      double B[kMaxSize] = {};
      add(times(kFirst + s, 0, 1), 1.0, A);
      add(times(kFirst + s, 1, 0), 1.0, B);
      for (int k = 0; k < n - 1; ++k) {
        if (B[k] != 0.0) add(times(basis[k], 0, 1), weight * B[k], out);
        if (A[k] != 0.0) add(times(basis[k], 1, 0), -weight * A[k], out);
      }
    }
    return true;
  }

 private:
  static constexpr int kMaxSearch = 1000;
  static constexpr int kMaxPivots = kMaxRows < kColumns ? kMaxRows : kColumns;

  // Brings the largest entry of the rows from `rank` on and the columns [c, end) to (rank, c),
  // makes it 1 and clears the column below it.
  bool Pivot(int rank, int c, int end, int* monomial) {
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
    if (!(best > 1e-14) || !std::isfinite(best)) return false;
    if (best_column != c) {
      for (int r = 0; r < num_rows_; ++r) std::swap(rows_[r][c], rows_[r][best_column]);
      std::swap(monomial[c], monomial[best_column]);
    }
    double* top = rows_[rank];
    if (best_row != rank) std::swap_ranges(top + c, top + kColumns, rows_[best_row] + c);
    const double inv = 1.0 / top[c];
    top[c] = 1.0;
    for (int k = c + 1; k < kColumns; ++k) top[k] *= inv;
    for (int r = rank + 1; r < num_rows_; ++r) {
      double* row = rows_[r];
      const double factor = row[c];
      if (factor == 0.0) continue;
      for (int k = c + 1; k < kColumns; ++k) row[k] -= factor * top[k];
    }
    return true;
  }

  int num_rows_ = 0;
  int column_[kMaxRows];  // of a pivot
  double rows_[kMaxRows][kColumns];
};

// The real solutions that a reduced system has.
template <int kMaxSize>
class RealSolutions {
 public:
  // Destroys `action`.
  explicit RealSolutions(ActionMatrix<kMaxSize>* action) : a_(action->entries), n_(action->size) {
    ReduceToHessenberg();
  }

  // Appends the values of x to the `count` in `x`, up to kMaxSize in all; returns their new number.
  // The characteristic polynomial is expanded about `centre`, which finds the roots near it best;
  // only those nearer than 1 if `near_only`. `multiplicity` roots are known to be at the centre and
  // left out: rounding would spread them, and telling them apart is the costliest part of all.
  int FindX(double centre, bool near_only, int multiplicity, double* x, int count) const;

  // The root x of the characteristic polynomial by the secant method on the matrix itself, which
  // knows roots in a cluster better than the coefficients do.
  double Refine(double x) {
    double last = x + 1e-7 * (0.01 + std::abs(x));
    double last_value = Determinant(last);
    for (int k = 0; k < 4; ++k) {
      const double value = Determinant(x);
      const double step = value * (last - x) / (last_value - value);
      if (!(std::abs(step) < 0.05 * (0.1 + std::abs(x)))) break;
      last = x;
      last_value = value;
      x -= step;
      if (std::abs(step) < 1e-12 * (0.01 + std::abs(x))) break;
    }
    return x;
  }

  // The solution of the given x, to the accuracy of x.
  std::array<double, 3> Solution(double x) {
    EvaluateVector(x);
    double y = 0.0;
    double z = 0.0;
    for (int k = 0; k < n_; ++k) {
      y += a_[n_][k] * v_[k];
      z += a_[n_ + 1][k] * v_[k];
    }
    return {x, y / v_[0], z / v_[0]};
  }

 private:
  // H = S^-1 A S by Gaussian elimination with pivoting, its subdiagonal scaled to 1; rows n and
  // n + 1 become the rows of y and z of S (Wilkinson, "The Algebraic Eigenvalue Problem", ch. 6).
  void ReduceToHessenberg() {
    for (int k = 0; k < n_; ++k) {
      a_[n_][k] = k == 2 ? 1.0 : 0.0;
      a_[n_ + 1][k] = k == 3 ? 1.0 : 0.0;
    }
    double factors[kMaxSize];
    for (int m = 1; m < n_; ++m) {
      int pivot = m;
      for (int i = m + 1; i < n_; ++i) {
        if (std::abs(a_[i][m - 1]) > std::abs(a_[pivot][m - 1])) pivot = i;
      }
      if (pivot != m) {
        std::swap_ranges(a_[m] + m - 1, a_[m] + n_, a_[pivot] + m - 1);
        for (int r = 0; r < n_ + 2; ++r) std::swap(a_[r][m], a_[r][pivot]);
      }
      // A zero would split the matrix; a tiny number does not move its eigenvalues.
      if (std::abs(a_[m][m - 1]) < 1e-30) a_[m][m - 1] = 1e-30;
      const double inv = 1.0 / a_[m][m - 1];
      for (int i = m + 1; i < n_; ++i) {
        const double factor = a_[i][m - 1] * inv;
        factors[i] = factor;
        if (factor == 0.0) continue;
        for (int k = m; k < n_; ++k) a_[i][k] -= factor * a_[m][k];
      }
      for (int r = 0; r < n_ + 2; ++r) {
        double sum[4] = {0.0, 0.0, 0.0, 0.0};
        int i = m + 1;
        for (; i + 3 < n_; i += 4) {
          for (int l = 0; l < 4; ++l) sum[l] += factors[i + l] * a_[r][i + l];
        }
        for (; i < n_; ++i) sum[0] += factors[i] * a_[r][i];
        a_[r][m] += (sum[0] + sum[1]) + (sum[2] + sum[3]);
      }
    }
    double scale[kMaxSize];
    scale[0] = 1.0;
    for (int k = 1; k < n_; ++k) scale[k] = scale[k - 1] * a_[k][k - 1];
    for (int r = 0; r < n_ + 2; ++r) {
      const double inv = r < n_ ? 1.0 / scale[r] : 1.0;
      for (int k = r < n_ ? r : 0; k < n_; ++k) a_[r][k] *= inv * scale[k];
    }
  }

  // Hyman's method: the vector v_ for which all rows of (H - x I) v but the first vanish.
  void EvaluateVector(double x) {
    v_[n_ - 1] = 1.0;
    for (int k = n_ - 1; k > 0; --k) {
      double sum[4] = {0.0, 0.0, 0.0, 0.0};
      int j = k;
      for (; j + 3 < n_; j += 4) {
        for (int l = 0; l < 4; ++l) sum[l] += a_[k][j + l] * v_[j + l];
      }
      for (; j < n_; ++j) sum[0] += a_[k][j] * v_[j];
      v_[k - 1] = x * v_[k] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
    }
  }

  // det(x I - H).
  double Determinant(double x) {
    EvaluateVector(x);
    double value = x * v_[0];
    for (int k = 0; k < n_; ++k) value -= a_[0][k] * v_[k];
    return value;
  }

  // det((x + centre) I - H): the same recurrence in polynomials, c[0..n] ascending.
  void CharacteristicPolynomial(double centre, double* c) const {
    double p[kMaxSize][kMaxSize];
    p[n_ - 1][0] = 1.0;
    for (int k = n_ - 1; k >= 0; --k) {
      double* out = k > 0 ? p[k - 1] : c;
      out[0] = 0.0;
      for (int i = 0; i < n_ - k; ++i) out[i + 1] = p[k][i];
      for (int j = k; j < n_; ++j) {
        const double h = a_[k][j] - (j == k ? centre : 0.0);
        for (int i = 0; i < n_ - j; ++i) out[i] -= h * p[j][i];
      }
    }
  }

  double (*a_)[kMaxSize];
  int n_;
  double v_[kMaxSize];
};

// Real roots of the polynomial c of degree n <= kMax by Descartes' rule in the Bernstein basis, as
// in polynomial.h but with a degree known at run time and to the accuracy that an iteration on the
// original equations needs, not more.
template <int kMax>
class RootFinder {
 public:
  RootFinder(const double* c, int n) : n_(n) { std::copy(c, c + n + 1, c_); }

  int Find(bool near_only, double* roots) {
    count_ = 0;
    double piece[kMax + 1];
    for (int side = 0; side < (near_only ? 2 : 4); ++side) {
      const bool reversed = side >= 2;
      const bool mirrored = side % 2 == 1;
      for (int k = 0; k <= n_; ++k) {
        const double value = reversed ? c_[n_ - k] : c_[k];
        piece[k] = mirrored && k % 2 == 1 ? -value : value;
      }
      const int first = count_;
      UnitInterval(piece, roots);
      for (int k = first; k < count_; ++k) {
        const double x = mirrored ? -roots[k] : roots[k];
        roots[k] = reversed ? 1.0 / x : x;
      }
    }
    return count_;
  }

 private:
  static double Horner(const double* c, int n, double x) {
    double value = c[n];
    for (int k = n - 1; k >= 0; --k) value = value * x + c[k];
    return value;
  }

  void UnitInterval(const double* c, double* roots) {
    struct Piece {
      double low, width;
      double b[kMax + 1];
    };
    constexpr int kMaxLevel = 24;
    Piece stack[kMaxLevel + 2];
    double binomial = 1.0;
    for (int j = 0; j <= n_; ++j) {
      stack[0].b[j] = c[j] / binomial;
      binomial = binomial * (n_ - j) / (j + 1);
    }
    for (int j = 1; j <= n_; ++j) {
      double* b = stack[0].b;
      for (int k = n_; k >= j; --k) b[k] += b[k - 1];
    }
    stack[0].low = 0.0;
    stack[0].width = 1.0;
    int top = 0;
    while (top >= 0 && count_ < kMax) {
      Piece& piece = stack[top];
      int variations = 0;
      for (int k = 0; k < n_; ++k) variations += (piece.b[k] < 0) != (piece.b[k + 1] < 0);
      if (variations == 0) {
        --top;
      } else if (variations == 1) {
        roots[count_++] = Refine(c, piece.low, piece.b[0], piece.low + piece.width, piece.b[n_]);
        --top;
      } else if (top > kMaxLevel) {
        roots[count_++] = piece.low + 0.5 * piece.width;
        --top;
      } else {
        Piece& right = stack[top + 1];
        std::copy(piece.b, piece.b + n_ + 1, right.b);
        for (int k = 0; k < n_; ++k) {
          piece.b[k] = right.b[0];
          for (int i = 0; i < n_ - k; ++i) right.b[i] = 0.5 * (right.b[i] + right.b[i + 1]);
        }
        piece.b[n_] = right.b[0];
        piece.width *= 0.5;
        right.low = piece.low + piece.width;
        right.width = piece.width;
        ++top;
      }
    }
  }

  double Refine(const double* c, double a, double fa, double b, double fb) {
    double x = b;
    for (int k = 0; k < 40; ++k) {
      x = (a * fb - b * fa) / (fb - fa);
      if (!(x > std::min(a, b) && x < std::max(a, b)) || k % 8 == 7) x = 0.5 * (a + b);
      if (std::abs(b - a) <= 1e-10 * std::abs(x)) break;
      const double fx = Horner(c, n_, x);
      if (fx == 0.0 || !std::isfinite(fx)) break;
      const bool small_step = std::abs(x - b) <= 1e-9 * std::abs(x);
      if ((fx < 0) != (fb < 0)) {
        a = b;
        fa = fb;
      } else {
        const double weight = 1.0 - fx / fb;
        fa *= weight > 0 ? weight : 0.5;
      }
      b = x;
      fb = fx;
      if (small_step) break;
    }
    return x;
  }

  int n_;
  int count_ = 0;
  double c_[kMax + 1];
};

template <int kMaxSize>
int RealSolutions<kMaxSize>::FindX(double centre, bool near_only, int multiplicity, double* x,
                                   int count) const {
  double c[kMaxSize + 1];
  double roots[kMaxSize];
  CharacteristicPolynomial(centre, c);
  const int num_roots =
      RootFinder<kMaxSize>(c + multiplicity, n_ - multiplicity).Find(near_only, roots);
  for (int k = 0; k < num_roots && count < kMaxSize; ++k) x[count++] = roots[k] + centre;
  return count;
}

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_POLYNOMIAL_SYSTEM_H_
