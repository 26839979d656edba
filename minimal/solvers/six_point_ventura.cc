#include "rigel/minimal/solvers/six_point_ventura.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>

#include "rigel/minimal/numerics/polynomial_system.h"
#include "rigel/minimal/numerics/twenty_solutions.h"
#include "rigel/minimal/solvers/six_point_system.h"

namespace rigel {
namespace {

using polynomial_system::ActionMatrix;
using polynomial_system::AddProduct;
using polynomial_system::AddShifted;
using polynomial_system::FindTwentySolutions;
using polynomial_system::MacaulayMatrix;
using polynomial_system::NumMonomials;

constexpr int kQuadric = NumMonomials(2);
constexpr int kCubic = NumMonomials(3);
constexpr int kQuartic = NumMonomials(4);

// The unit of r, radians: the rotations that the model is meant for are below it.
constexpr double kUnit = 0.05;

// One row of M(r): linear functions of r / kUnit, coefficients of 1, x, y, z.
struct Row {
  double entry[4][4];
};

// C rotates both frames.
Row MakeRow(const RayPair& rays, const Eigen::Matrix3d& C) {
  const Eigen::Vector3d x = C * rays.ray1.x;
  const Eigen::Vector3d y = C * rays.ray2.x;
  const Eigen::Vector3d p = C * rays.ray1.Moment();
  const Eigen::Vector3d q = C * rays.ray2.Moment();
  // n = (x + r x x) x y = x x y + x (r.y) - r (x.y);  k = y.p + q.x + r . (p x y + x x q).
  const Eigen::Vector3d n = x.cross(y);
  const Eigen::Vector3d k = p.cross(y) + x.cross(q);
  const double xy = x.dot(y);
  Row row;
  for (int i = 0; i < 3; ++i) {
    row.entry[i][0] = n[i];
    for (int j = 0; j < 3; ++j) {
      row.entry[i][1 + j] = kUnit * (x[i] * y[j] - (i == j ? xy : 0.0));
    }
  }
  row.entry[3][0] = y.dot(p) + q.dot(x);
  for (int j = 0; j < 3; ++j) row.entry[3][1 + j] = kUnit * k[j];
  return row;
}

// Subtracts `factor` times the row `from` from the row `to`.
void Subtract(const Row& from, double factor, Row* to) {
  for (int c = 0; c < 4; ++c) {
    for (int k = 0; k < 4; ++k) to->entry[c][k] -= factor * from.entry[c][k];
  }
}

// Exchanges row `begin` with that of the largest coefficient k in column 0 among it and those after
// it; returns that coefficient.
double BringPivotTo(int begin, int k, Row* rows) {
  int best = begin;
  for (int m = begin + 1; m < 6; ++m) {
    if (std::abs(rows[m].entry[0][k]) > std::abs(rows[best].entry[0][k])) best = m;
  }
  if (best != begin) std::swap(rows[best], rows[begin]);
  return rows[begin].entry[0][k];
}

// Combines the rows such that the linear parts of column 0 become x, y, z, 0, 0, 0. False if they
// are of rank below 3.
bool MakeLinearPartsUnit(Row* rows) {
  constexpr double kMinPivot = 1e-6;  // of the largest one: below it the rank is doubtful
  double largest = 0.0;
  for (int rank = 0; rank < 3; ++rank) {
    const double pivot = BringPivotTo(rank, 1 + rank, rows);
    largest = std::max(largest, std::abs(pivot));
    if (!(std::abs(pivot) > kMinPivot * largest)) return false;
    const double inv = 1.0 / pivot;
    for (auto& entry : rows[rank].entry) {
      for (double& coefficient : entry) coefficient *= inv;
    }
    for (int m = 0; m < 6; ++m) {
      if (m != rank) Subtract(rows[rank], rows[m].entry[0][1 + rank], &rows[m]);
    }
  }
  return true;
}

// Combines the rows such that column 0 becomes x + a, y + b, z + c, d, 0, 0 (a to d constants),
// which leaves little to multiply there. Columns 0 to 2 may change places. False if no column
// allows it: its six linear parts are of rank below 3.
bool CombineRows(Row* rows) {
  for (int column = 0; column < 3; ++column) {
    if (column > 0) {
      for (int m = 0; m < 6; ++m) std::swap(rows[m].entry[0], rows[m].entry[column]);
    }
    if (!MakeLinearPartsUnit(rows)) continue;
    const double constant = BringPivotTo(3, 0, rows);
    if (constant == 0.0) return true;
    for (int m = 4; m < 6; ++m) Subtract(rows[3], rows[m].entry[0][0] / constant, &rows[m]);
    return true;
  }
  return false;
}

// Where the sets of three of six rows, as bits, are kept.
struct TripleTable {
  int index[64] = {};
  constexpr TripleTable() {
    int count = 0;
    for (int bits = 0; bits < 64; ++bits) {
      int size = 0;
      for (int m = 0; m < 6; ++m) size += bits >> m & 1;
      if (size == 3) index[bits] = count++;
    }
  }
};

// The 2 x 2 minors of columns 1 and 2.
void PairMinors(const Row* rows, double (*pairs)[6][kQuadric]) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      const auto& a = rows[i].entry;
      const auto& b = rows[j].entry;
      std::fill(pairs[i][j], pairs[i][j] + kQuadric, 0.0);
      AddProduct<1, 1>(a[1], b[2], 1.0, pairs[i][j]);
      AddProduct<1, 1>(a[2], b[1], -1.0, pairs[i][j]);
    }
  }
}

