#include "rigel/minimal/solvers/six_point_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/QR>

#include "rigel/core/cheirality.h"
#include "rigel/core/metrics.h"

namespace rigel {
namespace {

// Rank decisions on exact structure: rounding is far below, image noise far above.
constexpr double kNegligible = 1e-10;
// A motion of a millionth of the rig's size is no motion.
constexpr double kNoMotion = 1e-6;
// How far rounding moves the multiple root of a pure translation, radians.
constexpr double kNoRotation = 1e-4;
// Of the entries of R, and of t relative to 1 m and |t|: solutions that differ by less are one
// root, found twice.
constexpr double kDuplicate = 1e-9;

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
  solvable_ = largest > kNegligible && std::abs(T(1, 1)) > kNegligible * largest;
  if (!solvable_ || std::abs(T(2, 2)) > kNegligible * largest) return;
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
  solution.has_scale = std::abs(v[3]) > kNegligible * v.head<3>().norm();
  if (solution.has_scale) {
    solution.t = v.head<3>() / v[3];
    double largest = 0.0;
    for (const RayPair* pair : rays_) {
      largest = std::max(largest, (R * pair->ray1.s + solution.t - pair->ray2.s).norm());
    }
    if (!(largest > kNoMotion * spread_)) return;
    if (pure_translation_ && RotationError(Eigen::Matrix3d::Identity(), R) < kNoRotation) return;
  } else {
    solution.t = v.head<3>().normalized();
    int votes = 0;
    for (const RayPair* pair : rays_) {
      const Cheirality c = TestCheirality(solution, *pair);
      votes += (c == Cheirality::kInFront) - (c == Cheirality::kBehind);
    }
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

Eigen::Vector4d NullVector(const double (*M)[4]) {
  // Elimination with complete pivoting.
  double T[6][4];
  int column[4] = {0, 1, 2, 3};
  for (int r = 0; r < 6; ++r) std::copy(M[r], M[r] + 4, T[r]);
  for (int k = 0; k < 3; ++k) {
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

void SolveSixBySix(double (*a)[8], double* x) {
  double inv[6];
  EliminateColumns(a, inv, std::make_index_sequence<6>());
  for (int r = 5; r >= 0; --r) {
    double value = a[r][6];
    for (int c = r + 1; c < 6; ++c) value -= a[r][c] * x[c];
    x[r] = value * inv[r];
  }
}

}  // namespace rigel
