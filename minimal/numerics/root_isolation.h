// Isolation of the real roots of a polynomial: where the closed forms are not certain of their
// number (closed_form_roots.h), and for degrees above five.
//
// Coefficients ascend, as in polynomial.h. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_ROOT_ISOLATION_H_
#define RIGEL_MINIMAL_NUMERICS_ROOT_ISOLATION_H_

#include <algorithm>
#include <cmath>

#include "rigel/minimal/numerics/polynomial_values.h"

namespace rigel::polynomial_internal {

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
  // Shares of the interval, both of them: what is nearer to an end than kTooNear starts at kNear
  // from it instead. Any place well inside will do, as the steps are safeguarded.
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

}  // namespace rigel::polynomial_internal

#endif  // RIGEL_MINIMAL_NUMERICS_ROOT_ISOLATION_H_
