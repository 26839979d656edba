#include "rigel/minimal/solvers/five_point_essential.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "rigel/minimal/numerics/polynomial.h"

namespace rigel {
namespace {

// Polynomials in (x, y, z) by their coefficients:
//   linear     x, y, z, 1
//   quadratic  x2, xy, y2, xz, yz, z2, x, y, z, 1
//   cubic      x3, y3, x2y, xy2, x2z, x2, y2z, y2, xyz, xy, | xz2, xz, x, yz2, yz, y, z3, z2, z, 1
// the cubic's in the order in which the elimination wants them.
using Linear = double[4];
using Quadratic = double[10];
using Cubic = double[20];

// q += sign a b.
inline void AddProduct(const Linear& a, const Linear& b, double sign, Quadratic* q) {
  double* out = *q;
  const double x = sign * a[0];
  const double y = sign * a[1];
  const double z = sign * a[2];
  const double w = sign * a[3];
  out[0] += x * b[0];
  out[1] += x * b[1] + y * b[0];
  out[2] += y * b[1];
  out[3] += x * b[2] + z * b[0];
  out[4] += y * b[2] + z * b[1];
  out[5] += z * b[2];
  out[6] += x * b[3] + w * b[0];
  out[7] += y * b[3] + w * b[1];
  out[8] += z * b[3] + w * b[2];
  out[9] += w * b[3];
}

// c += q a.
inline void AddProduct(const Quadratic& q, const Linear& a, Cubic* c) {
  double* out = *c;
  const double x = a[0];
  const double y = a[1];
  const double z = a[2];
  const double w = a[3];
  out[0] += q[0] * x;
  out[1] += q[2] * y;
  out[2] += q[0] * y + q[1] * x;
  out[3] += q[1] * y + q[2] * x;
  out[4] += q[0] * z + q[3] * x;
  out[5] += q[0] * w + q[6] * x;
  out[6] += q[2] * z + q[4] * y;
  out[7] += q[2] * w + q[7] * y;
  out[8] += q[1] * z + q[3] * y + q[4] * x;
  out[9] += q[1] * w + q[6] * y + q[7] * x;
  out[10] += q[3] * z + q[5] * x;
  out[11] += q[3] * w + q[6] * z + q[8] * x;
  out[12] += q[6] * w + q[9] * x;
  out[13] += q[4] * z + q[5] * y;
  out[14] += q[4] * w + q[7] * z + q[8] * y;
  out[15] += q[7] * w + q[9] * y;
  out[16] += q[5] * z;
  out[17] += q[5] * w + q[8] * z;
  out[18] += q[8] * w + q[9] * z;
  out[19] += q[9] * w;
}

// A Householder reflection I - beta v v' of R^9; v is zero before entry k.
struct Reflection {
  int k;
  double beta;  // 2 / |v|^2; a zero vector gives an infinity, and no solution
  const double* v;

  // The one that leaves `x` no entry after k. x becomes v.
  static Reflection Of(int k, double* x) {
    double norm2 = 0.0;
    for (int i = k; i < 9; ++i) norm2 += x[i] * x[i];
    const double norm = std::sqrt(norm2);
    x[k] = x[k] >= 0 ? x[k] + norm : x[k] - norm;
    return {k, 1.0 / (norm * std::abs(x[k])), x};
  }

  void Apply(double* x) const {
    double dot = 0.0;
    for (int i = k; i < 9; ++i) dot += v[i] * x[i];
    dot *= beta;
    for (int i = k; i < 9; ++i) x[i] -= dot * v[i];
  }
};

// The orthonormal basis of the null space of the five epipolar constraints; basis[n][3 i + j] is
// entry (i, j) of its n-th matrix.
void NullSpace(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2, double basis[4][9]) {
  double rows[5][9];
  for (int k = 0; k < 5; ++k) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rows[k][3 * i + j] = x2[k][i] * x1[k][j];
    }
  }
  Reflection reflections[5];
  for (int k = 0; k < 5; ++k) {
    reflections[k] = Reflection::Of(k, rows[k]);
    for (int l = k + 1; l < 5; ++l) reflections[k].Apply(rows[l]);
  }
  for (int n = 0; n < 4; ++n) {
    double* e = basis[n];
    for (int i = 0; i < 9; ++i) e[i] = 0.0;
    e[5 + n] = 1.0;
    for (int k = 4; k >= 0; --k) reflections[k].Apply(e);
  }
}

// The ten cubics that make x X + y Y + z Z + W an essential matrix.
void EssentialConstraints(const double basis[4][9], Cubic rows[10]) {
  Linear E[9];
  for (int i = 0; i < 9; ++i) {
    for (int n = 0; n < 4; ++n) E[i][n] = basis[n][i];
  }
  for (int r = 0; r < 10; ++r) {
    for (int k = 0; k < 20; ++k) rows[r][k] = 0.0;
  }

  // E E' - tr(E E') / 2, its upper triangle: (0,0), (0,1), (0,2), (1,1), (1,2), (2,2).
  constexpr int kIndex[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  Quadratic L[6] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) AddProduct(E[3 * i + k], E[3 * j + k], 1.0, &L[kIndex[i][j]]);
    }
  }
  for (int k = 0; k < 10; ++k) {
    const double half_trace = 0.5 * (L[0][k] + L[3][k] + L[5][k]);
    L[0][k] -= half_trace;
    L[3][k] -= half_trace;
    L[5][k] -= half_trace;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) AddProduct(L[kIndex[i][k]], E[3 * k + j], &rows[3 * i + j]);
    }
  }

  for (int j = 0; j < 3; ++j) {
    const int j1 = (j + 1) % 3;
    const int j2 = (j + 2) % 3;
    Quadratic cofactor = {};
    AddProduct(E[3 + j1], E[6 + j2], 1.0, &cofactor);
    AddProduct(E[3 + j2], E[6 + j1], -1.0, &cofactor);
    AddProduct(cofactor, E[j], &rows[9]);
  }
}

