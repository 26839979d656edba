#include "rigel/minimal/solvers/six_point_stewenius.h"

#include <algorithm>
#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "rigel/minimal/numerics/polynomial_system.h"
#include "rigel/minimal/solvers/six_point_system.h"

namespace rigel {
namespace {

using polynomial_system::ActionMatrix;
using polynomial_system::AddProduct;
using polynomial_system::MacaulayMatrix;
using polynomial_system::NumMonomials;
using polynomial_system::RealSolutions;

constexpr int kQuadric = NumMonomials(2);
constexpr int kQuartic = NumMonomials(4);
constexpr int kSextic = NumMonomials(6);

// The unit of the unknown r: rotations of the rays' best alignment that a metre's parallax at ten
// metres can hide.
constexpr double kUnit = 0.1;

struct Equations {
  int num_quartics = 0;
  int num_sextics = 0;
  double quartics[20][kQuartic];
  double sextics[15][kSextic];
};

// Adds the coefficients of (1 + |r|^2) b'R a, R the rotation of the quaternion (1, r), in the order
// of polynomial_system.h: 1, x, y, z, xx, xy, xz, yy, yz, zz.
void AddBilinear(const Eigen::Vector3d& b, const Eigen::Vector3d& a, double* c) {
  constexpr double kSquare = kUnit * kUnit;
  const double xx = b[0] * a[0];
  const double yy = b[1] * a[1];
  const double zz = b[2] * a[2];
  c[0] += xx + yy + zz;
  c[1] += 2.0 * kUnit * (b[2] * a[1] - b[1] * a[2]);
  c[2] += 2.0 * kUnit * (b[0] * a[2] - b[2] * a[0]);
  c[3] += 2.0 * kUnit * (b[1] * a[0] - b[0] * a[1]);
  c[4] += kSquare * (xx - yy - zz);
  c[5] += 2.0 * kSquare * (b[0] * a[1] + b[1] * a[0]);
  c[6] += 2.0 * kSquare * (b[0] * a[2] + b[2] * a[0]);
  c[7] += kSquare * (yy - xx - zz);
  c[8] += 2.0 * kSquare * (b[1] * a[2] + b[2] * a[1]);
  c[9] += kSquare * (zz - xx - yy);
}

// The rows of the depth systems whose reference is match a, for the matches after it: quadrics in r
// times the depths of the reference and 1.
void DepthRows(const Ray* ray1, const Ray* ray2, int a, double (*rows)[3][kQuadric]) {
  for (int k = a + 1; k < 6; ++k) {
    const Eigen::Vector3d& x = ray1[k].x;
    const Eigen::Vector3d& y = ray2[k].x;
    for (double* row : {rows[k][0], rows[k][1], rows[k][2]}) std::fill(row, row + kQuadric, 0.0);
    AddBilinear(-y, ray1[a].x.cross(x), rows[k][0]);
    AddBilinear(y.cross(ray2[a].x), x, rows[k][1]);
    AddBilinear(y, (ray1[k].s - ray1[a].s).cross(x), rows[k][2]);
    AddBilinear((ray2[k].s - ray2[a].s).cross(y), x, rows[k][2]);
  }
}

// The 2 x 2 minors of the depths' columns. Those of three matches with the same centres vanish.
void AddQuartics(const SixPointSystem& system, const double (*rows)[3][kQuadric], int a,
                 double (*minors)[6][kQuartic], Equations* equations) {
  for (int b = a + 1; b < 6; ++b) {
    for (int c = b + 1; c < 6; ++c) {
      double* minor = minors[b][c];
      std::fill(minor, minor + kQuartic, 0.0);
      AddProduct<2, 2>(rows[b][0], rows[c][1], 1.0, minor);
      AddProduct<2, 2>(rows[b][1], rows[c][0], -1.0, minor);
      if (system.SameCentres(a, b) && system.SameCentres(a, c)) {
        std::copy(minor, minor + kQuartic, equations->quartics[equations->num_quartics++]);
      }
    }
  }
}

// True if three of the four matches have the same centres: their sextic is a multiple of a quartic.
bool HasQuartic(const SixPointSystem& system, int a, int b, int c, int d) {
  const auto same = [&system](int i, int j) { return system.SameCentres(i, j); };
  return (same(a, b) && (same(a, c) || same(a, d))) || (same(c, d) && (same(a, c) || same(b, c)));
}

// The 3 x 3 determinants, of four matches each.
void AddSextics(const SixPointSystem& system, const double (*rows)[3][kQuadric], int a,
                const double (*minors)[6][kQuartic], Equations* equations) {
  for (int b = a + 1; b < 6; ++b) {
    for (int c = b + 1; c < 6; ++c) {
      for (int d = c + 1; d < 6; ++d) {
        if (HasQuartic(system, a, b, c, d)) continue;
        double* sextic = equations->sextics[equations->num_sextics++];
        std::fill(sextic, sextic + kSextic, 0.0);
        AddProduct<4, 2>(minors[b][c], rows[d][2], 1.0, sextic);
        AddProduct<4, 2>(minors[b][d], rows[c][2], -1.0, sextic);
        AddProduct<4, 2>(minors[c][d], rows[b][2], 1.0, sextic);
      }
    }
  }
}

// C1 and C2 rotate the frames of view 1 and 2.
void MakeEquations(const SixPointSystem& system, const Eigen::Matrix3d& C1,
                   const Eigen::Matrix3d& C2, Equations* equations) {
  Ray ray1[6];
  Ray ray2[6];
  for (int k = 0; k < 6; ++k) {
    const RayPair& rays = system.rays(k);
    ray1[k] = {C1 * rays.ray1.x, C1 * rays.ray1.s};
    ray2[k] = {C2 * rays.ray2.x, C2 * rays.ray2.s};
  }
  // Each set of four matches once, with its first as the reference.
  for (int a = 0; a < 4; ++a) {
    double rows[6][3][kQuadric];
    double minors[6][6][kQuartic];
    DepthRows(ray1, ray2, a, rows);
    AddQuartics(system, rows, a, minors, equations);
    AddSextics(system, rows, a, minors, equations);
  }
}

// Writes the real solutions of the equations. `leading` as in MacaulayMatrix; `centre`: null or the
// x of a cluster of solutions.
template <int kDegree, int kMaxRows, int kSize>
int RealRotations(const Equations& equations, const int* leading, int num_degrees,
                  const double* centre, Eigen::Vector3d* r) {
  ActionMatrix<kSize> action;
  {
    MacaulayMatrix<kDegree, kMaxRows> macaulay;
    for (int k = 0; k < equations.num_quartics; ++k) {
      if (!macaulay.AddMultiples(equations.quartics[k], 4)) return 0;
    }
    if constexpr (kDegree >= 6) {
      for (int k = 0; k < equations.num_sextics; ++k) {
        if (!macaulay.AddMultiples(equations.sextics[k], 6)) return 0;
      }
    }
    if (!macaulay.Reduce(leading, num_degrees, &action)) return 0;
  }
  RealSolutions<kSize> roots(&action);
  double x[kSize];
  int num_roots = roots.FindX(0.0, false, x, 0);
  if (centre != nullptr) num_roots = roots.FindX(*centre, true, x, num_roots);
  if (centre != nullptr) roots.Refine(num_roots, x);
  std::array<double, 3> solutions[kSize];
  roots.Solve(num_roots, x, solutions);
  for (int k = 0; k < num_roots; ++k) r[k] = {solutions[k][0], solutions[k][1], solutions[k][2]};
  return num_roots;
}

// The Hilbert functions behind the tables: 64, 56, 48, 40 and 20 solutions.
int RealRotations(const Equations& equations, const double* centre, Eigen::Vector3d* r) {
  switch (equations.num_quartics) {
    case 0: {
      // Degrees 7 and 6: 64 monomials are left.
      constexpr int kLeading[] = {35, 21};
      return RealRotations<7, 60, 64>(equations, kLeading, 2, centre, r);
    }
    case 1: {
      // Degrees 7 to 4: 56 monomials are left.
      constexpr int kLeading[] = {36, 24, 3, 1};
      return RealRotations<7, 68, 56>(equations, kLeading, 4, centre, r);
    }
    case 2: {  // 3 + 3
      // Degrees 7 to 4: 48 monomials are left.
      constexpr int kLeading[] = {36, 28, 6, 2};
      return RealRotations<7, 76, 48>(equations, kLeading, 4, centre, r);
    }
    case 4: {  // 4 + 2, 4 + 1 + 1
      // Degrees 7 to 4: 40 monomials are left.
      constexpr int kLeading[] = {36, 28, 11, 5};
      return RealRotations<7, 104, 40>(equations, kLeading, 4, centre, r);
    }
    case 10: {  // 5 + 1
      // Degrees 5 and 4: 20 monomials are left.
      constexpr int kLeading[] = {21, 15};
      return RealRotations<5, 40, 20>(equations, kLeading, 2, centre, r);
    }
    default:
      return 0;
  }
}

// The rotation R of largest trace(R'A).
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& A) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if (U.determinant() * svd.matrixV().determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

// Newton's method on the six constraints themselves, from the rotation R.
void AddPolished(SixPointSystem* system, Eigen::Matrix3d R) {
  const auto evaluate = [&](const Eigen::Vector4d& v, double(*M)[4], double(*D)[3]) {
    for (int k = 0; k < 6; ++k) {
      const RayPair& rays = system->rays(k);
      const Eigen::Vector3d g = R * rays.ray1.x;
      const Eigen::Vector3d arm = R * rays.ray1.s;
      const Eigen::Vector3d n = g.cross(rays.ray2.x);
      // Of b . (g x y), b = t + w (R s_i - s_j), by the left perturbation of R.
      const Eigen::Vector3d b = v.head<3>() + v[3] * (arm - rays.ray2.s);
      const Eigen::Vector3d d = v[3] * arm.cross(n) + g.cross(rays.ray2.x.cross(b));
      for (int c = 0; c < 3; ++c) {
        M[k][c] = n[c];
        D[k][c] = d[c];
      }
      M[k][3] = n.dot(arm - rays.ray2.s);
    }
  };
  const auto update = [&R](const Eigen::Vector3d& d) { R = ExpSO3(d) * R; };
  Eigen::Vector4d v;
  if (PolishSixPoint(evaluate, update, &v)) system->Add(R, v);
}

}  // namespace

int Solve6ptStewenius(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  SixPointSystem system(matches, sample, solutions);
  if (!system.solvable()) return 0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 6; ++k) {
    covariance += system.rays(k).ray2.x * system.rays(k).ray1.x.transpose();
  }
  const Eigen::Matrix3d R0 = NearestRotation(covariance);
  const Eigen::Matrix3d B = SixPointBasis();
  Equations equations;
  MakeEquations(system, B * R0, B, &equations);

  // The solutions of intra-camera samples at small rotations surround R = I.
  const Eigen::Quaterniond identity(R0.transpose());
  const double identity_x = B.row(0).dot(identity.vec()) / (identity.w() * kUnit);
  Eigen::Vector3d r[kMaxSolutions];
  const int num_roots = RealRotations(equations, system.all_intra() ? &identity_x : nullptr, r);
  for (int k = 0; k < num_roots; ++k) {
    if (!r[k].allFinite()) continue;
    const Eigen::Vector3d q = kUnit * (B.transpose() * r[k]);
    AddPolished(&system, Eigen::Quaterniond(1.0, q[0], q[1], q[2]).normalized() * R0);
  }
  return solutions->size();
}

}  // namespace rigel
