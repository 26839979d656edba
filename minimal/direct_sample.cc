#include "rigel/minimal/direct_sample.h"

#include <cmath>

#include "rigel/minimal/unit_baseline.h"

namespace rigel {
namespace {

// Below this, relative to the rest, a quantity is rounding.
constexpr double kNegligible = 1e-12;

bool SameCentres(const PreparedMatch& a, const PreparedMatch& b) {
  // Most differ in the first coordinate.
  for (int c = 0; c < 3; ++c) {
    if (!(std::abs(a.s1[c] - b.s1[c]) + std::abs(a.s2[c] - b.s2[c]) < kNegligible)) return false;
  }
  return true;
}

}  // namespace

DirectSample::DirectSample(const PreparedMatches& matches, const int* sample) : matches_(&matches) {
  reference_ = &matches[sample[0]];
  bool all_intra = true;
  central_ = true;
  for (int r = 0; r < 4; ++r) {
    const PreparedMatch& m = matches[sample[r]];
    if (m.parallax2 > reference_->parallax2) reference_ = &m;
    all_intra = all_intra && m.camera1 == m.camera2;
    central_ = central_ && (r == 0 || SameCentres(m, matches[sample[0]]));
    rows_[r] = &m;
  }
  deflated_ = all_intra && !central_ && matches.alignment().contains_identity;
  if (central_) {
    for (int r = 0; r < 4; ++r) {
      ConstraintRow& row = central_rows_[r];
      row = *rows_[r];
      row.K0 = row.Kc = row.Ks = 0.0;
      rows_[r] = &row;
    }
    // (1 + cos a) / 2 is the constant 1 once it is multiplied by 1 + z^2, as every row is.
    central_rows_[3] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0};
  }
}

void DirectSample::AddSolution(double z, Solutions* solutions) const {
  const double w = 1.0 / (1.0 + z * z);
  const double c = (1.0 - z * z) * w;
  const double s = 2.0 * z * w;
  double m[4][4];
  for (int r = 0; r < 4; ++r) {
    const ConstraintRow& row = *rows_[r];
    m[r][0] = row.X0 + c * row.Xc + s * row.Xs;
    m[r][1] = c * row.Yc + s * row.Ys;
    m[r][2] = row.Z0 + c * row.Xs - s * row.Xc;
    // K0 = -Kc where the zero motion satisfies the row.
    m[r][3] = deflated_ ? 2.0 * w * (row.Ks + z * row.K0) : row.K0 + c * row.Kc + s * row.Ks;
  }
  double v[4];
  NullVector4(m, v);
  const Eigen::Vector3d direction(v[0], v[1], v[2]);
  const double norm2 = direction.squaredNorm();
  if (!(norm2 > 0.0) || !std::isfinite(norm2)) return;

  const bool has_scale = !central_ && v[3] * v[3] > kNegligible * kNegligible * norm2 &&
                         (!deflated_ || std::abs(z) > 1e-8);
  Eigen::Vector3d t;
  if (has_scale) {
    t = direction * ((deflated_ ? z : 1.0) / v[3]);
  } else {
    t = UnitBaselineTranslation(*reference_, c, s, direction);
  }
  Solution& solution = solutions->Append();
  solution.R = matches_->alignment().Rotation(c, s);
  solution.t = matches_->alignment().A2.transpose() * t;
  solution.has_scale = has_scale;
}

void NullVector4(const double m[4][4], double v[4]) {
  // Cofactors of each row from the 2x2 minors of the two other pairs of rows.
  // All four are made and the best is picked by its index: which it is cannot be predicted.
  double cofactors[4][4], norm2[4];
  for (int half = 0; half < 2; ++half) {
    const double* a = m[half == 0 ? 2 : 0];
    const double* b = m[half == 0 ? 3 : 1];
    const double m01 = a[0] * b[1] - a[1] * b[0];
    const double m02 = a[0] * b[2] - a[2] * b[0];
    const double m03 = a[0] * b[3] - a[3] * b[0];
    const double m12 = a[1] * b[2] - a[2] * b[1];
    const double m13 = a[1] * b[3] - a[3] * b[1];
    const double m23 = a[2] * b[3] - a[3] * b[2];
    for (int k = 0; k < 2; ++k) {
      const double* p = m[2 * half + k];
      double* c = cofactors[2 * half + k];
      c[0] = p[1] * m23 - p[2] * m13 + p[3] * m12;
      c[1] = -p[0] * m23 + p[2] * m03 - p[3] * m02;
      c[2] = p[0] * m13 - p[1] * m03 + p[3] * m01;
      c[3] = -p[0] * m12 + p[1] * m02 - p[2] * m01;
      norm2[2 * half + k] = c[0] * c[0] + c[1] * c[1] + c[2] * c[2] + c[3] * c[3];
    }
  }
  const int first = norm2[1] > norm2[0] ? 1 : 0;
  const int second = norm2[3] > norm2[2] ? 3 : 2;
  const int best = norm2[second] > norm2[first] ? second : first;
  const bool exists = norm2[best] > 0.0;
  for (int k = 0; k < 4; ++k) v[k] = exists ? cofactors[best][k] : 0.0;
}

}  // namespace rigel
