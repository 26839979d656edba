// Isolation of the real roots of a polynomial: where the closed forms are not certain of their
// number (closed_form_roots.h), and for degrees above five.
//
// Coefficients ascend, as in polynomial.h. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_ROOT_ISOLATION_H_
#define RIGEL_MINIMAL_NUMERICS_ROOT_ISOLATION_H_

#include <algorithm>
#include <cmath>

#include "rigel/minimal/numerics/bernstein.h"
#include "rigel/minimal/numerics/bracketed_newton.h"
#include "rigel/minimal/numerics/polynomial_values.h"

namespace rigel::polynomial_internal {

// The polynomial of a piece of the real line: c, or what c is for 1 / x, -x or -1 / x.
template <int N>
inline void PieceOf(const double* c, bool reversed, bool mirrored, double* piece) {
  for (int k = 0; k <= N; ++k) piece[k] = PieceCoefficient(c, N, reversed, mirrored, k);
}

// A polynomial in the Bernstein basis on (low, low + width).
template <int N>
struct BernsteinPiece {
  double low, width;
  double b[N + 1];

  BernsteinPiece() = default;
  // Of c on (0, 1), where c(1) = `at_one`.
  BernsteinPiece(const double* c, double at_one) : low(0.0), width(1.0) {
    constexpr InverseBinomials<N> kInverse;
    BernsteinOnUnitInterval(Known<N>(), c, kInverse.value, b);
    b[N] = at_one;
  }

  double Middle() const { return low + 0.5 * width; }

  // The left half replaces the piece.
  void Halve(BernsteinPiece* right) {
    HalveBernstein(Known<N>(), b, right->b);
    width *= 0.5;
    right->low = low + width;
    right->width = width;
  }
};

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
  // Share of the interval within which the tangent is the better guess.
  constexpr double kNearZero = 0.0625;
  const double chord = p0 / (p0 - p1);
  return AwayFromEnds(chord < kNearZero ? std::min(-p0 / d0, kNearZero) : chord);
}

// True if p(x) is zero but for rounding: between two roots that rounding may have made complex.
template <int N>
inline bool IsRounding(const double* c, double x) {
  return std::abs(EvaluatePolynomial<N>(c, x)) <= kValueRounding * PolynomialMagnitude<N>(c, x);
}

// Fills `bracket`, which has the piece's kind, for a piece of one sign variation.
template <int N>
inline void BracketOfOneRoot(const BernsteinPiece<N>& piece, Bracket* bracket) {
  const double* b = piece.b;
  // The sign just inside the lower end: a zero at the end itself is a root already counted.
  int first = 0;
  while (b[first] == 0.0) ++first;
  int change = first + 1;
  while ((b[change] < 0) == (b[first] < 0)) ++change;
  const double fraction = AwayFromEnds(PolygonCrossing(N, b, change - 1));
  bracket->low = piece.low;
  bracket->high = piece.low + piece.width;
  bracket->guess = piece.low + piece.width * fraction;
  bracket->low_negative = b[first] < 0;
}

// Fills `bracket`, which has the piece's kind, for a root that is known.
inline void BracketOfKnownRoot(double root, Bracket* bracket) {
  bracket->low = bracket->high = bracket->guess = root;
  bracket->low_negative = false;
}

// True if the roots of a piece of several sign variations count as one.
template <int N>
inline bool IsSmallest(const double* c, const BernsteinPiece<N>& piece) {
  // These are shares of (0, 1). Roots closer than the first are one root. Roots closer than the
  // second are one if rounding may have made them complex.
  constexpr double kOneRoot = 1e-9;
  constexpr double kMaybeComplex = 1e-7;
  return piece.width < kOneRoot ||
         (piece.width < kMaybeComplex && IsRounding<N>(c, piece.Middle()));
}

// Brackets of the roots in (0, 1) of p, p(0) != 0, and 1 if `with_one` and p(1) is zero exactly.
// `bracket` has the piece's kind; at most `capacity` are written. Returns their number. `exact`
// becomes false if some of them may stand for more than one root, or for none.
template <int N>
int BracketsInUnitInterval(const double* c, double at_one, bool with_one, Bracket bracket,
                           int capacity, Bracket* brackets, bool* exact) {
  int count = 0;
  const auto add_known = [&](double root) {
    *exact = false;
    BracketOfKnownRoot(root, &bracket);
    brackets[count++] = bracket;
  };
  // Each halving puts back at most two pieces of one more level.
  constexpr int kMaxLevel = 30;
  BernsteinPiece<N> stack[kMaxLevel + 2];
  stack[0] = BernsteinPiece<N>(c, at_one);
  int top = 0;
  if (at_one == 0.0 && with_one && capacity > 0) add_known(1.0);
  while (top >= 0 && count < capacity) {
    BernsteinPiece<N>& piece = stack[top];
    const int variations = SignVariations<N>(piece.b);
    if (variations == 0) {
      --top;
    } else if (variations == 1) {
      BracketOfOneRoot<N>(piece, &bracket);
      brackets[count++] = bracket;
      --top;
    } else if (top > kMaxLevel || IsSmallest<N>(c, piece)) {
      add_known(piece.Middle());
      --top;
    } else {
      BernsteinPiece<N>& right = stack[++top];
      piece.Halve(&right);
      if (right.b[0] == 0.0) add_known(right.low);
    }
  }
  return count;
}

// The roots of c in `count` <= N brackets, to rounding.
template <int N>
inline void RootsInBrackets(const double* c, const Bracket* brackets, int count, double* roots) {
  constexpr int kLanes = (N + 1) / 2 * 2;             // whole registers of two
  constexpr NewtonLimits kLimits = {100, 1e-9, 0.0};  // the error left is the step squared
  if (count > 0) BracketedNewton<N, kLanes>(c, Known<N>(), brackets, count).Find(kLimits, roots);
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
// through the reversed polynomial, what lies beyond 1 and -1. On each piece the sign changes of the
// Bernstein coefficients bound the number of roots (Descartes). Without a change there is no root,
// with one there is exactly one. With more the piece is halved (Collins and Akritas 1976; Lane and
// Riesenfeld 1981). So
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
  RootsInBrackets<N>(c, brackets, num_brackets, roots);
  return num_brackets;
}

}  // namespace rigel::polynomial_internal

#endif  // RIGEL_MINIMAL_NUMERICS_ROOT_ISOLATION_H_
