#include "rigel/minimal/six_point_ventura.h"

#include <cmath>

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

#ifndef VS
#define VS 0.1
#endif
constexpr double kScale = VS;
// A linear function of r: coefficients of 1, x, y, z.
using Linear = double[4];

struct Row {
  Linear entry[4];  // n(r), k(r)
};

// The basis of r in which it is solved; its first axis is no likely rotation axis, so that roots
// are told apart by their first coordinate.
Eigen::Matrix3d Basis() {
  Eigen::Matrix3d B;
  B << 2.0, 6.0, 3.0, 3.0, 2.0, -6.0, -6.0, 3.0, -2.0;
  return B / 7.0;
}

}  // namespace

int Solve6ptVentura(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const SixPointSystem system(matches, sample, solutions);
  if (!system.solvable()) return 0;
  const Eigen::Matrix3d B = Basis();
  Row rows[6];
  for (int m = 0; m < 6; ++m) {
    const RayPair& rays = system.rays(m);
    const Eigen::Vector3d x = B * rays.ray1.x;
    const Eigen::Vector3d y = B * rays.ray2.x;
    const Eigen::Vector3d p = (B * rays.ray1.s).cross(x);
    const Eigen::Vector3d q = (B * rays.ray2.s).cross(y);
    // n = (x + r x x) x y = x x y + x (r.y) - r (x.y);  k = y.p + q.x + r . (p x y + x x q).
    const Eigen::Vector3d n0 = x.cross(y);
    const double xy = x.dot(y);
    for (int i = 0; i < 3; ++i) {
      rows[m].entry[i][0] = n0[i];
      for (int j = 0; j < 3; ++j) rows[m].entry[i][1 + j] = x[i] * y[j] - (i == j ? xy : 0.0);
    }
    const Eigen::Vector3d k1 = p.cross(y) + x.cross(q);
    rows[m].entry[3][0] = y.dot(p) + q.dot(x);
    for (int j = 0; j < 3; ++j) rows[m].entry[3][1 + j] = k1[j];
  }

  // 2 x 2 minors of columns (0, 1) and (2, 3), then the 4 x 4 minors by Laplace expansion.
  constexpr int kQuadric = NumMonomials(2);
  double first[6][6][kQuadric];
  Row scaled[6];
  for (int m = 0; m < 6; ++m) for (int c = 0; c < 4; ++c) for (int i = 0; i < 4; ++i) scaled[m].entry[c][i] = rows[m].entry[c][i] * (i == 0 ? 1.0 : kScale);
  double second[6][6][kQuadric];
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      for (int c = 0; c < 4; c += 2) {
        double* minor = c == 0 ? first[i][j] : second[i][j];
        std::fill(minor, minor + kQuadric, 0.0);
        AddProduct<1, 1>(scaled[i].entry[c], scaled[j].entry[c + 1], 1.0, minor);
        AddProduct<1, 1>(scaled[i].entry[c + 1], scaled[j].entry[c], -1.0, minor);
      }
    }
  }
  MacaulayMatrix<4, 15> macaulay;
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < 6; ++j) {
      for (int k = j + 1; k < 6; ++k) {
        for (int l = k + 1; l < 6; ++l) {
          double quartic[NumMonomials(4)] = {};
          AddProduct<2, 2>(first[i][j], second[k][l], 1.0, quartic);
          AddProduct<2, 2>(first[i][k], second[j][l], -1.0, quartic);
          AddProduct<2, 2>(first[i][l], second[j][k], 1.0, quartic);
          AddProduct<2, 2>(first[j][k], second[i][l], 1.0, quartic);
          AddProduct<2, 2>(first[j][l], second[i][k], -1.0, quartic);
          AddProduct<2, 2>(first[k][l], second[i][j], 1.0, quartic);
          if (!macaulay.AddMultiples(quartic, 4)) return 0;
        }
      }
    }
  }
  const int leading[1] = {15};
  ActionMatrix<20> action;
  if (!macaulay.Reduce(leading, 1, &action)) return 0;
  RealSolutions<20> roots(&action);
  double x[20];
  const int num_roots = roots.FindX(0.0, false, x, 0);
  for (int k = 0; k < num_roots; ++k) {
    const auto start = roots.Solution(system.all_intra() ? roots.Refine(x[k]) : x[k]);
    Eigen::Vector3d r = kScale * Eigen::Vector3d(start[0], start[1], start[2]);
    if (!r.allFinite()) continue;
    // Newton's method on M(r) (t, w)' = 0 itself.
    const auto evaluate = [&](const Eigen::Vector4d& v, SixPointSystem::Matrix64* M,
                              Eigen::Matrix<double, 6, 3>* D) {
      for (int m = 0; m < 6; ++m) {
        for (int c = 0; c < 4; ++c) {
          const double* e = rows[m].entry[c];
          (*M)(m, c) = e[0] + e[1] * r[0] + e[2] * r[1] + e[3] * r[2];
        }
        for (int j = 0; j < 3; ++j) {
          (*D)(m, j) = 0.0;
          for (int c = 0; c < 4; ++c) (*D)(m, j) += rows[m].entry[c][1 + j] * v[c];
        }
      }
    };
    const auto update = [&r](const Eigen::Vector3d& d) { r += d; };
    SixPointSystem::Matrix64 M;
    Eigen::Matrix<double, 6, 3> D;
    evaluate(Eigen::Vector4d::Zero(), &M, &D);
    Eigen::Vector4d v = NullVector(M);
    if (!PolishSixPoint(evaluate, update, &v)) continue;
    v.head<3>() = B.transpose() * v.head<3>();
    system.Add(ExpSO3(B.transpose() * r), v);
  }
  return solutions->size();
}

}  // namespace rigel
