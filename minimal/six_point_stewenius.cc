#include "rigel/minimal/six_point_stewenius.h"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "rigel/minimal/polynomial_system.h"
#include "rigel/minimal/six_point_system.h"

namespace rigel {
namespace {

using polynomial_system::ActionMatrix;
using polynomial_system::AddProduct;
using polynomial_system::MacaulayMatrix;
using polynomial_system::NumMonomials;
using polynomial_system::RealSolutions;

#ifndef KSCALE
#define KSCALE 0.1
#endif
constexpr double kScale = KSCALE;
constexpr int kQuadric = NumMonomials(2);
constexpr int kQuartic = NumMonomials(4);
constexpr int kSextic = NumMonomials(6);

struct RayPairInBasis {
  Eigen::Vector3d x, y, s, u;
};

// The coefficients of b' R a for the rotation (1 + |r|^2) R of the unnormalized quaternion (1, r),
// in the order of polynomial_system.h: 1, x, y, z, xx, xy, xz, yy, yz, zz.
void AddBilinear(const Eigen::Vector3d& b, const Eigen::Vector3d& a, double* c) {
  const double xx = b[0] * a[0], yy = b[1] * a[1], zz = b[2] * a[2];
  c[0] += xx + yy + zz;
  c[1] += 2.0 * (b[2] * a[1] - b[1] * a[2]);
  c[2] += 2.0 * (b[0] * a[2] - b[2] * a[0]);
  c[3] += 2.0 * (b[1] * a[0] - b[0] * a[1]);
  c[4] += xx - yy - zz;
  c[5] += 2.0 * (b[0] * a[1] + b[1] * a[0]);
  c[6] += 2.0 * (b[0] * a[2] + b[2] * a[0]);
  c[7] += yy - xx - zz;
  c[8] += 2.0 * (b[1] * a[2] + b[2] * a[1]);
  c[9] += zz - xx - yy;
}

Eigen::Matrix3d Basis() {
  Eigen::Matrix3d B;
  B << 2.0, 6.0, 3.0, 3.0, 2.0, -6.0, -6.0, 3.0, -2.0;
  return B / 7.0;
}

// The rotation R of largest trace(R'A).
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& A) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if (U.determinant() * svd.matrixV().determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

// Newton's method on the six constraints themselves, from the rotation R.
void AddPolished(const SixPointSystem& system, Eigen::Matrix3d* R) {
  const auto evaluate = [&](const Eigen::Vector4d& v, SixPointSystem::Matrix64* M,
                            Eigen::Matrix<double, 6, 3>* D) {
    for (int k = 0; k < 6; ++k) {
      const RayPair& rays = system.rays(k);
      const Eigen::Vector3d g = *R * rays.ray1.x;
      const Eigen::Vector3d arm = *R * rays.ray1.s;
      const Eigen::Vector3d n = g.cross(rays.ray2.x);
      M->row(k) << n.transpose(), n.dot(arm - rays.ray2.s);
      // Of b . (g x y), b = t + w (R s_i - s_j), by the left perturbation of R.
      const Eigen::Vector3d b = v.head<3>() + v[3] * (arm - rays.ray2.s);
      D->row(k) = v[3] * arm.cross(n) + g.cross(rays.ray2.x.cross(b));
    }
  };
  const auto update = [R](const Eigen::Vector3d& d) { *R = ExpSO3(d) * *R; };
  SixPointSystem::Matrix64 M;
  Eigen::Matrix<double, 6, 3> D;
  evaluate(Eigen::Vector4d::Zero(), &M, &D);
  Eigen::Vector4d v = NullVector(M);
  if (PolishSixPoint(evaluate, update, &v)) system.Add(*R, v);
}

template <int kDegree, int kMaxRows, int kSize>
int RealRotations(const double (*quartics)[kQuartic], int num_quartics,
                  const double (*sextics)[kSextic], int num_sextics, const int* leading,
                  int num_degrees, const double* centre, double (*r)[3]) {
  ActionMatrix<kSize> action;
  {
    MacaulayMatrix<kDegree, kMaxRows> macaulay;
    for (int k = 0; k < num_quartics; ++k) {
      if (!macaulay.AddMultiples(quartics[k], 4)) return 0;
    }
    for (int k = 0; k < num_sextics; ++k) {
      if (!macaulay.AddMultiples(sextics[k], 6)) return 0;
    }
    if (!macaulay.Reduce(leading, num_degrees, &action)) return 0;
  }
  RealSolutions<kSize> roots(&action);
  double x[kSize];
  int num_roots = roots.FindX(0.0, false, x, 0);
  if (centre) num_roots = roots.FindX(*centre, true, x, num_roots);
  for (int k = 0; k < num_roots; ++k) {
    const auto solution = roots.Solution(centre ? roots.Refine(x[k]) : x[k]);
    for (int i = 0; i < 3; ++i) r[k][i] = solution[i];
  }
  return num_roots;
}

}  // namespace

int Solve6ptStewenius(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const SixPointSystem system(matches, sample, solutions);
  if (!system.solvable()) return 0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 6; ++k) {
    const RayPair& rays = system.rays(k);
    covariance += rays.ray2.x * rays.ray1.x.transpose();
  }
  const Eigen::Matrix3d B = Basis();
  const Eigen::Matrix3d R0 = NearestRotation(covariance);
  const Eigen::Matrix3d C = B * R0;
  RayPairInBasis m[6];
  for (int k = 0; k < 6; ++k) {
    const RayPair& rays = system.rays(k);
    m[k] = {C * rays.ray1.x, B * rays.ray2.x, C * rays.ray1.s, B * rays.ray2.s};
  }
  const auto same = [&system](int i, int j) { return system.SameCentres(i, j); };

