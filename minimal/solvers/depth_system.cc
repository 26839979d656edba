#include "rigel/minimal/solvers/depth_system.h"

#include <algorithm>
#include <cmath>

#include "rigel/minimal/solvers/baseline.h"

namespace rigel {
namespace {

// Below these rounding decides: the height of a planar sample's cameras, metres; an entry of F made
// of unit vectors; and w relative to the depths, 1/m, where the length of t is not determined.
constexpr double kZeroHeight = 1e-12;
constexpr double kZeroEntry = 1e-12;
constexpr double kNoDepthScale = 1e-12;

// sin(a) / a and (1 - cos a) / a, for small angles by their series, to rounding: no division, and
// faster than std::sin.
void SineAndVersine(double a, double* sine_over_a, double* versine_over_a) {
  constexpr double kSmall = 0.2;  // the first term left out is below 1e-18
  if (std::abs(a) < kSmall) {
    const double y = a * a;
    const double y2 = y * y;
    const double y4 = y2 * y2;
    *sine_over_a = (1.0 - y * (1.0 / 6)) + y2 * (1.0 / 120 - y * (1.0 / 5040)) +
                   y4 * (1.0 / 362880 - y * (1.0 / 39916800));
    *versine_over_a = a * ((0.5 - y * (1.0 / 24)) + y2 * (1.0 / 720 - y * (1.0 / 40320)) +
                           y4 * (1.0 / 3628800 - y * (1.0 / 479001600)));
  } else {
    *sine_over_a = std::sin(a) / a;
    *versine_over_a = (1.0 - std::cos(a)) / a;
  }
}

}  // namespace

template <RotationModel kModel>
void DepthSystem<kModel>::SetReference(const PreparedMatches& matches, const int* sample,
                                       int sample_size) {
  // The reference of largest parallax: parallel rays would leave d1, d2 undetermined, and the
  // first-order bias grows with the depths.
  int best = 0;
  double largest = matches[sample[0]].parallax2;
  double sum = largest;  // NaN if one of the matches is
  bool all_intra = matches[sample[0]].camera1 == matches[sample[0]].camera2;
  for (int k = 1; k < sample_size; ++k) {
    const PreparedMatch& m = matches[sample[k]];
    best = m.parallax2 > largest ? k : best;
    largest = std::max(largest, m.parallax2);
    sum += m.parallax2;
    all_intra &= m.camera1 == m.camera2;
  }
  reference_ = &matches[sample[best]];
  has_parallax_ = sum > kNoParallax2;
  deflated_ = all_intra && matches.alignment().contains_identity;
  int row = 0;
  for (int k = 0; k < sample_size; ++k) {
    if (k != best) SetRow(matches[sample[k]], row++);
  }
}

template <RotationModel kModel>
void DepthSystem<kModel>::SetRow(const PreparedMatch& m, int row) {
  const double* x1 = reference_->x1;
  const double* x2 = reference_->x2;
  const double* s1 = reference_->s1;
  const double* s2 = reference_->s2;
  // Entries k0 + kc cos a + ks sin a.
  const auto set = [&](int column, double k0, double kc, double ks) {
    f_[0][row][column] = k0 + kc;
    if constexpr (kModel == RotationModel::kExact) {
      // (1 + z^2) cos a = 1 - z^2, (1 + z^2) sin a = 2 z.
      f_[1][row][column] = 2.0 * ks;
      f_[2][row][column] = k0 - kc;
    } else {
      f_[1][row][column] = ks;
    }
  };
  // -x1 . (R'n) and x2 . n.
  set(0, -(x1[0] * m.Xc + x1[2] * m.Xs), -(x1[0] * m.X0 + x1[1] * m.Yc + x1[2] * m.Z0),
      x1[0] * m.Z0 - x1[1] * m.Ys - x1[2] * m.X0);
  set(1, x2[0] * m.X0 + x2[2] * m.Z0, x2[0] * m.Xc + x2[1] * m.Yc + x2[2] * m.Xs,
      x2[0] * m.Xs + x2[1] * m.Ys - x2[2] * m.Xc);
  // The match's constraint at t = s2 - R s1.
  const double k0 = m.K0 - (s1[0] * m.Xc + s1[2] * m.Xs) + s2[0] * m.X0 + s2[2] * m.Z0;
  const double ks = m.Ks + s1[0] * m.Z0 - s1[1] * m.Ys - s1[2] * m.X0 + s2[0] * m.Xs +
                    s2[1] * m.Ys - s2[2] * m.Xc;
  if (deflated_) {
    // It is zero up to rounding at a = 0; so kc = -k0, and the entry is divided by z.
    if constexpr (kModel == RotationModel::kExact) {
      f_[0][row][2] = 2.0 * ks;
      f_[1][row][2] = 2.0 * k0;
      f_[2][row][2] = 0.0;
    } else {
      f_[0][row][2] = ks;
      f_[1][row][2] = 0.0;
    }
  } else {
    set(2, k0,
        m.Kc - (s1[0] * m.X0 + s1[1] * m.Yc + s1[2] * m.Z0) +
            (s2[0] * m.Xc + s2[1] * m.Yc + s2[2] * m.Xs),
        ks);
  }
}

template <RotationModel kModel>
void DepthSystem<kModel>::SetFourPoint(const PreparedMatches& matches, const int* sample) {
  planar_ = false;
  SetReference(matches, sample, 4);
  // Central: nothing is said of |t|.
  central_ = true;
  for (int k = 0; k < 4 && central_; ++k) {
    central_ = SameArm(matches[sample[k]], *reference_);
  }
}

template <RotationModel kModel>
void DepthSystem<kModel>::SetPlanar(const PreparedMatches& matches, const int* sample) {
  planar_ = true;
  SetReference(matches, sample, 3);
  const double height = reference_->s2[1] - reference_->s1[1];
  for (int k = 0; k <= kEntryDegree; ++k) {
    for (int c = 0; c < 3; ++c) f_[k][2][c] = 0.0;
  }
  f_[0][2][0] = -reference_->x1[1];
  f_[0][2][1] = reference_->x2[1];
  f_[0][2][2] = deflated_ ? 0.0 : height;
  central_ = std::abs(height) < kZeroHeight;
  for (int k = 0; k < 3 && central_; ++k) {
    central_ = SameArm(matches[sample[k]], *reference_);
  }
}

template <RotationModel kModel>
inline void DepthSystem<kModel>::Minor(int i, int j, double* m) const {
  constexpr int D = kEntryDegree;
  for (int k = 0; k <= 2 * D; ++k) m[k] = 0.0;
  for (int a = 0; a <= D; ++a) {
    for (int b = 0; b <= D; ++b) {
      m[a + b] += f_[a][i][0] * f_[b][j][1] - f_[a][i][1] * f_[b][j][0];
    }
  }
}

template <RotationModel kModel>
inline void DepthSystem<kModel>::AddCofactor(int r, int i, int j, double* coefficients) const {
  double m[2 * kEntryDegree + 1];
  Minor(i, j, m);
  for (int a = 0; a <= LastColumnDegree(); ++a) {
    const double entry = f_[a][r][2];
    for (int b = 0; b <= 2 * kEntryDegree; ++b) coefficients[a + b] += entry * m[b];
  }
}

template <RotationModel kModel>
inline bool DepthSystem<kModel>::Moves() const {
  for (int row = 0; row < (planar_ ? 2 : 3); ++row) {
    // As a rule the first entry decides.
    for (int k = 0; k <= kEntryDegree; ++k) {
      if (std::abs(f_[k][row][0]) > kZeroEntry || std::abs(f_[k][row][1]) > kZeroEntry) {
        return true;
      }
    }
  }
  return false;
}

template <RotationModel kModel>
int DepthSystem<kModel>::Determinant(double* coefficients) const {
  constexpr int D = kEntryDegree;
  for (int k = 0; k <= kMaxDegree; ++k) coefficients[k] = 0.0;
  if (!has_parallax_) return 0;

  int degree = planar_ ? D : 2 * D;
  if (central_) {
    double m[2 * D + 1];
    Minor(0, planar_ ? 2 : 1, m);
    for (int k = 0; k <= degree; ++k) coefficients[k] = m[k];
  } else {
    AddCofactor(0, 1, 2, coefficients);
    AddCofactor(1, 2, 0, coefficients);
    AddCofactor(2, 0, 1, coefficients);
    degree += LastColumnDegree();
  }

  // Matches that do not move (or NaN) make every coefficient vanish: what is left is rounding.
  double sum = 0.0;
  for (int k = 0; k <= degree; ++k) sum += std::abs(coefficients[k]);
  return Moves() && sum > 0.0 && std::isfinite(sum) ? degree : 0;
}

template <RotationModel kModel>
void DepthSystem<kModel>::NullVector(double z, double v[3]) const {
  double F[3][3];
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      double value = f_[kEntryDegree][r][c];
      for (int k = kEntryDegree - 1; k >= 0; --k) value = value * z + f_[k][r][c];
      F[r][c] = value;
    }
  }
  if (central_) {
    // Any row gives d1 : d2; take the larger.
    const int other = planar_ ? 2 : 1;
    const double n0 = F[0][0] * F[0][0] + F[0][1] * F[0][1];
    const double n1 = F[other][0] * F[other][0] + F[other][1] * F[other][1];
    const int r = n0 >= n1 ? 0 : other;
    v[0] = F[r][1];
    v[1] = -F[r][0];
    v[2] = 0.0;
    return;
  }
  // The cross products of the pairs of rows are multiples of the null vector; their sum by the size
  // of one component, which cannot cancel. d1 as a rule is far from zero.
  double cross[3][3];
  for (int r = 0; r < 3; ++r) {
    const double* a = F[r];
    const double* b = F[(r + 1) % 3];
    cross[r][0] = a[1] * b[2] - a[2] * b[1];
    cross[r][1] = a[2] * b[0] - a[0] * b[2];
    cross[r][2] = a[0] * b[1] - a[1] * b[0];
  }
  // Squared share of the null vector: with a component below a hundredth two digits are lost, and
  // the next component is tried.
  constexpr double kSmall2 = 1e-4;
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 3; ++c) {
      v[c] = cross[0][k] * cross[0][c] + cross[1][k] * cross[1][c] + cross[2][k] * cross[2][c];
    }
    if (v[k] * v[k] > kSmall2 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])) return;
  }
}

