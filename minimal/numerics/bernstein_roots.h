// Real roots of a polynomial of a degree known at run time, in floating point: roots for an
// iteration on the original equations to start from (polynomial.h finds them to the last digits).
#ifndef RIGEL_MINIMAL_NUMERICS_BERNSTEIN_ROOTS_H_
#define RIGEL_MINIMAL_NUMERICS_BERNSTEIN_ROOTS_H_

#include <algorithm>
#include <cmath>

#include "rigel/minimal/numerics/root_isolation.h"

namespace rigel::polynomial_system {

// c[0..n] ascend, kMax - 2 <= n <= kMax. By Descartes' rule in the Bernstein basis, as in
// root_isolation.h.
template <int kMax>
class RootFinder {
 public:
  RootFinder(const double* c, int n) : n_(n) { std::copy(c, c + n + 1, c_); }

  int Find(bool near_only, double* roots) {
    for (int side = 0; side < (near_only ? 2 : 4); ++side) {
      Bracket kind;
      kind.reversed = side >= 2;
      kind.mirrored = side % 2 == 1;
      double piece[kMax + 1];
      for (int k = 0; k <= n_; ++k) piece[k] = Coefficient(kind, k);
      UnitInterval(piece, kind);
    }
    for (int first = 0; first < count_; first += kLanes) {
      Newton(brackets_ + first, std::min(kLanes, count_ - first), roots + first);
    }
    return count_;
  }

 private:
  // Roots at once in Newton(): the steps of each fill the time of the others.
  static constexpr int kLanes = 4;

  using Bracket = polynomial_internal::Bracket;

  double Coefficient(const Bracket& kind, int k) const {
    const double value = kind.reversed ? c_[n_ - k] : c_[k];
    return kind.mirrored && k % 2 == 1 ? -value : value;
  }

  void UnitInterval(const double* c, Bracket bracket) {
    struct Piece {
      double low, width;
      double b[kMax + 1];
    };
    // Pieces on the stack. It bounds the memory, and is reached only where roots, real or
    // complex, are closer than 2^-24 of the interval: they count as one.
    constexpr int kMaxLevel = 24;
    Piece stack[kMaxLevel + 2];
    using polynomial_internal::InverseBinomials;
    static constexpr InverseBinomials<kMax> kInverse;
    static constexpr InverseBinomials<kMax - 1> kInverse1;
    static constexpr InverseBinomials<kMax - 2> kInverse2;
    const double* inverse = n_ == kMax       ? kInverse.value
                            : n_ == kMax - 1 ? kInverse1.value
                                             : kInverse2.value;
    for (int j = 0; j <= n_; ++j) stack[0].b[j] = c[j] * inverse[j];
    for (int j = 1; j <= n_; ++j) {
      double* b = stack[0].b;
      for (int k = n_; k >= j; --k) b[k] += b[k - 1];
    }
    stack[0].low = 0.0;
    stack[0].width = 1.0;
    int top = 0;
    while (top >= 0 && count_ < kMax) {
      Piece& piece = stack[top];
      int variations = 0;
      int change = 0;  // the last one
      for (int k = 0; k < n_; ++k) {
        const bool here = (piece.b[k] < 0) != (piece.b[k + 1] < 0);
        variations += here ? 1 : 0;
        change = here ? k : change;
      }
      if (variations == 0) {
        --top;
      } else if (variations == 1 || top > kMaxLevel) {
        // Where the polygon of the coefficients crosses zero.
        const double share = piece.b[change] / (piece.b[change] - piece.b[change + 1]);
        bracket.low = piece.low;
        bracket.high = piece.low + piece.width;
        bracket.guess = piece.low + piece.width * (variations == 1 ? (change + share) / n_ : 0.5);
        bracket.low_negative = piece.b[0] < 0;
        brackets_[count_++] = bracket;
        --top;
      } else {
        Piece& right = stack[top + 1];
        std::copy(piece.b, piece.b + n_ + 1, right.b);
        for (int k = 0; k < n_; ++k) {
          piece.b[k] = right.b[0];
          for (int i = 0; i < n_ - k; ++i) right.b[i] = 0.5 * (right.b[i] + right.b[i + 1]);
        }
        piece.b[n_] = right.b[0];
        piece.width *= 0.5;
        right.low = piece.low + piece.width;
        right.width = piece.width;
        ++top;
      }
    }
  }

  // The roots in `count` <= kLanes brackets by Newton's method, safeguarded by halving. All at
  // once: a step of one depends on its last one, and the steps of the others fill the time.
  void Newton(const Bracket* brackets, int count, double* roots) const {
    constexpr double kConverged = 1e-6;  // what is left is of the order of the step squared
    double p[kMax + 1][kLanes] = {};
    double x[kLanes], low[kLanes], high[kLanes];
    bool low_negative[kLanes], done[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const Bracket& bracket = brackets[l < count ? l : 0];
      for (int k = 0; k <= n_; ++k) p[k][l] = Coefficient(bracket, k);
      x[l] = bracket.guess;
      low[l] = bracket.low;
      high[l] = bracket.high;
      low_negative[l] = bracket.low_negative;
      done[l] = l >= count;
    }
    for (int n = 0; n < 60; ++n) {
      double value[kLanes], slope[kLanes], step[kLanes];
      for (int l = 0; l < kLanes; ++l) {
        value[l] = p[kMax][l];
        slope[l] = 0.0;
      }
      for (int k = kMax - 1; k >= 0; --k) {
        for (int l = 0; l < kLanes; ++l) {
          slope[l] = slope[l] * x[l] + value[l];
          value[l] = value[l] * x[l] + p[k][l];
        }
      }
      for (int l = 0; l < kLanes; ++l) step[l] = value[l] / slope[l];
      bool all = true;
      for (int l = 0; l < count; ++l) {
        if (done[l]) continue;
        const bool below = (value[l] < 0) == low_negative[l];
        low[l] = below ? x[l] : low[l];
        high[l] = below ? high[l] : x[l];
        double next = x[l] - step[l];
        if (next > low[l] && next < high[l]) {
          done[l] = std::abs(step[l]) <= kConverged * std::abs(next);
        } else {
          next = value[l] == 0.0 ? x[l] : 0.5 * (low[l] + high[l]);
          done[l] = !(std::abs(next - x[l]) > 1e-10 * std::abs(next));
        }
        x[l] = next;
        all = all && done[l];
      }
      if (all) break;
    }
    for (int l = 0; l < count; ++l) {
      const double root = brackets[l].reversed ? 1.0 / x[l] : x[l];
      roots[l] = brackets[l].mirrored ? -root : root;
    }
  }

  int n_;
  int count_ = 0;
  double c_[kMax + 1];
  Bracket brackets_[kMax];
};

}  // namespace rigel::polynomial_system

#endif  // RIGEL_MINIMAL_NUMERICS_BERNSTEIN_ROOTS_H_
