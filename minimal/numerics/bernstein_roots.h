// Real roots of a polynomial whose degree is known at run time, in floating point. They are starts
// of an iteration on the original equations; polynomial.h finds roots to the last digits.
#ifndef RIGEL_MINIMAL_NUMERICS_BERNSTEIN_ROOTS_H_
#define RIGEL_MINIMAL_NUMERICS_BERNSTEIN_ROOTS_H_

#include <algorithm>

#include "rigel/minimal/numerics/bernstein.h"
#include "rigel/minimal/numerics/bracketed_newton.h"

namespace rigel::polynomial_system {

// c[0..n] ascend, kMax - 2 <= n <= kMax. By Descartes' rule in the Bernstein basis, as in
// root_isolation.h.
template <int kMax>
class RootFinder {
 public:
  RootFinder(const double* c, int n) : n_(n) { std::copy(c, c + n + 1, c_); }

  // Writes at most kMax roots and returns their number; only those between -1 and 1 if `near_only`.
  int Find(bool near_only, double* roots) {
    for (int side = 0; side < (near_only ? 2 : 4); ++side) {
      Bracket kind;
      kind.reversed = side >= 2;
      kind.mirrored = side % 2 == 1;
      AddBracketsOfPiece(kind);
    }
    // Starts: what is left is of the order of the step squared.
    constexpr polynomial_internal::NewtonLimits kLimits = {60, 1e-6, 1e-10};
    for (int first = 0; first < count_; first += kLanes) {
      const int count = std::min(kLanes, count_ - first);
      polynomial_internal::BracketedNewton<kMax, kLanes>(c_, n_, brackets_ + first, count)
          .Find(kLimits, roots + first);
    }
    return count_;
  }

 private:
  // Roots at once in Newton's method: the steps of each fill the time of the others.
  static constexpr int kLanes = 4;

  // Halvings of (0, 1). They bound the memory, and are reached only where roots, real or complex,
  // are closer than 2^-24 of the interval: these count as one root.
  static constexpr int kMaxLevel = 24;

  using Bracket = polynomial_internal::Bracket;

  // The polynomial in the Bernstein basis on (low, low + width).
  struct Piece {
    double low, width;
    double b[kMax + 1];
  };

  const double* InverseBinomialsOfDegree() const {
    using polynomial_internal::InverseBinomials;
    static constexpr InverseBinomials<kMax> kInverse;
    static constexpr InverseBinomials<kMax - 1> kInverse1;
    static constexpr InverseBinomials<kMax - 2> kInverse2;
    return n_ == kMax ? kInverse.value : n_ == kMax - 1 ? kInverse1.value : kInverse2.value;
  }

  // The brackets of the roots in (0, 1) of the polynomial of a piece of the real line.
  void AddBracketsOfPiece(const Bracket& kind) {
    double c[kMax + 1];
    for (int k = 0; k <= n_; ++k) {
      c[k] = polynomial_internal::PieceCoefficient(c_, n_, kind.reversed, kind.mirrored, k);
    }
    Piece stack[kMaxLevel + 2];
    stack[0].low = 0.0;
    stack[0].width = 1.0;
    polynomial_internal::BernsteinOnUnitInterval(n_, c, InverseBinomialsOfDegree(), stack[0].b);
    int top = 0;
    while (top >= 0 && count_ < kMax) {
      int last_change = 0;
      const int variations = SignVariations(stack[top], &last_change);
      if (variations > 1 && top <= kMaxLevel) {
        Halve(&stack[top], &stack[top + 1]);
        ++top;
        continue;
      }
      if (variations > 0) AddBracket(kind, stack[top], variations, last_change);
      --top;
    }
  }

  // `last_change`: the k of the last b[k], b[k + 1] of different signs.
  int SignVariations(const Piece& piece, int* last_change) const {
    int variations = 0;
    for (int k = 0; k < n_; ++k) {
      const bool here = (piece.b[k] < 0) != (piece.b[k + 1] < 0);
      variations += here ? 1 : 0;
      *last_change = here ? k : *last_change;
    }
    return variations;
  }

  // The left half replaces `piece`.
  void Halve(Piece* piece, Piece* right) const {
    polynomial_internal::HalveBernstein(n_, piece->b, right->b);
    piece->width *= 0.5;
    right->low = piece->low + piece->width;
    right->width = piece->width;
  }

  void AddBracket(const Bracket& kind, const Piece& piece, int variations, int last_change) {
    const double guess =
        variations == 1 ? polynomial_internal::PolygonCrossing(n_, piece.b, last_change) : 0.5;
    Bracket& bracket = brackets_[count_++];
    bracket = kind;
    bracket.low = piece.low;
    bracket.high = piece.low + piece.width;
    bracket.guess = piece.low + piece.width * guess;
    bracket.low_negative = piece.b[0] < 0;
  }

  int n_;
  int count_ = 0;
  double c_[kMax + 1];
  Bracket brackets_[kMax];
};

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_NUMERICS_BERNSTEIN_ROOTS_H_