// Brings the largest entry of column p to row p, makes it 1 and clears the column below it. False
// if there is none.
bool ClearColumn(int p, double** row) {
  // Of entries near 1, as the basis is orthonormal: less is rounding, and the constraints
  // dependent.
  constexpr double kMinPivot = 1e-10;
  int best = p;
  for (int r = p + 1; r < 10; ++r) {
    if (std::abs(row[r][p]) > std::abs(row[best][p])) best = r;
  }
  std::swap(row[p], row[best]);
  const double pivot = row[p][p];
  if (!(std::abs(pivot) > kMinPivot)) return false;
  const double inverse = 1.0 / pivot;
  for (int k = p + 1; k < 20; ++k) row[p][k] *= inverse;
  for (int r = p + 1; r < 10; ++r) {
    const double factor = row[r][p];
    for (int k = p + 1; k < 20; ++k) row[r][k] -= factor * row[p][k];
  }
  return true;
}

// Gauss elimination of the first ten columns with row pivoting, back substitution as far as rows
// 4 to 9 need it: in those, columns 10 to 19 become the remainders of x2z, x2, y2z, y2, xyz, xy.
// False if the constraints are dependent.
bool Eliminate(Cubic rows[10]) {
  double* row[10];
  for (int r = 0; r < 10; ++r) row[r] = rows[r];
  for (int p = 0; p < 10; ++p) {
    if (!ClearColumn(p, row)) return false;
  }
  for (int p = 9; p > 4; --p) {
    for (int r = 4; r < p; ++r) {
      const double factor = row[r][p];
      for (int k = 10; k < 20; ++k) row[r][k] -= factor * row[p][k];
    }
  }
  // Hand the permuted rows back in order.
  double ordered[6][10];
  for (int r = 0; r < 6; ++r) std::copy(row[4 + r] + 10, row[4 + r] + 20, ordered[r]);
  for (int r = 0; r < 6; ++r) std::copy(ordered[r], ordered[r] + 10, rows[4 + r] + 10);
  return true;
}

// B(z): columns of x and y are cubic, that of 1 quartic.
struct HiddenVariableMatrix {
  double x[3][4], y[3][4], w[3][5];

  explicit HiddenVariableMatrix(const Cubic rows[10]) {
    for (int r = 0; r < 3; ++r) {
      // Upper row (say of x2z) minus z times the lower one (of x2).
      const double* u = rows[4 + 2 * r] + 10;
      const double* l = rows[5 + 2 * r] + 10;
      x[r][0] = u[2];
      x[r][1] = u[1] - l[2];
      x[r][2] = u[0] - l[1];
      x[r][3] = -l[0];
      y[r][0] = u[5];
      y[r][1] = u[4] - l[5];
      y[r][2] = u[3] - l[4];
      y[r][3] = -l[3];
      w[r][0] = u[9];
      w[r][1] = u[8] - l[9];
      w[r][2] = u[7] - l[8];
      w[r][3] = u[6] - l[7];
      w[r][4] = -l[6];
    }
  }

  void Determinant(double c[11]) const {
    for (int k = 0; k < 11; ++k) c[k] = 0.0;
    for (int r = 0; r < 3; ++r) {
      const int i = (r + 1) % 3;
      const int j = (r + 2) % 3;
      double minor[7] = {};
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) minor[a + b] += x[i][a] * y[j][b] - x[j][a] * y[i][b];
      }
      for (int a = 0; a < 5; ++a) {
        for (int b = 0; b < 7; ++b) c[a + b] += w[r][a] * minor[b];
      }
    }
  }

  // (x, y, 1) times a factor: the cross product of the best conditioned pair of rows.
  Eigen::Vector3d NullVector(double z) const {
    Eigen::Vector3d row[3];
    for (int r = 0; r < 3; ++r) {
      row[r] = {EvaluatePolynomial<3>(x[r], z), EvaluatePolynomial<3>(y[r], z),
                EvaluatePolynomial<4>(w[r], z)};
    }
    Eigen::Vector3d best = row[0].cross(row[1]);
    for (int r = 1; r < 3; ++r) {
      const Eigen::Vector3d v = row[r].cross(row[(r + 1) % 3]);
      if (v.squaredNorm() > best.squaredNorm()) best = v;
    }
    return best;
  }
};

}  // namespace

int FivePointEssentialMatrices(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2,
                               Eigen::Matrix3d* E) {
  double basis[4][9];
  NullSpace(x1, x2, basis);
  Cubic rows[10];
  EssentialConstraints(basis, rows);
  if (!Eliminate(rows)) return 0;
  const HiddenVariableMatrix B(rows);
  double c[11];
  B.Determinant(c);
  double roots[kMaxEssentialMatrices];
  const int num_roots = RealRoots<10>(c, roots);

  int count = 0;
  for (int n = 0; n < num_roots; ++n) {
    const Eigen::Vector3d xy1 = B.NullVector(roots[n]);
    const double weights[4] = {xy1.x(), xy1.y(), roots[n] * xy1.z(), xy1.z()};
    Eigen::Matrix3d& e = E[count];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        e(i, j) = weights[0] * basis[0][3 * i + j] + weights[1] * basis[1][3 * i + j] +
                  weights[2] * basis[2][3 * i + j] + weights[3] * basis[3][3 * i + j];
      }
    }
    const double norm2 = e.squaredNorm();
    if (!(norm2 > 0.0) || !std::isfinite(norm2)) continue;
    e *= std::sqrt(2.0 / norm2);
    ++count;
  }
  return count;
}

}  // namespace rigel
