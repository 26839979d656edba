// Roots of quartics, quintics with one root far off and sextics with two, in closed form: several
// times as fast as isolation. Each function says where rounding leaves the number of real
// roots open, and polynomial.h then isolates them: no root is lost.
//
// Coefficients ascend, as in polynomial.h. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_CLOSED_FORM_ROOTS_H_
#define RIGEL_MINIMAL_NUMERICS_CLOSED_FORM_ROOTS_H_

#include <algorithm>
#include <cmath>

#include "rigel/minimal/numerics/newton_lanes.h"

namespace rigel::polynomial_internal {

inline constexpr double kSqrt3 = 1.73205080756887729353;
inline constexpr int kUndecided = -1;

// Interpolations at the Chebyshev nodes of [0, 1], of degrees 8 and 9, ascending in u: of
// cos(2/3 acos(u)), and of sin(2/3 acos(u)) / sqrt(1 - u^2). The test ChebyshevCoefficients of
// closed_form_roots_test.cc computes these numbers again. One degree more gains a digit that
// Newton's method gains anyway.
inline constexpr double kCosineOfThird[9] = {
    0.500000003733184,     0.5773496613984087,    -0.1110944927672062,
    0.05327935084772565,   -0.03192541213689045,  0.019600320923119502,
    -0.010237508312381276, 0.0036541195584302638, -0.0006260453210416017};
inline constexpr double kSineOfThird[10] = {
    0.8660253981308746,  -0.33333219731284364,  0.24052423201262865, -0.19701720924169042,
    0.16792523920306976, -0.13867390493998213,  0.09997340370831578, -0.054957087077968925,
    0.01938336009625346, -0.0031845708330365597};

// Cosine and sine of acos(r) / 3 for r in [-1, 1], within 6e-9. With u = cos(acos(r) / 2) they are
// cos(2/3 acos(u)) and sin(2/3 acos(u)): smooth functions of u, but for the factor sqrt(1 - u^2).
inline void CosAndSinOfThird(double r, double* cosine, double* sine) {
  const double u = std::sqrt(0.5 * (1.0 + r));
  const double sine_of_half = std::sqrt(0.5 * (1.0 - r));
  const double u2 = u * u;
  const double u4 = u2 * u2;
  // Estrin's scheme, as in newton_lanes.h.
  constexpr const double* c = kCosineOfThird;
  constexpr const double* s = kSineOfThird;
  *cosine = ((c[0] + c[1] * u) + u2 * (c[2] + c[3] * u)) +
            u4 * ((c[4] + c[5] * u) + u2 * (c[6] + c[7] * u) + u4 * c[8]);
  *sine =
      sine_of_half * (((s[0] + s[1] * u) + u2 * (s[2] + s[3] * u)) +
                      u4 * ((s[4] + s[5] * u) + u2 * (s[6] + s[7] * u) + u4 * (s[8] + s[9] * u)));
}

// Cosine and sine of acos(r) / 3 for any r, which is cut to [-1, 1]. They are exact near the ends.
// There two roots of a cubic are close, and the approximation above would shift them by too much.
inline void TrisectAngle(double r, double* cosine, double* sine) {
  constexpr double kApart = 1e-4;  // of r: the roots differ by more than the approximation's error
  if (std::abs(r) < 1.0 - kApart) {
    CosAndSinOfThird(r, cosine, sine);
    return;
  }
  const double third = std::acos(std::clamp(r, -1.0, 1.0)) / 3.0;
  *cosine = std::cos(third);
  *sine = std::sin(third);
}

// Newton's method on p of degree N from `count` <= N starts at once, as the steps of one depend on
// one another. False unless all converge, to different roots.
template <int N>
inline bool NewtonFromGoodStarts(const double* c, int count, double* x) {
  // From good starts each step doubles the digits. What takes more steps than these is left to
  // isolation, which is slower and misses nothing.
  constexpr int kMaxSteps = 5;
  constexpr double kLastStep = 1e-9;  // relative; the error left is of the order of its square
  // Relative to the root. Closer ones may be one that was found twice, and are left to isolation.
  constexpr double kDistinct = 1e-6;
  const PolynomialInLanes<N> p(c);
  Lanes<N> lane = LanesOf<N>(x, count);
  bool converged = false;
  for (int n = 0; n < kMaxSteps && !converged; ++n) {
    const Lanes<N> step = p.NewtonStep(lane);
    lane -= step;
    converged = (step.abs() <= kLastStep * lane.abs()).all();
  }
  if (!converged) return false;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < i; ++j) {
      if (!(std::abs(lane[i] - lane[j]) > kDistinct * std::abs(lane[i]))) return false;
    }
    x[i] = lane[i];
  }
  return true;
}

