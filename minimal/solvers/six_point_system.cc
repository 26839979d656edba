#include "rigel/minimal/solvers/six_point_system.h"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/metrics.h"

namespace rigel {
namespace {

// Rank decisions on exact structure: rounding is far below, image noise far above.
constexpr double kZeroByStructure = 1e-10;
// A motion of a millionth of the rig's size is no motion.
constexpr double kNoMotion = 1e-6;
// How far rounding moves the multiple root of a pure translation, radians.
constexpr double kNearIdentity = 1e-4;
// Of the entries of R, and of t relative to 1 m and |t|: solutions that differ by less are one
// root, found twice.
constexpr double kDuplicate = 1e-9;

}  // namespace

SixPointSystem::SixPointSystem(const PreparedMatches& matches, const int* sample,
                               Solutions* solutions)
    : solutions_(solutions) {
  Eigen::Matrix<double, 6, 3> n;
  bool finite = true;
  const Eigen::Vector3d* other = nullptr;  // a second centre
  for (int k = 0; k < 6; ++k) {
    rays_[k] = &matches.rays(sample[k]);
    const Ray& ray1 = rays_[k]->ray1;
    const Ray& ray2 = rays_[k]->ray2;
    finite = finite && ray1.x.allFinite() && ray2.x.allFinite();
    all_intra_ = all_intra_ && ray1.s == ray2.s;
    if (ray1.s != rays_[0]->ray1.s) {
      if (other == nullptr) other = &ray1.s;
      two_centres_ = two_centres_ && ray1.s == *other;
    }
    spread_ =
        std::max({spread_, (ray1.s - rays_[0]->ray1.s).norm(), (ray2.s - rays_[0]->ray1.s).norm()});
    n.row(k) = ray1.x.cross(ray2.x);
  }
  solvable_ = finite && spread_ > 0.0;
  if (!solvable_ || !all_intra_) return;

  const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 6, 3>> qr(n);
  const auto& T = qr.matrixQR();
  const double largest = std::abs(T(0, 0));
  solvable_ = largest > kZeroByStructure && std::abs(T(1, 1)) > kZeroByStructure * largest;
  if (!solvable_ || std::abs(T(2, 2)) > kZeroByStructure * largest) return;
  pure_translation_ = true;
  Eigen::Vector3d v;
  v[2] = 1.0;
  v[1] = -T(1, 2) / T(1, 1);
  v[0] = -(T(0, 1) * v[1] + T(0, 2)) / T(0, 0);
  Eigen::Vector4d tw;
  tw << qr.colsPermutation() * v, 0.0;
  Add(Eigen::Matrix3d::Identity(), tw);
}

void SixPointSystem::Add(const Eigen::Matrix3d& R, const Eigen::Vector4d& v) {
  Solution solution;
  solution.R = R;
  solution.has_scale = std::abs(v[3]) > kZeroByStructure * v.head<3>().norm();
  if (solution.has_scale) {
    solution.t = v.head<3>() / v[3];
    double largest = 0.0;
    for (const RayPair* pair : rays_) {
      largest = std::max(largest, Baseline(solution, pair->ray1.s, pair->ray2.s).norm());
    }
    if (!(largest > kNoMotion * spread_)) return;
    if (pure_translation_ && RotationError(Eigen::Matrix3d::Identity(), R) < kNearIdentity) return;
  } else {
    solution.t = v.head<3>().normalized();
    int votes = 0;
    for (const RayPair* pair : rays_) votes += CheiralityVote(solution, *pair);
    if (votes < 0) solution.t = -solution.t;
  }
  if (!solution.AllFinite()) return;
  for (const Solution& other : *solutions_) {
    if ((other.R - R).cwiseAbs().maxCoeff() < kDuplicate &&
        (other.t - solution.t).norm() < kDuplicate * (1.0 + solution.t.norm())) {
      return;
    }
  }
  solutions_->Append() = solution;
}

Eigen::Matrix3d SixPointBasis() {
  Eigen::Matrix3d B;
  B << 2.0, 6.0, 3.0, 3.0, 2.0, -6.0, -6.0, 3.0, -2.0;
  return B / 7.0;
}

void SixPointStep(const double (*M)[4], const double (*D)[3], const Eigen::Vector4d& v, int held,
                  double* step) {
  double J[6][8];
  for (int m = 0; m < 6; ++m) {
    for (int c = 0; c < 3; ++c) J[m][c] = D[m][c];
    for (int c = 0; c < 3; ++c) J[m][3 + c] = M[m][c];
    // The column of the held entry is overwritten by the last one.
    if (held < 3) J[m][3 + held] = M[m][3];
    J[m][6] = (M[m][0] * v[0] + M[m][1] * v[1]) + (M[m][2] * v[2] + M[m][3] * v[3]);
    J[m][7] = 0.0;
  }
  SolveSixBySix(J, step);
}

}  // namespace rigel
