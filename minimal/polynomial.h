// Real roots of polynomials: closed forms to degree 3 and, where they are certain, to degree 5;
// else isolation by Descartes' rule and safeguarded Newton steps.
//
// Coefficients ascend: p(x) = c[0] + c[1] x + ... + c[N] x^N. Every function returns the number
// of roots that it wrote to `roots` (at most the degree), in no particular order. A leading
// coefficient below 1e-14 of the largest one is taken as zero: its root is beyond 1e14 or so.
// The zero polynomial has no roots. Non-finite coefficients give no roots. No heap.
#ifndef RIGEL_MINIMAL_POLYNOMIAL_H_
#define RIGEL_MINIMAL_POLYNOMIAL_H_

#include <algorithm>
#include <cmath>

#include "rigel/minimal/closed_form_roots.h"

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

// Two Newton steps on each of `count` <= N roots, all at once; steps that do not reduce |p| are not
// taken.
template <int N>
inline void Polish(const double* c, int count, double* roots) {
  constexpr int kLanes = (N + 1) / 2 * 2;
  double x[kLanes], value[kLanes], slope[kLanes];
  for (int l = 0; l < kLanes; ++l) x[l] = roots[l < count ? l : 0];
  const auto evaluate = [&](const double* at, double* p, double* d) {
    for (int l = 0; l < kLanes; ++l) {
      p[l] = c[N] * at[l] + c[N - 1];
      d[l] = c[N];
    }
    for (int k = N - 2; k >= 0; --k) {
      for (int l = 0; l < kLanes; ++l) {
        d[l] = d[l] * at[l] + p[l];
        p[l] = p[l] * at[l] + c[k];
      }
    }
  };
  evaluate(x, value, slope);
  for (int n = 0; n < 2; ++n) {
    double next[kLanes], next_value[kLanes], next_slope[kLanes];
    for (int l = 0; l < kLanes; ++l) next[l] = x[l] - value[l] / slope[l];
    evaluate(next, next_value, next_slope);
    for (int l = 0; l < kLanes; ++l) {
      // Also false for a slope of zero.
      const bool better = std::abs(next_value[l]) < std::abs(value[l]);
      x[l] = better ? next[l] : x[l];
      value[l] = better ? next_value[l] : value[l];
      slope[l] = better ? next_slope[l] : slope[l];
    }
  }
  for (int l = 0; l < count; ++l) roots[l] = x[l];
}

// An interval with one root of p, and a first guess. Of `c` the root is x, of p it is 1 / x if
// `reversed`, and -x or -1 / x if `mirrored`.
struct Bracket {
  double low, high, guess;
  bool low_negative;  // the sign of p just above `low`
  bool reversed, mirrored;
};

// The polynomial of a piece of the real line: c, or what c is for 1 / x, -x or -1 / x.
template <int N>
inline void PieceOf(const double* c, bool reversed, bool mirrored, double* piece) {
  for (int k = 0; k <= N; ++k) {
    const int from = reversed ? N - k : k;
    piece[k] = mirrored && from % 2 == 1 ? -c[from] : c[from];
  }
}

