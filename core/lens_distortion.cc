#include "rigel/core/lens_distortion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace rigel {
namespace {

// Plain Newton steps: they converge within six inside real images, or not at all.
constexpr int kMostNewtonSteps = 10;
// Steps of a search with a bracket or with shorter steps: twice what bisection needs for 53 bits.
constexpr int kMostSafeSteps = 100;

// Whether a Newton step for a point of the radius r ends the search: what it leaves is about its
// square, and less than rounding. Steps are short near a pole as well, far from the solution.
bool IsLastStep(double step, double r, double missing, double distorted) {
  // These are relative, the square root of rounding and less.
  constexpr double kLastStep = 1e-9, kLastMissing = 1e-6;
  return step <= kLastStep * r && missing <= kLastMissing * distorted;
}

// sum of c[i] s^i, for the radius s >= 0.
struct Polynomial {
  static constexpr int kMostTerms = 16;  // degree 7 in s^2, and one power more
  double c[kMostTerms] = {};
  int size = 0;

  // A lower bound on [0, r]: what is negative taken at r, what is positive left out.
  double LowerBound(double r) const {
    double negative = 0;
    for (int i = size - 1; i > 0; --i) negative = negative * r + std::min(c[i], 0.0);
    return negative * r + c[0];
  }

  // The polynomial of s - shift.
  void MoveOrigin(double shift) {
    for (int first = 0; first + 1 < size; ++first) {
      for (int i = size - 2; i >= first; --i) c[i] += shift * c[i + 1];
    }
  }

  // A radius up to which the polynomial is positive: `most` if it is on all of [0, most], else a
  // bit below the first zero. Never beyond it. If it is `most` then it is so for any smaller one.
  double PositiveUntil(double most) const {
    if (LowerBound(most) > 0) return most;
    // Focal lengths. The first step is one that lenses bear. The last is far less than a pixel.
    constexpr double kFirstStep = 0.125, kShortestStep = 1e-7;
    // Bounds the time; in real lenses there are 10 to 60.
    constexpr int kMostSteps = 200;
    Polynomial rest = *this;
    double a = 0;
    double step = kFirstStep;
    for (int k = 0; k < kMostSteps && step > kShortestStep; ++k) {
      const bool is_last = a + step >= most;
      if (!(rest.LowerBound(is_last ? most - a : step) > 0)) {
        step /= 2;
        continue;
      }
      if (is_last) return most;
      rest.MoveOrigin(step);
      a += step;
      step *= 2;
    }
    return a;
  }
};

}  // namespace

bool LensDistortion::IsRadial() const { return p1 == 0 && p2 == 0 && s1 == 0 && s2 == 0; }

bool LensDistortion::IsIdentity() const {
  return IsRadial() && std::all_of(n, n + 4, [](double x) { return x == 0; }) &&
         std::all_of(d, d + 3, [](double x) { return x == 0; });
}

LensDistortion::Radial LensDistortion::RadialAt(double t) const {
  const double N = 1 + t * (n[0] + t * (n[1] + t * (n[2] + t * n[3])));
  const double N_t = n[0] + t * (2 * n[1] + t * (3 * n[2] + t * 4 * n[3]));
  const double D = 1 + t * (d[0] + t * (d[1] + t * d[2]));
  const double D_t = d[0] + t * (2 * d[1] + t * 3 * d[2]);
  const double factor = N / D;
  return {factor, (N_t - factor * D_t) / D};
}

// The radius of the domain, if it is not more than `most`; else `most`.
double LensDistortion::DomainRadius(double most) const {
  const double N[] = {1, n[0], n[1], n[2], n[3]};
  const double D[] = {1, d[0], d[1], d[2]};
  const int num_denominators = d[0] == 0 && d[1] == 0 && d[2] == 0 ? 1 : 4;
  // These have no unit: the bounds of the header on tangential and prism terms.
  constexpr double kPerTangential = 7.0, kPerPrism = 2.5;
  const double slope = kPerTangential * std::hypot(p1, p2) + kPerPrism * std::hypot(s1, s2);

  // The condition of the header, times D^2. With t = s^2, d(s N/D)/ds D^2 = N D + 2 t (N' D - N
  // D').
  Polynomial growth, denominator;
  growth.size = num_denominators == 1 ? 9 : Polynomial::kMostTerms;
  for (int j = 0; j < num_denominators; ++j) {
    for (int i = 0; i < 5; ++i) growth.c[2 * (i + j)] += N[i] * D[j] * (1 + 2 * (i - j));
    for (int i = 0; i < num_denominators; ++i) {
      growth.c[2 * (i + j)] -= kLeastGrowth * D[i] * D[j];
      growth.c[2 * (i + j) + 1] -= slope * D[i] * D[j];
    }
    denominator.c[2 * j] = D[j];
  }
  denominator.size = 2 * num_denominators;
  const double radius = growth.PositiveUntil(most);
  return num_denominators == 1 ? radius : denominator.PositiveUntil(radius);
}

bool LensDistortion::InDomain(const Eigen::Vector2d& m) const {
  const double r = m.norm();
  // Also false for NaN.
  return r <= kWidestRadius && DomainRadius(r) >= r;
}

