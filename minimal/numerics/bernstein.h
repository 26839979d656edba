// Polynomials in the Bernstein basis on an interval, for the isolation of roots. The number of sign
// changes of the coefficients bounds the number of roots inside (Descartes' rule; Lane and
// Riesenfeld 1981).
//
// Coefficients of the power basis ascend, as in polynomial.h. A degree is an int, or Known<N> if
// the compiler is to know it. No heap.
#ifndef RIGEL_MINIMAL_NUMERICS_BERNSTEIN_H_
#define RIGEL_MINIMAL_NUMERICS_BERNSTEIN_H_

#include <type_traits>

namespace rigel::polynomial_internal {

template <int N>
using Known = std::integral_constant<int, N>;

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

// Bernstein coefficients b[0..n] on (0, 1) of the polynomial c[0..n]; `inverse` are the
// InverseBinomials of n.
template <class Degree>
inline void BernsteinOnUnitInterval(Degree n, const double* c, const double* inverse, double* b) {
  // b_k = sum_j C(k, j) / C(n, j) c_j, by running sums.
  for (int j = 0; j <= n; ++j) b[j] = c[j] * inverse[j];
  for (int j = 1; j <= n; ++j) {
    for (int k = n; k >= j; --k) b[k] += b[k - 1];
  }
}

// De Casteljau's algorithm at the middle: the coefficients of the left half replace b[0..n], those
// of the right half are written to `right`.
template <class Degree>
inline void HalveBernstein(Degree n, double* b, double* right) {
  for (int k = 0; k <= n; ++k) right[k] = b[k];
  for (int k = 1; k <= n; ++k) {
    b[k - 1] = right[0];
    for (int i = 0; i <= n - k; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
  }
  b[n] = right[0];
}

// Where the polygon of the coefficients crosses zero between b[k] and b[k + 1], as a share of the
// interval.
inline double PolygonCrossing(int n, const double* b, int k) {
  const double share = b[k] / (b[k] - b[k + 1]);
  return (k + share) / n;
}

}  // namespace rigel::polynomial_internal

#endif  // RIGEL_MINIMAL_NUMERICS_BERNSTEIN_H_
