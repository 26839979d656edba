// Values of polynomials. Coefficients ascend: p(x) = c[0] + c[1] x + ... + c[N] x^N.
#ifndef RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_VALUES_H_
#define RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_VALUES_H_

#include <cmath>

namespace rigel {

namespace polynomial_internal {

// Relative to PolynomialMagnitude(): a value below this is what rounding leaves of a zero.
inline constexpr double kValueRounding = 4e-15;

}  // namespace polynomial_internal

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

}  // namespace rigel

#endif  // RIGEL_MINIMAL_NUMERICS_POLYNOMIAL_VALUES_H_