// Relative to the terms of a difference whose sign decides whether roots are real. The sign of a
// smaller one may be that of the errors, of which the largest is the 6e-9 of CosAndSinOfThird().
inline constexpr double kUncertainSign = 1e-6;

// The real roots of a quartic, to some 1e-7 of the largest, by Ferrari's resolvent; kUndecided
// where a pair of them may be real or complex.
inline int QuarticStarts(const double* c, double* x) {
  const double inverse = 1.0 / c[4];
  const double h = 0.25 * c[3] * inverse;
  const double a2 = c[2] * inverse;
  const double a1 = c[1] * inverse;
  const double h2 = h * h;
  // x = y - h: y^4 + p y^2 + q y + r.
  const double p = a2 - 6.0 * h2;
  const double q = a1 - 2.0 * h * (a2 - 4.0 * h2);
  const double r = c[0] * inverse - h * a1 + h2 * (a2 - 3.0 * h2);
  // (y^2 + u y + v)(y^2 - u y + w), s = u^2: the largest root of s^3 + 2 p s^2 + (p^2 - 4 r) s -
  // q^2.
  const double third = 2.0 / 3.0 * p;
  const double linear = p * p - 4.0 * r;
  const double Q = third * third - linear * (1.0 / 3.0);
  const double R = third * (third * third - 0.5 * linear) - 0.5 * q * q;
  const double Q3 = Q * Q * Q;
  double s;
  if (R * R < Q3) {
    const double root_Q = std::sqrt(Q);
    double cosine, sine;
    CosAndSinOfThird(R / (Q * root_Q), &cosine, &sine);
    s = root_Q * (cosine + kSqrt3 * sine) - third;
  } else {
    const double magnitude = std::cbrt(std::abs(R) + std::sqrt(R * R - Q3));
    const double A = R > 0 ? -magnitude : magnitude;
    s = A + (A != 0.0 ? Q / A : 0.0) - third;
  }
  if (!(s > kUncertainSign * std::abs(third)) || !(s * s > kUncertainSign * std::abs(r)))
    return kUndecided;
  const double u = std::sqrt(s);
  const double v = 0.5 * (p + s - q / u);
  const double w = 0.5 * (p + s + q / u);
  const double d1 = s - 4.0 * v;
  const double d2 = s - 4.0 * w;
  const double size = s + 4.0 * (std::abs(v) + std::abs(w)) + h2;
  if (!(std::abs(d1) > kUncertainSign * size) || !(std::abs(d2) > kUncertainSign * size))
    return kUndecided;
  int count = 0;
  if (d1 > 0.0) {
    const double e = std::sqrt(d1);
    x[count++] = 0.5 * (-u + e) - h;
    x[count++] = 0.5 * (-u - e) - h;
  }
  if (d2 > 0.0) {
    const double e = std::sqrt(d2);
    x[count++] = 0.5 * (u + e) - h;
    x[count++] = 0.5 * (u - e) - h;
  }
  return count;
}

