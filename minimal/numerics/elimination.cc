#include "rigel/minimal/numerics/elimination.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/LU>

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
  using Rows = Eigen::Matrix<double, 6, 4, Eigen::RowMajor>;
  const Eigen::Map<const Rows> rows(M[0]);
  const Eigen::FullPivLU<Eigen::Matrix<double, 6, 4>> lu(rows);
  const Eigen::Matrix<double, 6, 4>& U = lu.matrixLU();
  Eigen::Vector4d v(0.0, 0.0, 0.0, 1.0);
  for (int r = 2; r >= 0; --r) {
    const double sum = U.row(r).tail(3 - r).dot(v.tail(3 - r));
    // A rank below 3 leaves this entry free.
    v[r] = U(r, r) != 0.0 ? -sum / U(r, r) : 0.0;
  }
  return lu.permutationQ() * v;
}

}  // namespace rigel
