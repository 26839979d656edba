// Real roots of polynomials: closed forms to degree 3 and, where they are certain, to degree 6;
// else isolation by Descartes' rule and safeguarded Newton steps.
//
// Coefficients ascend: p(x) = c[0] + c[1] x + ... + c[N] x^N. Every function returns the number
// of roots that it wrote to `roots` (at most the degree), in no particular order. A leading
// coefficient below 1e-14 of the largest one is taken as zero: its root is beyond 1e14 or so.
// The zero polynomial has no roots. Non-finite coefficients give no roots. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_H_
#define RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_H_

#include <algorithm>
#include <cmath>

#include "rigel/minimal/numerics/closed_form_roots.h"
#include "rigel/minimal/numerics/newton_lanes.h"
#include "rigel/minimal/numerics/polynomial_values.h"
#include "rigel/minimal/numerics/root_isolation.h"

namespace rigel {

template <int N>
int RealRoots(const double* c, double* roots);

namespace polynomial_internal {

// Relative to the largest coefficient. Less is what rounding may have left of a zero, and stands
// for a root beyond 1e14 or so.
inline constexpr double kTinyLeading = 1e-14;

// Relative to the terms of a discriminant: a few roundings.
inline constexpr double kDiscriminantRounding = 1e-15;

template <int N>
inline bool AllFinite(const double* c) {
  // 0 times an infinity or a NaN is a NaN.
  double poison = 0.0;
  for (int k = 0; k <= N; ++k) poison += 0.0 * c[k];
  return poison == 0.0;
}

template <int N>
inline bool LeadingIsZero(const double* c) {
  double largest = 0.0;
  for (int k = 0; k < N; ++k) largest = std::max(largest, std::abs(c[k]));
  return !(std::abs(c[N]) > kTinyLeading * largest);
}

// Takes two Newton steps on each of `count` <= N roots. If the second step is not much smaller than
// the first, a step is taken only if it makes |p| smaller.
template <int N>
inline void Polish(const double* c, int count, double* roots) {
  const PolynomialInLanes<N> p(c);
  const Lanes<N> x = LanesOf<N>(roots, count);
  const Lanes<N> step = p.NewtonStep(x);
  const Lanes<N> next = x - step;
  const Lanes<N> next_step = p.NewtonStep(next);
  // Relative to the root. Steps below it are rounding, and need not become smaller.
  constexpr double kRounding = 1e-14;
  // Relative to the largest root. The starts are better than this; a larger step comes from a slope
  // that is nearly zero, as at a double root.
  constexpr double kSmall = 1e-4;
  // Of the first step, the largest second one. At a single root it is far smaller, at a double root
  // half of the first.
  constexpr double kContraction = 0.25;
  if ((step.abs() <= kSmall * x.abs().maxCoeff()).all() &&
      (next_step.abs() <= kContraction * step.abs() + kRounding * x.abs()).all()) {
    const Lanes<N> polished = next - next_step;
    for (int l = 0; l < count; ++l) roots[l] = polished[l];
    return;
  }
  for (int l = 0; l < count; ++l) {
    double slope;
    double value = EvaluatePolynomial<N>(c, roots[l], &slope);
    for (int n = 0; n < 2; ++n) {
      const double candidate = roots[l] - value / slope;
      double candidate_slope;
      const double candidate_value = EvaluatePolynomial<N>(c, candidate, &candidate_slope);
      // Also for a slope of zero.
      if (!(std::abs(candidate_value) < std::abs(value))) break;
      roots[l] = candidate;
      value = candidate_value;
      slope = candidate_slope;
    }
  }
}

// The power of two next to |a / b|^(1/n), within 2^-60 and 2^60; 1 if either is zero.
template <int n>
inline double PowerOfTwoRoot(double a, double b) {
  if (a == 0.0 || b == 0.0) return 1.0;
  int exponent_a = 0;
  int exponent_b = 0;
  std::frexp(a, &exponent_a);
  std::frexp(b, &exponent_b);
  return std::ldexp(1.0, std::clamp((exponent_a - exponent_b) / n, -60, 60));
}

}  // namespace polynomial_internal

template <>
inline int RealRoots<1>(const double* c, double* roots) {
  if (!polynomial_internal::AllFinite<1>(c) || polynomial_internal::LeadingIsZero<1>(c)) return 0;
  roots[0] = -c[0] / c[1];
  return 1;
}

template <>
inline int RealRoots<2>(const double* c, double* roots) {
  if (!polynomial_internal::AllFinite<2>(c)) return 0;
  if (polynomial_internal::LeadingIsZero<2>(c)) return RealRoots<1>(c, roots);
  const double half_b = 0.5 * c[1];
  const double discriminant = half_b * half_b - c[2] * c[0];
  // A double root survives the rounding of its discriminant.
  if (!(discriminant >= -polynomial_internal::kDiscriminantRounding * half_b * half_b)) return 0;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  const double s = half_b >= 0 ? -half_b - root : -half_b + root;
  roots[0] = s / c[2];
  if (s == 0.0) return 1;  // a double root at zero
  roots[1] = c[0] / s;
  return 2;
}

// Roots of a cubic to 1e-6 of the largest, as a rule to 1e-8: starts of an iteration.
inline int CubicStarts(const double* c, double* roots) {
  if (!polynomial_internal::AllFinite<3>(c)) return 0;
  if (polynomial_internal::LeadingIsZero<3>(c)) return RealRoots<2>(c, roots);
  // If one root is far from the other two, rounding would spoil either it or them below. It is
  // divided out first, from the end where that is stable. Each step divides the error by kFar.
  constexpr double kFar = 1e-4;
  constexpr int kSteps = 4;  // kFar^4 is below rounding
  const double c1_2 = c[1] * c[1];
  const double c2_2 = c[2] * c[2];
  if (std::abs(c[3] * c[1]) < kFar * c2_2 &&
      c[3] * c[3] * std::abs(c[0]) < kFar * kFar * c2_2 * std::abs(c[2])) {
    double q[3] = {c[0], c[1], c[2]};
    double y = 0.0;  // 1 / x
    for (int n = 0; n < kSteps; ++n) {
      y = -c[3] / q[2];
      q[1] = c[1] + y * c[0];
      q[2] = c[2] + y * q[1];
    }
    const int count = RealRoots<2>(q, roots);
    roots[count] = 1.0 / y;
    return count + 1;
  }
  if (std::abs(c[0] * c[2]) < kFar * c1_2 &&
      c[0] * c[0] * std::abs(c[3]) < kFar * kFar * c1_2 * std::abs(c[1])) {
    double q[3] = {c[1], c[2], c[3]};
    double x = 0.0;
    for (int n = 0; n < kSteps; ++n) {
      x = -c[0] / q[0];
      q[1] = c[2] + x * c[3];
      q[0] = c[1] + x * q[1];
    }
    const int count = RealRoots<2>(q, roots);
    roots[count] = x;
    return count + 1;
  }
  // Depressed form (Press et al., Numerical Recipes, section 5.6).
  const double inv = 1.0 / c[3];
  const double a = c[2] * inv;
  const double b = c[1] * inv;
  const double d = c[0] * inv;
  constexpr double kThird = 1.0 / 3.0;
  const double third_a = kThird * a;
  const double Q = third_a * third_a - kThird * b;
  const double R = third_a * (third_a * third_a - 0.5 * b) + 0.5 * d;
  const double Q3 = Q * Q * Q;
  int count = 0;
  if (R * R < Q3) {
    const double root_Q = std::sqrt(Q);
    const double cosine = R / (Q * root_Q);
    double cos_third, sin_third;
    polynomial_internal::TrisectAngle(cosine, &cos_third, &sin_third);
    roots[0] = -2.0 * root_Q * cos_third - third_a;
    roots[1] = root_Q * (cos_third + polynomial_internal::kSqrt3 * sin_third) - third_a;
    roots[2] = root_Q * (cos_third - polynomial_internal::kSqrt3 * sin_third) - third_a;
    count = 3;
  } else {
    const double magnitude = std::cbrt(std::abs(R) + std::sqrt(R * R - Q3));
    const double A = R > 0 ? -magnitude : magnitude;
    const double B = A != 0.0 ? Q / A : 0.0;
    roots[0] = A + B - third_a;
    count = 1;
    // On the border the other two coincide. Rounding moves A - B by the root of itself, and the
    // value there by hundreds of roundings; both relative to their terms.
    constexpr double kBorder = 1e-7;
    constexpr double kZeroValue = 1e-13;
    if (std::abs(A - B) <= kBorder * (std::abs(A) + std::abs(third_a))) {
      const double twice = -0.5 * (A + B) - third_a;
      if (std::abs(EvaluatePolynomial<3>(c, twice)) <=
          kZeroValue * PolynomialMagnitude<3>(c, twice)) {
        roots[count++] = twice;
      }
    }
  }
  return count;
}

template <>
inline int RealRoots<3>(const double* c, double* roots) {
  const int count = CubicStarts(c, roots);
  if (count > 0) polynomial_internal::Polish<3>(c, count, roots);
  return count;
}

// Degree 4 and above: degrees 4 to 6 in closed form where that is certain of the number of roots,
// else by isolation.
template <int N>
int RealRoots(const double* c, double* roots) {
  static_assert(N >= 4);
  if (!polynomial_internal::AllFinite<N>(c)) return 0;
  if (polynomial_internal::LeadingIsZero<N>(c)) return RealRoots<N - 1>(c, roots);
  int count = 0;
  if (c[0] == 0.0) {
    // A root at zero exactly; its multiplicity is of no interest.
    roots[count++] = 0.0;
    int shift = 1;
    while (c[shift] == 0.0) ++shift;
    double rest[N + 1] = {};
    for (int k = shift; k <= N; ++k) rest[k - shift] = c[k];
    double others[N + 1];
    const int num_others = RealRoots<N - 1>(rest, others);
    for (int k = 0; k < num_others && count < N; ++k) roots[count++] = others[k];
    return count;
  }

  // A double root at zero that rounding has made complex is seen by neither piece beside it.
  double largest = 0.0;
  for (int k = 0; k <= N; ++k) largest = std::max(largest, std::abs(c[k]));
  // c[0] of it is rounding, and c[2], relative to the largest coefficient, not small.
  constexpr double kCurved = 1e-6;
  if (std::abs(c[0]) <= polynomial_internal::kValueRounding * largest &&
      std::abs(c[2]) >= kCurved * largest && c[1] * c[1] < 4.0 * c[0] * c[2]) {
    roots[count++] = 0.0;
  }

  // Cut at a typical root instead of at 1: x = scale y, a power of two, so that nothing is rounded.
  // The leading root is left out of the mean, since it is often far off (a solver's polynomials
  // have a group of roots of the size of the parallax and one beyond).
  const double scale = polynomial_internal::PowerOfTwoRoot<N - 1>(c[0], c[N - 1]);
  double scaled[N + 1];
  double power = 1.0;
  for (int k = 0; k <= N; ++k) {
    scaled[k] = c[k] * power;
    power *= scale;
  }
  c = scaled;

  if constexpr (N <= 6) {
    const int found = count > 0 ? polynomial_internal::kUndecided
                                : polynomial_internal::RootsInClosedForm<N>(c, roots);
    if (found != polynomial_internal::kUndecided) {
      for (int k = 0; k < found; ++k) roots[k] *= scale;
      return found;
    }
  }

  const int found = polynomial_internal::IsolatedRoots<N>(c, N - count, roots + count);
  for (int k = 0; k < found; ++k) roots[count++] *= scale;
  return count;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_H_
