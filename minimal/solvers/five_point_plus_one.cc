#include "rigel/minimal/solvers/five_point_plus_one.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/core/cheirality.h"
#include "rigel/core/depth_terms.h"
#include "rigel/core/pose.h"
#include "rigel/minimal/numerics/polynomial.h"

namespace rigel {
namespace {

// Below this, relative to the rest, the sixth match says nothing about the scale: the rotation
// that it is multiplied by is known to a few digits less than a double has.
constexpr double kBlind = 1e-7;

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

// A rotation near a nearly orthogonal matrix, exact to rounding (Gram-Schmidt).
Eigen::Matrix3d Orthonormalized(const Eigen::Matrix3d& M) {
  Eigen::Matrix3d R;
  R.col(0) = M.col(0).normalized();
  R.col(1) = (M.col(1) - R.col(0).dot(M.col(1)) * R.col(0)).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

// R and the unit vector b of E = [b]x R up to sign that have most of the five points in front of
// both cameras. False if those are fewer than three: no motion, or five that do not agree.
bool Decompose(const Eigen::Matrix3d& E, const Eigen::Vector3d* x1, const Eigen::Vector3d* x2,
               Eigen::Matrix3d* R, Eigen::Vector3d* b) {
  // The columns of the cofactor matrix of [b]x R = b b'R are multiples of b.
  Eigen::Matrix3d cofactor;
  cofactor.col(0) = E.col(1).cross(E.col(2));
  cofactor.col(1) = E.col(2).cross(E.col(0));
  cofactor.col(2) = E.col(0).cross(E.col(1));
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (cofactor.col(k).squaredNorm() > cofactor.col(best).squaredNorm()) best = k;
  }
  *b = cofactor.col(best).normalized();
  Eigen::Matrix3d bE;
  for (int k = 0; k < 3; ++k) bE.col(k) = b->cross(E.col(k));
  // b b'R - [b]x [b]x R = R; the other sign of b E gives (2 b b' - I) R.
  *R = cofactor - bE;

  int votes[4] = {};  // (R, b), (R, -b), (2bb'R - R, b), (2bb'R - R, -b)
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d g = *R * x1[k];
    const Eigen::Vector3d& f = x2[k];
    const DepthTerms d = DepthTermsOf(g[0], g[1], g[2], f[0], f[1], f[2], b->x(), b->y(), b->z());
    // The same with 2 (b.g) b - g for g.
    const Eigen::Vector3d fb = f.cross(*b);
    const double twice = 2.0 * b->dot(g);
    const double e1 = -twice * fb.squaredNorm() - d.n1;
    const double e2 = twice * g.cross(*b).dot(fb) + d.n2;
    votes[0] += d.n1 > kNoParallax && d.n2 > kNoParallax;
    votes[1] += d.n1 < -kNoParallax && d.n2 < -kNoParallax;
    votes[2] += e1 > kNoParallax && e2 > kNoParallax;
    votes[3] += e1 < -kNoParallax && e2 < -kNoParallax;
  }
  int choice = 0;
  for (int k = 1; k < 4; ++k) {
    if (votes[k] > votes[choice]) choice = k;
  }
  if (votes[choice] < 3) return false;
  if (choice >= 2) *R = cofactor + bE;
  if (choice % 2 == 1) *b = -*b;
  *R = Orthonormalized(*R);
  return true;
}

// The five constraints b . (R x1 x x2) = 0, linear in a left perturbation d of R and in b + T e:
// M[k][0..4] . (d, e) = M[k][5]. Returns the largest |M[k][5]|.
double Linearize(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2, const Eigen::Matrix3d& R,
                 const Eigen::Vector3d& b, const Eigen::Matrix<double, 3, 2>& T, double (*M)[6]) {
  double largest = 0.0;
  for (int k = 0; k < 5; ++k) {
    const Eigen::Vector3d g = R * x1[k];
    const Eigen::Vector3d n = g.cross(x2[k]);
    const Eigen::Vector3d turn = g.cross(x2[k].cross(b));
    for (int i = 0; i < 3; ++i) M[k][i] = turn[i];
    M[k][3] = n.dot(T.col(0));
    M[k][4] = n.dot(T.col(1));
    M[k][5] = -n.dot(b);
    largest = std::max(largest, std::abs(M[k][5]));
  }
  return largest;
}

// Solves M[k][0..4] . d = M[k][5] by elimination with partial pivoting, in place; returns sum |d|,
// which is not finite if the rows are dependent.
double SolveFiveByFive(double (*M)[6], double* d) {
  for (int p = 0; p < 5; ++p) {
    int best = p;
    for (int r = p + 1; r < 5; ++r) {
      if (std::abs(M[r][p]) > std::abs(M[best][p])) best = r;
    }
    for (int k = p; k < 6; ++k) std::swap(M[p][k], M[best][k]);
    const double inverse = 1.0 / M[p][p];
    for (int r = p + 1; r < 5; ++r) {
      const double factor = M[r][p] * inverse;
      for (int k = p + 1; k < 6; ++k) M[r][k] -= factor * M[p][k];
    }
  }
  double size = 0.0;
  for (int p = 4; p >= 0; --p) {
    double sum = M[p][5];
    for (int k = p + 1; k < 5; ++k) sum -= M[p][k] * d[k];
    d[p] = sum / M[p][p];
    size += std::abs(d[p]);
  }
  return size;
}

// Newton steps on the five constraints b . (R x1 x x2) = 0 themselves. Rounding in the polynomial
// leaves an error above 1e-7 rad in one motion of a hundred.
void Refine(const Eigen::Vector3d* x1, const Eigen::Vector3d* x2, Eigen::Matrix3d* R,
            Eigen::Vector3d* b) {
  // Each squares the error: from 1e-3, which no root of the polynomial has, to rounding.
  constexpr int kMaxSteps = 3;
  constexpr double kSolved = 1e-13;  // of a constraint, whose vectors have unit length: rounding
  // Radians. A step that is not small comes of a double root: the start is as good.
  constexpr double kMaxStep = 0.1;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Matrix<double, 3, 2> T = TangentBasis(*b);
    double M[5][6];
    if (!(Linearize(x1, x2, *R, *b, T, M) > kSolved)) return;
    double d[5];
    if (!(SolveFiveByFive(M, d) < kMaxStep)) return;
    for (int k = 0; k < 3; ++k) {
      R->col(k) += Eigen::Vector3d(d[0], d[1], d[2]).cross(Eigen::Vector3d(R->col(k)));
    }
    *R = Orthonormalized(*R);
    *b = (*b + d[3] * T.col(0) + d[4] * T.col(1)).normalized();
  }
}

}  // namespace