// The roots in `count` <= N brackets by Newton's method, safeguarded by halving. All at once: a
// step of one depends on its last one, and the steps of the others fill the time.
template <int N>
inline void BracketedNewton(const double* c, const Bracket* brackets, int count, double* roots) {
  constexpr int kLanes = (N + 1) / 2 * 2;
  if (count == 0) return;  // there is no bracket to fill the lanes with
  double p[N + 1][kLanes], x[kLanes], low[kLanes], high[kLanes];
  bool low_negative[kLanes], done[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const Bracket& bracket = brackets[l < count ? l : 0];
    double piece[N + 1];
    PieceOf<N>(c, bracket.reversed, bracket.mirrored, piece);
    for (int k = 0; k <= N; ++k) p[k][l] = piece[k];
    x[l] = bracket.guess;
    low[l] = bracket.low;
    high[l] = bracket.high;
    low_negative[l] = bracket.low_negative;
    done[l] = l >= count;
  }
  int left = count;
  for (int n = 0; n < 100 && left > 0; ++n) {
    double value[kLanes], slope[kLanes], next[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      value[l] = p[N][l];
      slope[l] = 0.0;
    }
    for (int k = N - 1; k >= 0; --k) {
      for (int l = 0; l < kLanes; ++l) {
        slope[l] = slope[l] * x[l] + value[l];
        value[l] = value[l] * x[l] + p[k][l];
      }
    }
    for (int l = 0; l < kLanes; ++l) next[l] = x[l] - value[l] / slope[l];
    for (int l = 0; l < count; ++l) {
      if (done[l]) continue;
      const bool below = (value[l] < 0) == low_negative[l];
      low[l] = below ? x[l] : low[l];
      high[l] = below ? high[l] : x[l];
      if (value[l] == 0.0) {
        next[l] = x[l];
        done[l] = true;
      } else if (!(next[l] > low[l] && next[l] < high[l])) {
        next[l] = 0.5 * (low[l] + high[l]);
        done[l] = next[l] == low[l] || next[l] == high[l];
      } else {
        // Quadratic convergence: what is left is of the order of the step squared.
        done[l] = std::abs(next[l] - x[l]) <= 1e-9 * std::abs(next[l]);
      }
      x[l] = next[l];
      left -= done[l] ? 1 : 0;
    }
  }
  for (int l = 0; l < count; ++l) {
    const double root = brackets[l].reversed ? 1.0 / x[l] : x[l];
    roots[l] = brackets[l].mirrored ? -root : root;
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
  bool has_zero = b[0] == 0.0;
  for (int k = 1; k <= N; ++k) {
    variations += (b[k] < 0) != (b[k - 1] < 0) ? 1 : 0;
    has_zero |= b[k] == 0.0;
  }
  if (!has_zero) return variations;
  variations = 0;
  double last = 0.0;
  for (int k = 0; k <= N; ++k) {
    if (b[k] == 0.0) continue;
    variations += last != 0.0 && (b[k] < 0) != (last < 0) ? 1 : 0;
    last = b[k];
  }
  return variations;
}

// Where in (0, 1) to look first for a root, `x` being where some approximation of p has it: away
// from the ends, where another root may catch the iteration.
inline double AwayFromEnds(double x) {
  constexpr double kNear = 0.0625;
  constexpr double kTooNear = 1e-7;
  if (!(x > kTooNear)) return kNear;
  return x < 1.0 - kTooNear ? x : 1.0 - kNear;
}

// The same from the values p0 and p1 at the ends and the slope d0 at 0: where the chord is zero,
// or, near 0, the tangent, since roots differ by orders of magnitude.
inline double FirstGuess(double p0, double d0, double p1) {
  const double chord = p0 / (p0 - p1);
  return AwayFromEnds(chord < 0.0625 ? std::min(-p0 / d0, 0.0625) : chord);
}

// True if p(x) is zero but for rounding: between two roots that rounding may have made complex.
template <int N>
inline bool IsRounding(const double* c, double x) {
  return std::abs(EvaluatePolynomial<N>(c, x)) <= 4e-15 * PolynomialMagnitude<N>(c, x);
}

// Brackets of the roots in (0, 1) of p, p(0) != 0, and 1 if `with_one` and p(1) is zero exactly.
// `bracket` has the piece's kind; at most `capacity` are written. Returns their number. `exact`
// becomes false if some of them may stand for more than one root, or for none.
template <int N>
int BracketsInUnitInterval(const double* c, double at_one, bool with_one, Bracket bracket,
                           int capacity, Bracket* brackets, bool* exact) {
  const auto known = [&](double root) {
    *exact = false;
    bracket.low = bracket.high = bracket.guess = root;
    bracket.low_negative = false;
    return bracket;
  };
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
  if (at_one == 0.0 && with_one && capacity > 0) brackets[count++] = known(1.0);
  while (top >= 0 && count < capacity) {
    Piece& piece = stack[top];
    double* b = piece.b;
    const int variations = SignVariations<N>(b);
    if (variations == 0) {
      --top;
    } else if (variations == 1) {
      // The sign just inside the lower end: a zero at the end itself is a root already counted.
      int first = 0;
      while (b[first] == 0.0) ++first;
      // Where the polygon of the coefficients crosses zero.
      int change = first + 1;
      while ((b[change] < 0) == (b[first] < 0)) ++change;
      const double share = b[change - 1] / (b[change - 1] - b[change]);
      const double fraction = AwayFromEnds((change - 1 + share) / N);
      bracket.low = piece.low;
      bracket.high = piece.low + piece.width;
      bracket.guess = piece.low + piece.width * fraction;
      bracket.low_negative = b[first] < 0;
      brackets[count++] = bracket;
      --top;
    } else if (piece.width < 1e-9 || top > kMaxLevel ||
               (piece.width < 1e-7 && IsRounding<N>(c, piece.low + 0.5 * piece.width))) {
      brackets[count++] = known(piece.low + 0.5 * piece.width);
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
      if (right.b[0] == 0.0) brackets[count++] = known(right.low);
      ++top;
    }
  }
  return count;
}

// The bracket (0, 1) of the only root there, of p with p(1) = `at_one`.
template <int N>
inline Bracket WholePiece(const double* c, double at_one, Bracket bracket) {
  bracket.low = 0.0;
  bracket.high = 1.0;
  bracket.low_negative = c[0] < 0;
  bracket.guess = FirstGuess(c[0], c[1], at_one);
  return bracket;
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

// Roots of a cubic to 1e-6 of the largest, as a rule to 1e-8: starts of an iteration.
inline int CubicStarts(const double* c, double* roots) {
  if (!polynomial_internal::AllFinite<3>(c)) return 0;
  if (polynomial_internal::LeadingIsZero<3>(c)) return RealRoots<2>(c, roots);
  // Depressed form (Press et al., Numerical Recipes, section 5.6).
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
    const double cosine = R / (Q * root_Q);
    double cos_third, sin_third;
    // Where two roots are close the approximation would shift them by too much.
    constexpr double kApart = 1e-4;
    if (std::abs(cosine) < 1.0 - kApart) {
      cos_third = polynomial_internal::CosOfThird(cosine);
      sin_third = std::sqrt((1.0 - cos_third) * (1.0 + cos_third));
    } else {
      const double third = std::acos(std::clamp(cosine, -1.0, 1.0)) / 3.0;
      cos_third = std::cos(third);
      sin_third = std::sin(third);
    }
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
    // On the border the other two coincide.
    if (std::abs(A - B) <= 1e-7 * (std::abs(A) + std::abs(third_a))) {
      const double twice = -0.5 * (A + B) - third_a;
      if (std::abs(EvaluatePolynomial<3>(c, twice)) <= 1e-13 * PolynomialMagnitude<3>(c, twice)) {
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

namespace polynomial_internal {

// Isolation, and Newton on all roots at once. The real line is cut into (0, 1), (-1, 0) and,
// through the reversed polynomial, what lies beyond 1 and -1. On each piece the sign variations of
// the Bernstein coefficients bound the number of roots (Descartes): 0 variations, no root; 1,
// exactly one; more, the piece is halved (Collins and Akritas 1976; Lane and Riesenfeld 1981). So
// no real root is lost but for two that are closer than 1e-9 of their piece, which are returned
// once. c[0] and c[N] must not be zero. Writes at most `capacity` roots; returns their number.
template <int N>
int IsolatedRoots(const double* c, int capacity, double* roots) {
  // Both pieces that meet at 1 (or -1) must see the same sign there.
  double at_one = 0.0;
  double at_minus_one = 0.0;
  for (int k = 0; k <= N; ++k) {
    at_one += c[k];
    at_minus_one += k % 2 == 0 ? c[k] : -c[k];
  }
  Bracket brackets[N];
  int num_brackets = 0;
  for (const bool mirrored : {false, true}) {
    double near[N + 1], far[N + 1];
    PieceOf<N>(c, false, mirrored, near);
    // Descartes on the whole half line: at most so many roots, and an even number less.
    const int variations = SignVariations<N>(near);
    if (variations == 0) continue;
    const double end = mirrored ? at_minus_one : at_one;
    Bracket bracket;
    bracket.mirrored = mirrored;
    bracket.reversed = false;
    int found = 0;
    bool exact = end != 0.0 && c[N] != 0.0;
    const bool only_near = variations == 1 && exact && (end < 0) != (near[0] < 0);
    if (only_near && num_brackets < capacity) {
      brackets[num_brackets++] = WholePiece<N>(near, end, bracket);
      continue;
    }
    if (variations > 1 || !exact) {
      found = BracketsInUnitInterval<N>(near, end, true, bracket, capacity - num_brackets,
                                        brackets + num_brackets, &exact);
      num_brackets += found;
    }
    if (exact && found == variations) continue;
    bracket.reversed = true;
    PieceOf<N>(c, true, mirrored, far);
    if (exact && found + 1 == variations) {
      if (num_brackets < capacity) {
        brackets[num_brackets++] = WholePiece<N>(far, end, bracket);
      }
      continue;
    }
    num_brackets += BracketsInUnitInterval<N>(far, end, false, bracket, capacity - num_brackets,
                                              brackets + num_brackets, &exact);
  }
  BracketedNewton<N>(c, brackets, num_brackets, roots);
  return num_brackets;
}

}  // namespace polynomial_internal

// Degree 4 and above: degrees 4 and 5 in closed form where that is certain of the number of roots,
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

  if constexpr (N <= 5) {
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

#endif  // RIGEL_MINIMAL_POLYNOMIAL_H_
