// Newton's method in brackets of one root each, safeguarded by halving.
//
// Several brackets at once: a step of one root depends on its last step, and the processor works on
// the others meanwhile. Coefficients ascend, as in polynomial.h. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_BRACKETED_NEWTON_H_
#define RIGEL_MINIMAL_NUMERICS_BRACKETED_NEWTON_H_

#include <cmath>

namespace rigel::polynomial_internal {

// An interval with one root of the polynomial p of a piece of the real line, and a first guess. If
// x is the root of p, that of the original polynomial c is x, 1 / x if `reversed`, and -x or -1 / x
// if `mirrored`.
struct Bracket {
  double low, high, guess;
  bool low_negative;  // the sign of p just above `low`
  bool reversed, mirrored;
};

// Coefficient k of the polynomial of a piece of the real line: of c[0..n], or of what c is for 1 /
// x, -x or -1 / x.
inline double PieceCoefficient(const double* c, int n, bool reversed, bool mirrored, int k) {
  const int from = reversed ? n - k : k;
  return mirrored && from % 2 == 1 ? -c[from] : c[from];
}

// When a root is found.
struct NewtonLimits {
  int max_steps;
  // Relative to the root. Convergence is quadratic: the error left is of the order of the square.
  double newton_step;
  // The same of a step that halves the bracket; 0: until its ends are neighbouring numbers.
  double halving_step;
};

// For polynomials of degree N or less, and at most kLanes brackets.
template <int N, int kLanes>
class BracketedNewton {
 public:
  // The brackets are pieces of the polynomial c[0..n], n <= N; `count` is at least 1.
  template <class Degree>
  BracketedNewton(const double* c, Degree n, const Bracket* brackets, int count)
      : brackets_(brackets), count_(count) {
    for (int l = 0; l < kLanes; ++l) {
      // Lanes that are not used repeat the first.
      const Bracket& bracket = brackets[l < count ? l : 0];
      // All of them before they go to their lane, which is faster than one by one.
      double piece[N + 1];
      for (int k = 0; k <= n; ++k) {
        piece[k] = PieceCoefficient(c, n, bracket.reversed, bracket.mirrored, k);
      }
      for (int k = 0; k <= n; ++k) p_[k][l] = piece[k];
      for (int k = n + 1; k <= N; ++k) p_[k][l] = 0.0;
      x_[l] = bracket.guess;
      low_[l] = bracket.low;
      high_[l] = bracket.high;
      low_negative_[l] = bracket.low_negative;
      done_[l] = l >= count;
    }
  }

  // Writes the root in each bracket.
  void Find(const NewtonLimits& limits, double* roots) {
    int left = count_;
    for (int n = 0; n < limits.max_steps && left > 0; ++n) {
      double value[kLanes], next[kLanes];
      NewtonSteps(value, next);
      for (int l = 0; l < kLanes; ++l) {
        if (done_[l]) continue;
        Advance(limits, l, value[l], next[l]);
        left -= done_[l] ? 1 : 0;
      }
    }
    for (int l = 0; l < count_; ++l) {
      const double root = brackets_[l].reversed ? 1.0 / x_[l] : x_[l];
      roots[l] = brackets_[l].mirrored ? -root : root;
    }
  }

 private:
  // p(x) and x - p(x) / p'(x) in all lanes.
  void NewtonSteps(double* value, double* next) const {
    double slope[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      value[l] = p_[N][l];
      slope[l] = 0.0;
    }
    for (int k = N - 1; k >= 0; --k) {
      for (int l = 0; l < kLanes; ++l) {
        slope[l] = slope[l] * x_[l] + value[l];
        value[l] = value[l] * x_[l] + p_[k][l];
      }
    }
    for (int l = 0; l < kLanes; ++l) next[l] = x_[l] - value[l] / slope[l];
  }

  // Narrows the bracket of lane l by the sign of p(x) = `value`, then goes to `next` if that lies
  // inside, else to the middle.
  void Advance(const NewtonLimits& limits, int l, double value, double next) {
    const bool below = (value < 0) == low_negative_[l];
    low_[l] = below ? x_[l] : low_[l];
    high_[l] = below ? high_[l] : x_[l];
    if (value == 0.0) {
      done_[l] = true;
      return;
    }
    if (next > low_[l] && next < high_[l]) {
      done_[l] = std::abs(next - x_[l]) <= limits.newton_step * std::abs(next);
    } else {
      next = 0.5 * (low_[l] + high_[l]);
      done_[l] = next == low_[l] || next == high_[l] ||
                 !(std::abs(next - x_[l]) > limits.halving_step * std::abs(next));
    }
    x_[l] = next;
  }

  const Bracket* brackets_;
  int count_;
  double p_[N + 1][kLanes];
  double x_[kLanes], low_[kLanes], high_[kLanes];
  bool low_negative_[kLanes], done_[kLanes];
};

}  // namespace rigel::polynomial_internal

#endif  // RIGEL_MINIMAL_NUMERICS_BRACKETED_NEWTON_H_