constexpr TripleTable kTriples;

// The 3 x 3 minors of columns 1 to 3.
void TripleMinors(const Row* rows, double (*triples)[kCubic]) {
  double pairs[6][6][kQuadric];
  PairMinors(rows, pairs);
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      for (int k = j + 1; k < 6; ++k) {
        double* out = triples[kTriples.index[1 << i | 1 << j | 1 << k]];
        std::fill(out, out + kCubic, 0.0);
        AddProduct<2, 1>(pairs[i][j], rows[k].entry[3], 1.0, out);
        AddProduct<2, 1>(pairs[i][k], rows[j].entry[3], -1.0, out);
        AddProduct<2, 1>(pairs[j][k], rows[i].entry[3], 1.0, out);
      }
    }
  }
}

// The 4 x 4 minor of the four rows of `set`, by Laplace expansion along column 0.
void Minor(const Row* rows, const double (*triples)[kCubic], int set, double* minor) {
  double sign = 1.0;
  for (int m = 0; m < 4; ++m) {
    if ((set >> m & 1) == 0) continue;
    const double* triple = triples[kTriples.index[set & ~(1 << m)]];
    if (m == 0) AddShifted<3, 1>(triple, sign, minor);
    if (m == 1) AddShifted<3, 2>(triple, sign, minor);
    if (m == 2) AddShifted<3, 3>(triple, sign, minor);
    const double constant = sign * rows[m].entry[0][0];
    for (int n = 0; n < kCubic; ++n) minor[n] += constant * triple[n];
    sign = -sign;
  }
}

// Adds the fifteen 4 x 4 minors. False if one is zero or not finite.
bool AddMinors(const Row* rows, MacaulayMatrix<4, 15>* macaulay) {
  double triples[20][kCubic];
  TripleMinors(rows, triples);
  // All rows but two, (0, 1) first.
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      double minor[kQuartic] = {};
      Minor(rows, triples, 63 & ~(1 << i | 1 << j), minor);
      if (!macaulay->AddMultiples(minor, 4)) return false;
    }
  }
  return true;
}

// Newton's method on M(r) (t, w)' = 0.
bool Polish(const Row* rows, Eigen::Vector3d* r, Eigen::Vector4d* v) {
  const auto evaluate = [&](const Eigen::Vector4d& tw, double(*M)[4], double(*D)[3]) {
    const double x = (*r)[0];
    const double y = (*r)[1];
    const double z = (*r)[2];
    for (int m = 0; m < 6; ++m) {
      const auto& e = rows[m].entry;
      for (int c = 0; c < 4; ++c) M[m][c] = e[c][0] + e[c][1] * x + e[c][2] * y + e[c][3] * z;
      for (int j = 0; j < 3; ++j) {
        D[m][j] = (e[0][1 + j] * tw[0] + e[1][1 + j] * tw[1]) +
                  (e[2][1 + j] * tw[2] + e[3][1 + j] * tw[3]);
      }
    }
  };
  return PolishSixPoint(
      evaluate, [r](const Eigen::Vector3d& d) { *r += d; }, v);
}

}  // namespace

int Solve6ptVentura(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  SixPointSystem system(matches, sample, solutions);
  if (!system.solvable()) return 0;
  const Eigen::Matrix3d B = SixPointBasis();
  Row rows[6];
  for (int m = 0; m < 6; ++m) rows[m] = MakeRow(system.rays(m), B);
  MacaulayMatrix<4, 15> macaulay;
  Row combined[6];
  std::copy(rows, rows + 6, combined);
  if (!CombineRows(combined) || !AddMinors(combined, &macaulay)) return 0;
  // Degree 4: all of them; 20 monomials are left.
  constexpr int kLeading[] = {15};
  ActionMatrix<20> action;
  if (!macaulay.Reduce(kLeading, 1, &action)) return 0;
  double starts[20][3];
  const int num_roots = FindTwentySolutions(system.zero_motion_multiplicity(), &action, starts);
  for (int k = 0; k < num_roots; ++k) {
    Eigen::Vector3d r(starts[k][0], starts[k][1], starts[k][2]);
    Eigen::Vector4d v;
    if (!r.allFinite() || !Polish(rows, &r, &v)) continue;
    v.head<3>() = (B.transpose() * v.head<3>()).eval();
    system.Add(ExpSO3(kUnit * (B.transpose() * r)), v);
  }
  return solutions->size();
}

}  // namespace rigel
