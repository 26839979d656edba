#include "rigel/minimal/numerics/elimination.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace rigel {
namespace {

// With partial pivoting; the loops of each column are of constant length.
template <int kColumn>
void EliminateColumn(double (*a)[8], double* inv) {
  int best = kColumn;
  for (int r = kColumn + 1; r < 6; ++r) {
    best = std::abs(a[r][kColumn]) > std::abs(a[best][kColumn]) ? r : best;
  }
  double top[8];
  for (int k = 0; k < 8; ++k) top[k] = a[best][k];
  for (int k = 0; k < 8; ++k) a[best][k] = a[kColumn][k];
  for (int k = 0; k < 8; ++k) a[kColumn][k] = top[k];
  inv[kColumn] = 1.0 / top[kColumn];
  for (int r = kColumn + 1; r < 6; ++r) {
    const double factor = a[r][kColumn] * inv[kColumn];
    for (int k = kColumn & ~1; k < 8; ++k) a[r][k] -= factor * top[k];
  }
}

template <size_t... kColumns>
void EliminateColumns(double (*a)[8], double* inv, std::index_sequence<kColumns...>) {
  (EliminateColumn<kColumns>(a, inv), ...);
}

// Brings the largest entry of T from row and column k on to (k, k). `column` follows the columns.
void PivotCompletely(int k, double (*T)[4], int* column) {
  double largest = -1.0;
  int entry = 5 * k;
  for (int r = k; r < 6; ++r) {
    for (int c = k; c < 4; ++c) {
      const double size = std::abs(T[r][c]);
      entry = size > largest ? 4 * r + c : entry;
      largest = std::max(size, largest);
    }
  }
  const int row = entry / 4;
  const int best = entry % 4;
  if (row != k) std::swap_ranges(T[k], T[k] + 4, T[row]);
  if (best != k) {
    for (int r = 0; r < 6; ++r) std::swap(T[r][k], T[r][best]);
    std::swap(column[k], column[best]);
  }
}

}  // namespace

void SolveSixBySix(double (*a)[8], double* x) {
  double inv[6];
  EliminateColumns(a, inv, std::make_index_sequence<6>());
  for (int r = 5; r >= 0; --r) {
    double value = a[r][6];
    for (int c = r + 1; c < 6; ++c) value -= a[r][c] * x[c];
    x[r] = value * inv[r];
  }
}

Eigen::Vector4d NullVector(const double (*M)[4]) {
  double T[6][4];
  int column[4] = {0, 1, 2, 3};
  for (int r = 0; r < 6; ++r) std::copy(M[r], M[r] + 4, T[r]);
  for (int k = 0; k < 3; ++k) {
    PivotCompletely(k, T, column);
    const double inv = T[k][k] != 0.0 ? 1.0 / T[k][k] : 0.0;
    for (int r = k + 1; r < 6; ++r) {
      const double factor = T[r][k] * inv;
      for (int c = k + 1; c < 4; ++c) T[r][c] -= factor * T[k][c];
    }
  }
  double v[4];
  v[3] = 1.0;
  for (int r = 2; r >= 0; --r) {
    double sum = 0.0;
    for (int c = r + 1; c < 4; ++c) sum += T[r][c] * v[c];
    v[r] = T[r][r] != 0.0 ? -sum / T[r][r] : 0.0;
  }
  Eigen::Vector4d null;
  for (int k = 0; k < 4; ++k) null[column[k]] = v[k];
  return null;
}

}  // namespace rigel
