#include "rigel/minimal/six_point_ventura.h"

#include <algorithm>

#include <Eigen/Core>

#include "rigel/minimal/polynomial_system.h"
#include "rigel/minimal/six_point_system.h"

namespace rigel {
namespace {

using polynomial_system::ActionMatrix;
using polynomial_system::AddProduct;
using polynomial_system::MacaulayMatrix;
using polynomial_system::NumMonomials;
using polynomial_system::RealSolutions;

constexpr int kQuadric = NumMonomials(2);
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

// The fifteen 4 x 4 minors by Laplace expansion. False if one is zero or not finite.
bool AddMinors(const Row* rows, MacaulayMatrix<4, 15>* macaulay) {
  double first[6][6][kQuadric] = {};   // minors of columns 0 and 1
  double second[6][6][kQuadric] = {};  // of columns 2 and 3
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      const auto& a = rows[i].entry;
      const auto& b = rows[j].entry;
      AddProduct<1, 1>(a[0], b[1], 1.0, first[i][j]);
      AddProduct<1, 1>(a[1], b[0], -1.0, first[i][j]);
      AddProduct<1, 1>(a[2], b[3], 1.0, second[i][j]);
      AddProduct<1, 1>(a[3], b[2], -1.0, second[i][j]);
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      for (int k = j + 1; k < 6; ++k) {
        for (int l = k + 1; l < 6; ++l) {
          double minor[kQuartic] = {};
          AddProduct<2, 2>(first[i][j], second[k][l], 1.0, minor);
          AddProduct<2, 2>(first[i][k], second[j][l], -1.0, minor);
          AddProduct<2, 2>(first[i][l], second[j][k], 1.0, minor);
          AddProduct<2, 2>(first[j][k], second[i][l], 1.0, minor);
          AddProduct<2, 2>(first[j][l], second[i][k], -1.0, minor);
          AddProduct<2, 2>(first[k][l], second[i][j], 1.0, minor);
          if (!macaulay->AddMultiples(minor, 4)) return false;
        }
      }
    }
  }
  return true;
}

// Newton's method on M(r) (t, w)' = 0.
bool Polish(const Row* rows, Eigen::Vector3d* r, Eigen::Vector4d* v) {
  const auto evaluate = [&](const Eigen::Vector4d& tw, SixPointSystem::Matrix64* M,
                            Eigen::Matrix<double, 6, 3>* D) {
    D->setZero();
    for (int m = 0; m < 6; ++m) {
      for (int c = 0; c < 4; ++c) {
        const double* e = rows[m].entry[c];
        (*M)(m, c) = e[0] + e[1] * (*r)[0] + e[2] * (*r)[1] + e[3] * (*r)[2];
        for (int j = 0; j < 3; ++j) (*D)(m, j) += e[1 + j] * tw[c];
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
  if (!AddMinors(rows, &macaulay)) return 0;
  constexpr int kLeading[] = {15};
  ActionMatrix<20> action;
  if (!macaulay.Reduce(kLeading, 1, &action)) return 0;
  RealSolutions<20> roots(&action);
  double x[20];
  const int num_roots = roots.FindX(0.0, false, system.zero_motion_multiplicity(), x, 0);
  for (int k = 0; k < num_roots; ++k) {
    // The multiple root of an intra-camera sample blurs those near it.
    const auto start = roots.Solution(system.all_intra() ? roots.Refine(x[k]) : x[k]);
    Eigen::Vector3d r(start[0], start[1], start[2]);
    Eigen::Vector4d v;
    if (!r.allFinite() || !Polish(rows, &r, &v)) continue;
    v.head<3>() = (B.transpose() * v.head<3>()).eval();
    system.Add(ExpSO3(kUnit * (B.transpose() * r)), v);
  }
  return solutions->size();
}

}  // namespace rigel