// A quintic without its largest root 1 / y, if that is far from the others.
inline bool SplitFarRoot(const double* c, double* quartic, double* y) {
  // Of y, where the typical root is near 1: the far root is at least four times as large. The
  // nearer one is, the more steps it takes; it is left to isolation then.
  constexpr double kLargestInverse = 0.25;
  // Newton's method in y, from a good start: each step doubles the digits.
  constexpr int kMaxSteps = 6;
  constexpr double kLastStep = 1e-8;  // relative; the error left is of the order of its square
  // Of c[5], which the division may miss by so much: some hundreds of roundings.
  constexpr double kRemainder = 1e-13;
  *y = -c[5] / c[4];
  if (!(std::abs(*y) < kLargestInverse)) return false;
  double step = *y;
  for (int n = 0; n < kMaxSteps && std::abs(step) > kLastStep * std::abs(*y); ++n) {
    double value = c[0];
    double slope = 0.0;
    for (int k = 1; k <= 5; ++k) {
      slope = slope * *y + value;
      value = value * *y + c[k];
    }
    step = value / slope;
    *y -= step;
  }
  if (!(std::abs(*y) < kLargestInverse)) return false;
  // What is left without it, from the smallest coefficients up: stable for the largest root.
  quartic[0] = c[0];
  for (int k = 1; k <= 4; ++k) quartic[k] = c[k] + *y * quartic[k - 1];
  return std::abs(c[5] + *y * quartic[4]) <= kRemainder * std::abs(c[5]);
}

// A sextic without its two largest roots, if they are far from the others: those of
// 1 + b x + g x^2.
inline bool SplitFarPair(const double* c, double* quartic, double* b, double* g) {
  constexpr int kMaxSteps = 8;  // each divides the error by how far the pair is
  // Relative change of g and b^2. Not to the last digit, as Newton's method on the sextic itself
  // follows.
  constexpr double kLastChange = 1e-10;
  *g = c[6] / c[4];
  *b = c[5] / c[4];
  quartic[0] = c[0];
  for (int n = 0; n < kMaxSteps; ++n) {
    // The quotient from the smallest coefficients up; b and g such that nothing is left over.
    quartic[1] = c[1] - *b * quartic[0];
    quartic[2] = c[2] - *b * quartic[1] - *g * quartic[0];
    quartic[3] = c[3] - *b * quartic[2] - *g * quartic[1];
    quartic[4] = c[4] - *b * quartic[3] - *g * quartic[2];
    const double inverse = 1.0 / quartic[4];
    const double next_g = c[6] * inverse;
    const double next_b = (c[5] - next_g * quartic[3]) * inverse;
    const double change = std::abs(next_g - *g) + std::abs(next_b - *b) * std::abs(*b);
    *g = next_g;
    *b = next_b;
    if (change <= kLastChange * (std::abs(next_g) + next_b * next_b)) return true;
  }
  return false;
}

// All real roots of a quartic, of a quintic whose largest root is far from the others or of a
// sextic whose two largest are; kUndecided if the number of roots is not certain. `c` is scaled
// such that its typical roots are near 1.
template <int N>
inline int RootsInClosedForm(const double* c, double* roots) {
  static_assert(N >= 4 && N <= 6);
  double quartic[5];
  int count = 0;
  double y = 0.0;  // 1 / |x| of the nearest of the far roots x
  if constexpr (N == 4) {
    std::copy(c, c + 5, quartic);
  } else if constexpr (N == 5) {
    if (!SplitFarRoot(c, quartic, &y)) return kUndecided;
    roots[count++] = 1.0 / y;
  } else {
    double b, g;
    if (!SplitFarPair(c, quartic, &b, &g)) return kUndecided;
    const double half = 0.5 * b;
    const double discriminant = half * half - g;
    if (!(std::abs(discriminant) > kUncertainSign * (half * half + std::abs(g)))) return kUndecided;
    if (discriminant > 0.0) {
      y = -half - std::copysign(std::sqrt(discriminant), half);
      roots[count++] = 1.0 / y;
      roots[count++] = y / g;
    } else {
      y = std::sqrt(g);
    }
  }
  // The far roots are so many times as large as the others at least, else the closed form may have
  // left some of the digits that tell them apart.
  constexpr double kFarRatio = 2.0;
  const int others = QuarticStarts(quartic, roots + count);
  if (others == kUndecided) return kUndecided;
  for (int k = 0; k < others; ++k) {
    if (!(std::abs(roots[count + k] * y) < 1.0 / kFarRatio)) return kUndecided;
  }
  count += others;
  if (count == 0) return 0;
  return NewtonFromGoodStarts<N>(c, count, roots) ? count : kUndecided;
}

}  // namespace rigel::polynomial_internal

#endif  // RIGEL_MINIMAL_NUMERICS_CLOSED_FORM_ROOTS_H_
