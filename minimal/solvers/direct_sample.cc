#include "rigel/minimal/solvers/direct_sample.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigel/minimal/numerics/laplace.h"
#include "rigel/minimal/solvers/baseline.h"

namespace rigel {
namespace {

using laplace::Pair;

// The null vector of a 4x4 matrix of rank 3 with the columns x, y, z and k; of a matrix that is
// almost singular, almost the singular vector of its least singular value, that is adj adj' e for
// any e that is not orthogonal to it: all four rows have a say, by their size. Zero if the rank is
// lower.
Eigen::Vector4d NullVector(const Eigen::Array4d& x, const Eigen::Array4d& y,
                           const Eigen::Array4d& z, const Eigen::Array4d& k) {
  // 2x2 minors of rows 0 and 2 and of rows 1 and 3; cofactors of a row take those of the others.
  const auto minor = [](const Eigen::Array4d& a, const Eigen::Array4d& b) -> Pair {
    return (a.head<2>() * b.tail<2>() - b.head<2>() * a.tail<2>()).reverse();
  };
  const Pair xy = minor(x, y);
  const Pair xz = minor(x, z);
  const Pair xk = minor(x, k);
  const Pair yz = minor(y, z);
  const Pair yk = minor(y, k);
  const Pair zk = minor(z, k);
  // Rows 0 and 1, then rows 2 and 3.
  Pair cofactors[2][4];
  for (int half = 0; half < 2; ++half) {
    const auto rows = [half](const Eigen::Array4d& c) -> Pair {
      return half == 0 ? c.head<2>() : c.tail<2>();
    };
    cofactors[half][0] = rows(y) * zk - rows(z) * yk + rows(k) * yz;
    cofactors[half][1] = rows(z) * xk - rows(x) * zk - rows(k) * xz;
    cofactors[half][2] = rows(x) * yk - rows(y) * xk + rows(k) * xy;
    cofactors[half][3] = rows(y) * xz - rows(x) * yz - rows(z) * xy;
  }
  // e is the axis that is nearest to the vector, picked by index: which it is cannot be predicted.
  double size[3];
  for (int c = 0; c < 3; ++c) {
    size[c] = (cofactors[0][c] * cofactors[0][c] + cofactors[1][c] * cofactors[1][c]).sum();
  }
  const int larger = size[1] > size[0];
  const int axis = larger + (2 - larger) * (size[2] > size[larger]);
  const Pair u0 = cofactors[0][axis];
  const Pair u1 = cofactors[1][axis];
  const auto component = [&](int c) { return (u0 * cofactors[0][c] + u1 * cofactors[1][c]).sum(); };
  return {component(0), component(1), component(2), component(3)};
}

}  // namespace

DirectSample::DirectSample(const PreparedMatches& matches, const int* sample) : matches_(&matches) {
  std::copy(sample, sample + 4, sample_);
  const PreparedMatch& first = matches[sample[0]];
  bool all_intra = true;
  central_ = true;
  double parallax2 = 0.0;  // a sum: NaN if one of the matches is
  for (int r = 0; r < 4; ++r) {
    const PreparedMatch& m = matches[sample[r]];
    parallax2 += m.parallax2;
    all_intra &= m.camera1 == m.camera2;
    central_ = central_ && (r == 0 || SameArm(m, first));
  }
  has_parallax_ = parallax2 > kNoParallax2;
  deflated_ = all_intra && !central_ && matches.alignment().contains_identity;
  if (central_) {
    // The last one is left out: the one that says least.
    for (int r = 0; r < 3; ++r) {
      if (matches[sample_[r]].parallax2 < matches[sample_[3]].parallax2) {
        std::swap(sample_[r], sample_[3]);
      }
    }
  }
  // Two rows at once: to read a pair right after its parts were written makes the processor wait.
  for (int r = 0; r < 4; r += 2) {
    const PreparedMatch& a = matches[sample_[r]];
    const PreparedMatch& b = matches[sample_[r + 1]];
    const auto rows = [r](Eigen::Array4d& column) { return column.segment<2>(r); };
    const Pair X0(a.X0, b.X0), Xc(a.Xc, b.Xc), Xs(a.Xs, b.Xs), Z0(a.Z0, b.Z0);
    const Pair K0(a.K0, b.K0), Kc(a.Kc, b.Kc), Ks(a.Ks, b.Ks);
    rows(x0) = X0 + Xc;
    rows(x1) = Xs - Z0;
    rows(y0) = Pair(a.Yc, b.Yc);
    rows(y1) = 2.0 * Pair(a.Ys, b.Ys);
    rows(z0) = Z0 + Xs;
    rows(z1) = X0 - Xc;
    if (deflated_) {
      rows(k0) = 2.0 * Ks;
      rows(k1) = K0 - Kc;
      rows(k2).setZero();
    } else {
      rows(k0) = K0 + Kc;
      rows(k1) = 2.0 * Ks;
      rows(k2) = K0 - Kc;
    }
  }
  if (central_) {
    x0[3] = x1[3] = y0[3] = y1[3] = z0[3] = z1[3] = 0.0;
    k0 << 0.0, 0.0, 0.0, 1.0;
    k1.setZero();
    k2.setZero();
  }
}

void DirectSample::Determinant(double c[7], double first_order[4]) const {
  Pair first[4], rest[5], quadratic[5];
  for (Pair& f : first) f.setZero();
  for (Pair& r : rest) r.setZero();
  for (Pair& q : quadratic) q.setZero();
  laplace::ForEachTerm([&](auto rows) {
    const auto xz = rows.MinorsIJ(x0, x1, z0, z1);
    const Pair y0k0 = rows.MinorPQ(y0, k0);
    const Pair y0k1 = rows.MinorPQ(y0, k1);
    const Pair y1k0 = rows.MinorPQ(y1, k0);
    // The first-order form has y0k0 + z y1k0.
    const Pair second = rows.MinorPQ(y1, k1) - y0k0;
    for (int m = 0; m < 3; ++m) {
      first[m] += xz[m] * y0k0;
      first[m + 1] += xz[m] * y1k0;
      rest[m] += xz[m] * y0k1;
      rest[m + 1] += xz[m] * second;
      rest[m + 2] -= xz[m] * y0k1;
    }
    if (deflated_) return;
    const Pair y0k2 = rows.MinorPQ(y0, k2);
    const Pair y1k2 = rows.MinorPQ(y1, k2);
    for (int m = 0; m < 3; ++m) {
      quadratic[m] += xz[m] * y0k2;
      quadratic[m + 1] += xz[m] * y1k2;
      quadratic[m + 2] -= xz[m] * y0k2;
    }
  });
  for (int n = 0; n < 7; ++n) c[n] = 0.0;
  for (int n = 0; n < 4; ++n) c[n] = first_order[n] = first[n].sum();
  for (int n = 0; n < 5; ++n) c[n + 1] += rest[n].sum();
  for (int n = 0; n < 5; ++n) c[n + 2] += quadratic[n].sum();
}

void DirectSample::AddSolution(double z, Solutions* solutions) const {
  const double z2 = z * z;
  Eigen::Array4d k = k0 + z * k1;
  if (!deflated_) k += z2 * k2;
  const Eigen::Vector4d u = NullVector(x0 + z * x1, (1.0 - z2) * y0 + z * y1, z0 + z * z1, k);
  const double norm2 = 1.0 + z2;
  const Eigen::Vector3d direction(u[0] + z * u[2], norm2 * u[1], u[2] - z * u[0]);
  const double direction2 = direction.squaredNorm();
  if (!(direction2 > 0.0) || !std::isfinite(direction2)) return;

  const double w = norm2 * u[3];
  const double c = (1.0 - z2) / norm2;
  const double s = 2.0 * z / norm2;
  const bool has_scale = !central_ && w * w > kNoScale * kNoScale * direction2 &&
                         (!deflated_ || std::abs(z) > kNoTurn);
  Eigen::Vector3d t;
  if (has_scale) {
    t = direction * ((deflated_ ? z : 1.0) / w);
  } else {
    const PreparedMatch* reference = &(*matches_)[sample_[0]];
    for (int r = 1; r < 4; ++r) {
      const PreparedMatch& m = (*matches_)[sample_[r]];
      if (m.parallax2 > reference->parallax2) reference = &m;
    }
    t = UnitBaselineTranslation(*reference, c, s, direction);
  }
  Solution& solution = solutions->Append();
  solution.R = matches_->alignment().Rotation(c, s);
  solution.t = matches_->alignment().ToFrame2(t);
  solution.has_scale = has_scale;
}

}  // namespace rigel
