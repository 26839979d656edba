#include "rigel/minimal/solvers/two_point_ackermann.h"

#include <cmath>

#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/baseline.h"

namespace rigel {
namespace {

// Metres: coefficients of k that sum to less are rounding.
constexpr double kZeroMoments = 1e-12;

// Two matches as tau e(z) + k(z) = 0, z = tan(a/2).
class AckermannSample {
 public:
  AckermannSample(const PreparedMatches& matches, const int* sample);

  // False if there is no forward direction within the plane, or nothing moves.
  bool solvable() const { return solvable_; }

  // Writes the values of z, at most three, and returns their number.
  int Roots(double* roots) const;

  // Adds the motion of a root z. Adds nothing if tau is not determined.
  void AddSolution(double z, Solutions* solutions) const;

 private:
  // (tau, w), orthogonal to the better conditioned row: tau / w is tau, w / z if deflated.
  Eigen::Vector2d NullVector(double z) const;

  const PreparedMatches& matches_;
  const PreparedMatch* m_[2];
  bool solvable_ = false;
  bool deflated_ = false;     // k is divided by z
  bool k_vanishes_ = false;   // a camera above the body's origin: one match would do for the angle
  double fx_ = 0, fz_ = 0;    // the forward direction, a unit vector
  double e_[2][2], k_[2][3];  // coefficients of each match, ascending
};

AckermannSample::AckermannSample(const PreparedMatches& matches, const int* sample)
    : matches_(matches), m_{&matches[sample[0]], &matches[sample[1]]} {
  // The least share of the forward direction within the plane: less is along the plane's normal.
  constexpr double kMinForward = 1e-9;
  const Alignment& alignment = matches.alignment();
  const double fx = alignment.forward.x();
  const double fz = alignment.forward.z();
  const double f_norm = std::sqrt(fx * fx + fz * fz);
  if (!(f_norm > kMinForward)) return;
  if (!(m_[0]->parallax2 + m_[1]->parallax2 > kNoParallax2)) return;
  solvable_ = true;
  fx_ = fx / f_norm;
  fz_ = fz / f_norm;
  deflated_ = alignment.contains_identity && m_[0]->camera1 == m_[0]->camera2 &&
              m_[1]->camera1 == m_[1]->camera2;
  double k_size = 0.0;
  for (int r = 0; r < 2; ++r) {
    const PreparedMatch& m = *m_[r];
    e_[r][0] = fx_ * (m.X0 + m.Xc) + fz_ * (m.Z0 + m.Xs);
    e_[r][1] = fx_ * (m.Xs - m.Z0) + fz_ * (m.X0 - m.Xc);
    const double k0 = m.K0 + m.Kc;
    const double k1 = 2.0 * m.Ks;
    const double k2 = m.K0 - m.Kc;
    k_[r][0] = deflated_ ? k1 : k0;
    k_[r][1] = deflated_ ? k2 : k1;
    k_[r][2] = deflated_ ? 0.0 : k2;
    k_size += std::abs(k_[r][0]) + std::abs(k_[r][1]) + std::abs(k_[r][2]);
  }
  k_vanishes_ = k_size < kZeroMoments;
}

int AckermannSample::Roots(double* roots) const {
  if (k_vanishes_) {
    // e(z) = 0 of both matches, by least squares.
    const double slope2 = e_[0][1] * e_[0][1] + e_[1][1] * e_[1][1];
    if (!(slope2 > 0.0)) return 0;
    roots[0] = -(e_[0][0] * e_[0][1] + e_[1][0] * e_[1][1]) / slope2;
    return 1;
  }
  // e1 k2 - e2 k1.
  const double c[4] = {
      e_[0][0] * k_[1][0] - e_[1][0] * k_[0][0],
      e_[0][0] * k_[1][1] + e_[0][1] * k_[1][0] - e_[1][0] * k_[0][1] - e_[1][1] * k_[0][0],
      e_[0][0] * k_[1][2] + e_[0][1] * k_[1][1] - e_[1][0] * k_[0][2] - e_[1][1] * k_[0][1],
      e_[0][1] * k_[1][2] - e_[1][1] * k_[0][2]};
  return deflated_ ? RealRoots<2>(c, roots) : RealRoots<3>(c, roots);
}

Eigen::Vector2d AckermannSample::NullVector(double z) const {
  if (k_vanishes_) return {1.0, 0.0};
  double tau = 0.0;
  double w = 0.0;
  double best = 0.0;
  for (int r = 0; r < 2; ++r) {
    const double er = e_[r][0] + z * e_[r][1];
    const double kr = k_[r][0] + z * (k_[r][1] + z * k_[r][2]);
    const double norm2 = er * er + kr * kr;
    if (norm2 > best) {
      best = norm2;
      tau = -kr;
      w = er;
    }
  }
  return {tau, w};
}

void AckermannSample::AddSolution(double z, Solutions* solutions) const {
  const Eigen::Vector2d v = NullVector(z);
  const double tau = v[0];
  const double w = v[1];
  if (tau == 0.0 && w == 0.0) return;
  const double inverse = 1.0 / (1.0 + z * z);
  const double c = (1.0 - z * z) * inverse;
  const double s = 2.0 * z * inverse;
  if (!std::isfinite(c + s + tau + w)) return;

  // R_y(a/2) f sqrt(1 + z^2).
  const Eigen::Vector3d chord(fx_ + z * fz_, 0.0, fz_ - z * fx_);
  const bool has_scale =
      std::abs(w) > kNoScale * std::abs(tau) && (!deflated_ || std::abs(z) > kNoTurn);
  const PreparedMatch& reference = m_[0]->parallax2 >= m_[1]->parallax2 ? *m_[0] : *m_[1];
  const Eigen::Vector3d t = has_scale ? chord * ((deflated_ ? z : 1.0) * tau * inverse / w)
                                      : UnitBaselineTranslation(reference, c, s, chord);
  Solution& solution = solutions->Append();
  solution.R = matches_.alignment().Rotation(c, s);
  solution.t = matches_.alignment().ToFrame2(t);
  solution.has_scale = has_scale;
}

}  // namespace

int Solve2ptAckermann(const PreparedMatches& matches, const int* sample, Solutions* solutions) {
  solutions->clear();
  const AckermannSample system(matches, sample);
  if (!system.solvable()) return 0;
  double roots[3];
  const int num_roots = system.Roots(roots);
  for (int n = 0; n < num_roots; ++n) system.AddSolution(roots[n], solutions);
  return solutions->size();
}

}  // namespace rigel