  double quartics[20][kQuartic];
  double sextics[15][kSextic];
  int num_quartics = 0;
  int num_sextics = 0;
  for (int a = 0; a < 4; ++a) {
    double rows[6][3][kQuadric] = {};
    for (int k = a + 1; k < 6; ++k) {
      const Eigen::Vector3d ds = m[k].s - m[a].s;
      const Eigen::Vector3d du = m[k].u - m[a].u;
      AddBilinear(-m[k].y, m[a].x.cross(m[k].x), rows[k][0]);
      AddBilinear(m[k].y.cross(m[a].y), m[k].x, rows[k][1]);
      AddBilinear(m[k].y, ds.cross(m[k].x), rows[k][2]);
      AddBilinear(du.cross(m[k].y), m[k].x, rows[k][2]);
      for (auto& entry : rows[k]) {
        for (int i = 1; i < 4; ++i) entry[i] *= kScale;
        for (int i = 4; i < kQuadric; ++i) entry[i] *= kScale * kScale;
      }
    }
    double minors[6][6][kQuartic] = {};
    for (int b = a + 1; b < 6; ++b) {
      for (int c = b + 1; c < 6; ++c) {
        AddProduct<2, 2>(rows[b][0], rows[c][1], 1.0, minors[b][c]);
        AddProduct<2, 2>(rows[b][1], rows[c][0], -1.0, minors[b][c]);
        if (same(a, b) && same(a, c)) {
          std::copy(minors[b][c], minors[b][c] + kQuartic, quartics[num_quartics++]);
        }
      }
    }
    for (int b = a + 1; b < 6; ++b) {
      for (int c = b + 1; c < 6; ++c) {
        for (int d = c + 1; d < 6; ++d) {
          if ((same(a, b) && (same(a, c) || same(a, d))) ||
              (same(c, d) && (same(a, c) || same(b, c)))) {
            continue;
          }
          double* sextic = sextics[num_sextics++];
          std::fill(sextic, sextic + kSextic, 0.0);
          AddProduct<4, 2>(minors[b][c], rows[d][2], 1.0, sextic);
          AddProduct<4, 2>(minors[b][d], rows[c][2], -1.0, sextic);
          AddProduct<4, 2>(minors[c][d], rows[b][2], 1.0, sextic);
        }
      }
    }
  }
  // For intra-camera samples a cluster of solutions surrounds R = I; where that is, in x.
  const Eigen::Quaterniond identity(R0.transpose());
  const double identity_x = (B * identity.vec())[0] / (identity.w() * kScale);
  const double* centre = system.all_intra() ? &identity_x : nullptr;
  double r[64][3];
  int num_roots = 0;
  if (num_quartics == 0) {
    const int leading[] = {35, 21};
    num_roots = RealRotations<7, 60, 64>(quartics, 0, sextics, num_sextics, leading, 2, centre, r);
  } else if (num_quartics == 1) {
    const int leading[] = {36, 24, 3, 1};
    num_roots = RealRotations<7, 68, 56>(quartics, 1, sextics, num_sextics, leading, 4, centre, r);
  } else if (num_quartics == 2) {
    const int leading[] = {36, 28, 6, 2};
    num_roots = RealRotations<7, 76, 48>(quartics, 2, sextics, num_sextics, leading, 4, centre, r);
  } else if (num_quartics == 4) {
    const int leading[] = {36, 28, 12, 4};
    num_roots = RealRotations<7, 104, 40>(quartics, 4, sextics, num_sextics, leading, 4, centre, r);
  } else if (num_quartics == 10) {
    const int leading[] = {21, 15};
    num_roots = RealRotations<5, 40, 20>(quartics, 10, sextics, 0, leading, 2, centre, r);
  }
  for (int k = 0; k < num_roots; ++k) {
    const Eigen::Vector3d q = kScale * B.transpose() * Eigen::Vector3d(r[k][0], r[k][1], r[k][2]);
    if (!q.allFinite()) continue;
    Eigen::Matrix3d R =
        Eigen::Quaterniond(1.0, q[0], q[1], q[2]).normalized().toRotationMatrix() * R0;
    AddPolished(system, &R);
  }
  return solutions->size();
}

}  // namespace rigel