template <RotationModel kModel>
void DepthSystem<kModel>::AddSolution(const PreparedMatches& matches, double z,
                                      Solutions* solutions) const {
  double v[3] = {0, 0, 0};
  NullVector(z, v);
  const double v_norm2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  if (!(v_norm2 > 0.0) || !std::isfinite(v_norm2)) return;

  double c, s;
  // sin(a) / z and (1 - cos a) / z, for the deflated column.
  double s_over_z, versine_over_z;
  if constexpr (kModel == RotationModel::kExact) {
    const double w = 1.0 / (1.0 + z * z);
    c = (1.0 - z * z) * w;
    s = 2.0 * z * w;
    s_over_z = 2.0 * w;
    versine_over_z = s;
  } else {
    SineAndVersine(z, &s_over_z, &versine_over_z);
    s = z * s_over_z;
    c = 1.0 - z * versine_over_z;
  }

  const double* x1 = reference_->x1;
  const double* x2 = reference_->x2;
  // The baseline of the reference's cameras, times w: w b = d2 x2 - d1 R x1. By components: to read
  // a vector right after its parts were written makes the processor wait.
  const double bx = v[1] * x2[0] - v[0] * (c * x1[0] + s * x1[2]);
  const double by = v[1] * x2[1] - v[0] * x1[1];
  const double bz = v[1] * x2[2] - v[0] * (c * x1[2] - s * x1[0]);
  const double depth = std::abs(v[0]) + std::abs(v[1]);
  const bool has_scale =
      std::abs(v[2]) > kNoDepthScale * depth && (!deflated_ || std::abs(z) > kNoTurn);

  Eigen::Vector3d t;
  if (has_scale && deflated_) {
    // t = b + (I - R) s, both divided by z first: finite for any z.
    const double* s1 = reference_->s1;
    const double scale = z / v[2];
    t = {scale * bx + z * (versine_over_z * s1[0] - s_over_z * s1[2]), scale * by,
         scale * bz + z * (s_over_z * s1[0] + versine_over_z * s1[2])};
  } else {
    double scale;
    if (has_scale) {
      scale = 1.0 / v[2];
    } else {
      const double norm = std::sqrt(bx * bx + by * by + bz * bz);
      if (!(norm > 0.0)) return;
      // The sign that puts the reference in front of its cameras.
      scale = (v[0] + v[1] >= 0 ? 1.0 : -1.0) / norm;
    }
    t = TranslationOfBaseline(*reference_, c, s, scale * bx, scale * by, scale * bz);
  }
  Solution& solution = solutions->Append();
  solution.R = matches.alignment().Rotation(c, s);
  solution.t = matches.alignment().ToFrame2(t);
  solution.has_scale = has_scale;
}

template class DepthSystem<RotationModel::kFirstOrder>;
template class DepthSystem<RotationModel::kExact>;

}  // namespace rigel