int Solve5ptPlusOne(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const PreparedMatch& first = matches[sample[0]];
  Eigen::Vector3d x1[5], x2[5];
  for (int k = 0; k < 5; ++k) {
    const PreparedMatch& m = matches[sample[k]];
    if (m.camera1 != first.camera1 || m.camera2 != first.camera2) return 0;
    x1[k] = matches.rays(sample[k]).ray1.x;
    x2[k] = matches.rays(sample[k]).ray2.x;
  }
  const RayPair& five = matches.rays(sample[0]);
  const RayPair& sixth = matches.rays(sample[5]);
  const PreparedMatch& last = matches[sample[5]];
  if (!std::isfinite(last.parallax2)) return 0;
  const bool same_pair = last.camera1 == first.camera1 && last.camera2 == first.camera2;

  double basis[4][9];
  NullSpace(x1, x2, basis);
  Cubic rows[10];
  EssentialConstraints(basis, rows);
  if (!Eliminate(rows)) return 0;
  const HiddenVariableMatrix B(rows);
  double c[11];
  B.Determinant(c);
  double roots[10];
  const int num_roots = RealRoots<10>(c, roots);

  for (int n = 0; n < num_roots; ++n) {
    const Eigen::Vector3d xy1 = B.NullVector(roots[n]);
    const double weights[4] = {xy1.x(), xy1.y(), roots[n] * xy1.z(), xy1.z()};
    Eigen::Matrix3d E;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        E(i, j) = weights[0] * basis[0][3 * i + j] + weights[1] * basis[1][3 * i + j] +
                  weights[2] * basis[2][3 * i + j] + weights[3] * basis[3][3 * i + j];
      }
    }
    const double norm2 = E.squaredNorm();
    if (!(norm2 > 0.0) || !std::isfinite(norm2)) continue;
    E *= std::sqrt(2.0 / norm2);

    Eigen::Matrix3d R;
    Eigen::Vector3d b;
    if (!Decompose(E, x1, x2, &R, &b)) continue;
    Refine(x1, x2, &R, &b);

    // The sixth match: normal . (length b + arm) = 0, its own baseline in the brackets.
    double length = 1.0;
    bool has_scale = false;
    if (!same_pair) {
      const Eigen::Vector3d normal = (R * sixth.ray1.x).cross(sixth.ray2.x);
      const Eigen::Vector3d apart1 = sixth.ray1.s - five.ray1.s;
      const Eigen::Vector3d apart2 = sixth.ray2.s - five.ray2.s;
      const double along = normal.dot(b);
      const double across = -normal.dot(R * apart1 - apart2);
      const double size = apart1.norm() + apart2.norm();
      has_scale = std::abs(across) > kBlind * size * normal.norm() &&
                  std::abs(along) > kBlind * normal.norm() && across / along > 0;
      if (has_scale) length = across / along;
    }
    Solution& solution = solutions->Append();
    solution.R = R;
    solution.t = length * b - (R * five.ray1.s - five.ray2.s);
    solution.has_scale = has_scale;
  }
  return solutions->size();
}

}  // namespace rigel
