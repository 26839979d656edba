// A polynomial at several points at once, and Newton's method on several roots at once. The steps
// of one root depend on one another; the processor works on the others meanwhile.
//
// Coefficients ascend, as in polynomial.h. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_NEWTON_LANES_H_
#define RIGEL_MINIMAL_NUMERICS_NEWTON_LANES_H_

#include <Eigen/Core>

namespace rigel::polynomial_internal {

// Points in the lanes of vector registers: of `count` up to N, rounded up to pairs.
template <int N>
using Lanes = Eigen::Array<double, (N + 1) / 2 * 2, 1>;

// Lanes that are not used repeat the first.
template <int N>
inline Lanes<N> LanesOf(const double* x, int count) {
  Lanes<N> lanes;
  for (int l = 0; l < lanes.size(); ++l) lanes[l] = x[l < count ? l : 0];
  return lanes;
}

// c[K] + c[K+1] x + ... + c[N] x^(N-K), with x2 = x^2: pairs of terms, then Horner's rule in x2, as
// a chain of N dependent products and sums would be twice as long (Estrin 1960).
template <int K, int N, class Vector>
inline Vector SumInLanes(const double* c, const Vector& x, const Vector& x2) {
  if constexpr (K == N) {
    return Vector::Constant(c[N]);
  } else if constexpr (K + 1 == N) {
    return c[K] + c[N] * x;
  } else {
    return (c[K] + c[K + 1] * x) + x2 * SumInLanes<K + 2, N, Vector>(c, x, x2);
  }
}

// A polynomial and its derivative.
template <int N>
class PolynomialInLanes {
 public:
  explicit PolynomialInLanes(const double* c) : c_(c) {
    for (int k = 0; k < N; ++k) derivative_[k] = (k + 1) * c[k + 1];
  }

  // p(x) / p'(x).
  template <class Vector>
  Vector NewtonStep(const Vector& x) const {
    const Vector x2 = x * x;
    return SumInLanes<0, N, Vector>(c_, x, x2) / SumInLanes<0, N - 1, Vector>(derivative_, x, x2);
  }

 private:
  const double* c_;
  double derivative_[N];
};

}  // namespace rigel::polynomial_internal

#endif  // RIGEL_MINIMAL_NUMERICS_NEWTON_LANES_H_
