// Real roots of polynomials: closed forms to degree 3, above that isolation by Descartes' rule and
// safeguarded Newton steps.
//
// Coefficients ascend: p(x) = c[0] + c[1] x + ... + c[N] x^N. Every function returns the number
// of roots that it wrote to `roots` (at most the degree), in no particular order. A leading
// coefficient below 1e-14 of the largest one is taken as zero: its root is beyond 1e14 or so.
// The zero polynomial has no roots. Non-finite coefficients give no roots. No heap.
#ifndef RIGEL_MINIMAL_POLYNOMIAL_H_
#define RIGEL_MINIMAL_POLYNOMIAL_H_

#include <algorithm>
#include <cmath>

namespace rigel {

// p(x) of degree N by Horner's rule.
template <int N>
inline double EvaluatePolynomial(const double* c, double x) {
  double value = c[N];
  for (int k = N - 1; k >= 0; --k) value = value * x + c[k];
  return value;
}

// p(x) and p'(x).
template <int N>
inline double EvaluatePolynomial(const double* c, double x, double* derivative) {
  double value = c[N];
  double slope = 0.0;
  for (int k = N - 1; k >= 0; --k) {
    slope = slope * x + value;
    value = value * x + c[k];
  }
  *derivative = slope;
  return value;
}

// sum |c[k] x^k|: rounding in p(x) is a small multiple of 1e-16 of it.
template <int N>
inline double PolynomialMagnitude(const double* c, double x) {
  const double ax = std::abs(x);
  double value = std::abs(c[N]);
  for (int k = N - 1; k >= 0; --k) value = value * ax + std::abs(c[k]);
  return value;
}

template <int N>
int RealRoots(const double* c, double* roots);

namespace polynomial_internal {

inline constexpr double kTinyLeading = 1e-14;

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

// `steps` Newton steps; steps that do not reduce |p| are not taken.
template <int N>
inline double Polish(const double* c, double x, int steps) {
  double slope = 0.0;
  double value = EvaluatePolynomial<N>(c, x, &slope);
  for (int k = 0; k < steps && slope != 0.0; ++k) {
    const double next = x - value / slope;
    double next_slope = 0.0;
    const double next_value = EvaluatePolynomial<N>(c, next, &next_slope);
    if (!(std::abs(next_value) < std::abs(value))) break;
    x = next;
    value = next_value;
    slope = next_slope;
  }
  return x;
}

// The only root of p in (low, high), between which p changes sign; `low_negative` is the sign just
// above `low`, `x` a first guess.
template <int N>
inline double BracketedNewton(const double* c, double low, double high, bool low_negative,
                              double x) {
  for (int k = 0; k < 100; ++k) {
    double slope = 0.0;
    const double value = EvaluatePolynomial<N>(c, x, &slope);
    if (value == 0.0) return x;
    if ((value < 0) == low_negative) {
      low = x;
    } else {
      high = x;
    }
    double next = x - value / slope;
    if (!(next > low && next < high)) {
      next = 0.5 * (low + high);
      if (next == low || next == high) return next;
    } else if (std::abs(next - x) <= 1e-9 * std::abs(next)) {
      // Quadratic convergence: what is left is of the order of the step squared.
      return next;
    }
    x = next;
  }
  return x;
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

// 1 / C(N, j).
template <int N>
struct InverseBinomials {
  double value[N + 1] = {};
  constexpr InverseBinomials() {
    double binomial = 1.0;
    for (int j = 0; j <= N; ++j) {
      value[j] = 1.0 / binomial;
      binomial = binomial * (N - j) / (j + 1);
    }
  }
};

// Bernstein coefficients on (0, 1) of the polynomial c; the last one is p(1) = `at_one`.
template <int N>
inline void BernsteinOnUnitInterval(const double* c, double at_one, double* b) {
  // b_k = sum_j C(k, j) / C(N, j) c_j, by running sums.
  constexpr InverseBinomials<N> kInverse;
  for (int j = 0; j <= N; ++j) b[j] = c[j] * kInverse.value[j];
  for (int j = 1; j <= N; ++j) {
    for (int k = N; k >= j; --k) b[k] += b[k - 1];
  }
  b[N] = at_one;
}

// Zeros do not count.
template <int N>
inline int SignVariations(const double* b) {
  int variations = 0;
  double last = b[0];
  for (int k = 1; k <= N; ++k) {
    if (b[k] == 0.0) continue;
    variations += last != 0.0 && (b[k] < 0) != (last < 0) ? 1 : 0;
    last = b[k];
  }
  return variations;
}

// True if p(x) is zero but for rounding: between two roots that rounding may have made complex.
template <int N>
inline bool IsRounding(const double* c, double x) {
  return std::abs(EvaluatePolynomial<N>(c, x)) <= 4e-15 * PolynomialMagnitude<N>(c, x);
}

// Roots in (0, 1) of p, p(0) != 0, and 1 if `with_one` and p(1) is zero exactly.
template <int N>
int RootsInUnitInterval(const double* c, double at_one, bool with_one, double* roots) {
  struct Piece {
    double low, width;
    double b[N + 1];
  };
  // Each halving puts back at most two pieces of one more level.
  constexpr int kMaxLevel = 30;
  Piece stack[kMaxLevel + 2];
  int count = 0;
  int top = 0;
  stack[0].low = 0.0;
  stack[0].width = 1.0;
  BernsteinOnUnitInterval<N>(c, at_one, stack[0].b);
  if (at_one == 0.0 && with_one) roots[count++] = 1.0;
  while (top >= 0 && count < N) {
    Piece& piece = stack[top];
    double* b = piece.b;
    const int variations = SignVariations<N>(b);
    if (variations == 0) {
      --top;
    } else if (variations == 1) {
      // The sign just inside the lower end: a zero at the end itself is a root already counted.
      int first = 0;
      while (b[first] == 0.0) ++first;
      // Start at the zero of the chord, but not at an end: another root there would catch it.
      const double chord = b[0] / (b[0] - b[N]);
      const double fraction = chord > 0.0625 && chord < 0.9375 ? chord
                              : chord <= 0.0625                ? 0.0625
                                                               : 0.9375;
      const double guess = piece.low + piece.width * fraction;
      roots[count++] =
          BracketedNewton<N>(c, piece.low, piece.low + piece.width, b[first] < 0, guess);
      --top;
    } else if (piece.width < 1e-9 || top > kMaxLevel ||
               (piece.width < 1e-7 && IsRounding<N>(c, piece.low + 0.5 * piece.width))) {
      roots[count++] = piece.low + 0.5 * piece.width;
      --top;
    } else {
      // De Casteljau at the middle: the left half replaces the piece, the right half is pushed.
      Piece& right = stack[top + 1];
      for (int k = 0; k <= N; ++k) right.b[k] = b[k];
      for (int k = 1; k <= N; ++k) {
        b[k - 1] = right.b[0];
        for (int i = 0; i <= N - k; ++i) right.b[i] = 0.5 * (right.b[i] + right.b[i + 1]);
      }
      b[N] = right.b[0];
      piece.width *= 0.5;
      right.low = piece.low + piece.width;
      right.width = piece.width;
      if (right.b[0] == 0.0) roots[count++] = right.low;
      ++top;
    }
  }
  return count;
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
  if (!(discriminant >= -1e-15 * half_b * half_b)) return 0;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  const double s = half_b >= 0 ? -half_b - root : -half_b + root;
  roots[0] = s / c[2];
  if (s == 0.0) return 1;  // a double root at zero
  roots[1] = c[0] / s;
  return 2;
}

template <>
inline int RealRoots<3>(const double* c, double* roots) {
  if (!polynomial_internal::AllFinite<3>(c)) return 0;
  if (polynomial_internal::LeadingIsZero<3>(c)) return RealRoots<2>(c, roots);
  // Depressed form (Press et al., Numerical Recipes, section 5.6), then Newton on the original.
  const double inv = 1.0 / c[3];
  const double a = c[2] * inv;
  const double b = c[1] * inv;
  const double d = c[0] * inv;
  const double third_a = a / 3.0;
  const double Q = third_a * third_a - b / 3.0;
  const double R = third_a * (third_a * third_a - 0.5 * b) + 0.5 * d;
  const double Q3 = Q * Q * Q;
  int count = 0;
  if (R * R < Q3) {
    const double root_Q = std::sqrt(Q);
    const double theta = std::acos(std::clamp(R / (Q * root_Q), -1.0, 1.0)) / 3.0;
    const double cos_theta = std::cos(theta);
    const double sin_theta = std::sin(theta);
    constexpr double kHalfSqrt3 = 0.86602540378443864676;
    roots[0] = -2.0 * root_Q * cos_theta - third_a;
    roots[1] = root_Q * (cos_theta + 2.0 * kHalfSqrt3 * sin_theta) - third_a;
    roots[2] = root_Q * (cos_theta - 2.0 * kHalfSqrt3 * sin_theta) - third_a;
    count = 3;
  } else {
    const double magnitude = std::cbrt(std::abs(R) + std::sqrt(R * R - Q3));
    const double A = R > 0 ? -magnitude : magnitude;
    const double B = A != 0.0 ? Q / A : 0.0;
    roots[0] = A + B - third_a;
    count = 1;
    // On the border the other two coincide.
    if (std::abs(A - B) <= 1e-7 * (std::abs(A) + std::abs(third_a))) {
      const double twice = -0.5 * (A + B) - third_a;
      if (std::abs(EvaluatePolynomial<3>(c, twice)) <= 1e-13 * PolynomialMagnitude<3>(c, twice)) {
        roots[count++] = twice;
      }
    }
  }
  for (int k = 0; k < count; ++k) roots[k] = polynomial_internal::Polish<3>(c, roots[k], 2);
  return count;
}

// Degree 4 and above. The real line is cut into (0, 1), (-1, 0) and, through the reversed
// polynomial, what lies beyond 1 and -1. On each piece the sign variations of the Bernstein
// coefficients bound the number of roots (Descartes): 0 variations, no root; 1, exactly one; more,
// the piece is halved (Collins and Akritas 1976; Lane and Riesenfeld 1981). So no real root is
// lost but for two that are closer than 1e-9 of their piece, which are returned once.
//
// Ferrari's closed form for degree 4 loses one small root in ten beside large ones (measured on
// the planar solver at 1 degree) and is not faster.
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
  if (std::abs(c[0]) <= 4e-15 * largest && std::abs(c[2]) >= 1e-6 * largest &&
      c[1] * c[1] < 4.0 * c[0] * c[2]) {
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

  // Both pieces that meet at 1 (or -1) must see the same sign there.
  double at_one = 0.0;
  double at_minus_one = 0.0;
  for (int k = 0; k <= N; ++k) {
    at_one += c[k];
    at_minus_one += k % 2 == 0 ? c[k] : -c[k];
  }
  double piece[N + 1];
  for (int side = 0; side < 4; ++side) {
    const bool reversed = side % 2 == 1;
    const bool mirrored = side >= 2;
    for (int k = 0; k <= N; ++k) {
      const double value = reversed ? c[N - k] : c[k];
      piece[k] = mirrored && (reversed ? N - k : k) % 2 == 1 ? -value : value;
    }
    // Descartes on the whole half line: no sign variation, no root on either piece.
    if (!reversed && polynomial_internal::SignVariations<N>(piece) == 0) {
      ++side;
      continue;
    }
    const double end = mirrored ? at_minus_one : at_one;
    double found[N + 1];
    const int num_found = polynomial_internal::RootsInUnitInterval<N>(piece, end, !reversed, found);
    for (int k = 0; k < num_found && count < N; ++k) {
      const double x = mirrored ? -found[k] : found[k];
      roots[count++] = scale * (reversed ? 1.0 / x : x);
    }
  }
  return count;
}

}  // namespace rigel

#endif  // RIGEL_MINIMAL_POLYNOMIAL_H_