Eigen::Vector2d LensDistortion::Distort(const Eigen::Vector2d& m, Eigen::Matrix2d* J) const {
  const double u = m.x();
  const double v = m.y();
  const double uu = u * u;
  const double uv = u * v;
  const double vv = v * v;
  const double t = uu + vv;
  const Radial radial = RadialAt(t);
  if (J != nullptr) {
    const double diagonal = 2 * (p1 * u + p2 * v) + 2 * radial.derivative * uv;
    *J << radial.factor + 2 * (radial.derivative * uu + p1 * v + 3 * p2 * u + s1 * u),
        diagonal + 2 * s1 * v, diagonal + 2 * s2 * u,
        radial.factor + 2 * (radial.derivative * vv + 3 * p1 * v + p2 * u + s2 * v);
  }
  return {u * radial.factor + 2 * p1 * uv + p2 * (t + 2 * uu) + s1 * t,
          v * radial.factor + p1 * (t + 2 * vv) + 2 * p2 * uv + s2 * t};
}

bool LensDistortion::Undistort(const Eigen::Vector2d& distorted, Eigen::Vector2d* m) const {
  if (IsIdentity()) {
    *m = distorted;
    return true;
  }
  if (!IsRadial()) {
    return UndistortByNewton(distorted, m) || UndistortSafely(distorted, m);
  }
  const double length = distorted.norm();
  double r = 0;
  if (!UndistortRadius(length, &r)) return false;
  *m = length > 0 ? Eigen::Vector2d(distorted * (r / length)) : distorted;
  return true;
}

bool LensDistortion::UndistortByNewton(const Eigen::Vector2d& distorted, Eigen::Vector2d* m) const {
  const double length = distorted.norm();
  Eigen::Vector2d x = distorted;
  for (int k = 0; k < kMostNewtonSteps; ++k) {
    Eigen::Matrix2d J;
    const Eigen::Vector2d missing = distorted - Distort(x, &J);
    const Eigen::Vector2d step = J.inverse() * missing;
    x += step;
    if (IsLastStep(step.norm(), x.norm(), missing.norm(), length)) {
      *m = x;
      return InDomain(x);
    }
  }
  return false;
}

// Of radial distortions: r N/D = distorted. Newton, and a bracket where that leaves the domain.
bool LensDistortion::UndistortRadius(double distorted, double* r) const {
  double x = distorted;
  for (int k = 0; k < kMostNewtonSteps; ++k) {
    const Radial radial = RadialAt(x * x);
    const double missing = distorted - x * radial.factor;
    const double step = missing / (radial.factor + 2 * x * x * radial.derivative);
    x += step;
    if (IsLastStep(std::abs(step), x, std::abs(missing), distorted)) {
      if (!InDomain({x, 0})) break;
      *r = x;
      return true;
    }
  }
  *r = SafeRadius(distorted);
  const double missing = std::abs(*r * RadialAt(*r * *r).factor - distorted);
  // Relative: hundreds of times what rounding leaves.
  constexpr double kMostMissing = 1e-12;
  return missing <= kMostMissing * distorted;
}

// The radius of the domain with the image nearest to `distorted`, by Newton's steps where they stay
// in the bracket and by halving it where not.
double LensDistortion::SafeRadius(double distorted) const {
  double low = 0;
  double high = DomainRadius(kWidestRadius);
  double x = std::min(distorted, high);
  for (int k = 0; k < kMostSafeSteps; ++k) {
    const Radial radial = RadialAt(x * x);
    const double missing = distorted - x * radial.factor;
    const double step = missing / (radial.factor + 2 * x * x * radial.derivative);
    if (IsLastStep(std::abs(step), x, std::abs(missing), distorted)) return x + step;
    (missing > 0 ? low : high) = x;
    x += step;
    if (!(x > low && x < high)) x = 0.5 * (low + high);
  }
  return x;
}

// From the solution without the tangential terms, by Newton's steps that are shortened until they
// stay in the domain and come closer.
bool LensDistortion::UndistortSafely(const Eigen::Vector2d& distorted, Eigen::Vector2d* m) const {
  const double length = distorted.norm();
  if (!(length > 0)) return false;
  Eigen::Vector2d x = distorted * (SafeRadius(length) / length);
  Eigen::Matrix2d J;
  Eigen::Vector2d missing = distorted - Distort(x, &J);
  double step_share = 1;
  for (int k = 0; k < kMostSafeSteps; ++k) {
    const Eigen::Vector2d step = step_share * (J.inverse() * missing);
    const Eigen::Vector2d next = x + step;
    if (IsLastStep(step.norm(), next.norm(), missing.norm(), length)) {
      *m = next;
      return InDomain(next);
    }
    Eigen::Matrix2d next_J;
    const Eigen::Vector2d next_missing = distorted - Distort(next, &next_J);
    if (!InDomain(next) || !(next_missing.squaredNorm() < missing.squaredNorm())) {
      step_share /= 2;
      continue;
    }
    x = next;
    J = next_J;
    missing = next_missing;
    step_share = std::min(2 * step_share, 1.0);
  }
  return false;
}

}  // namespace rigel
