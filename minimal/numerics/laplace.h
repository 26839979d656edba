// Laplace expansion of 4x4 determinants by pairs of columns, two terms at once in the lanes of a
// vector register.
//
// The determinant of the columns (a, b, c, d) is a sum over the six choices of two rows i and j. A
// summand is the minor of (a, b) in the rows i, j times the minor of (c, d) in the other two rows
// p, q, where (i, j, p, q) is an even permutation. The lanes of a term hold one choice and its
// complement.
#ifndef RIGEL_MINIMAL_NUMERICS_LAPLACE_H_
#define RIGEL_MINIMAL_NUMERICS_LAPLACE_H_

#include <array>

#include <Eigen/Core>

namespace rigel::laplace {

using Column = Eigen::Array4d;
using Pair = Eigen::Array2d;

// The entries of a column in the rows i, j, p and q of two terms.
template <int kTerm>
struct Rows {
  static Pair I(const Column& c) { return kTerm == 1 ? Pair(c[0], c[2]) : Pair(c[0], c[1]); }
  static Pair J(const Column& c) {
    return kTerm == 0 ? Pair(c[2], c[3]) : kTerm == 1 ? Pair(c[1], c[3]) : Pair(c[3], c[2]);
  }
  static Pair P(const Column& c) {
    return kTerm == 0 ? Pair(c[3], c[2]) : kTerm == 1 ? Pair(c[2], c[0]) : Pair(c[1], c[0]);
  }
  static Pair Q(const Column& c) {
    return kTerm == 0 ? Pair(c[1], c[0]) : kTerm == 1 ? Pair(c[3], c[1]) : Pair(c[2], c[3]);
  }

  // Minors of (a, b) in rows i, j and of (c, d) in rows p, q.
  static Pair MinorIJ(const Column& a, const Column& b) { return I(a) * J(b) - I(b) * J(a); }
  // Coefficients of 1, z and z^2 of the minors in rows i, j of (a0 + z a1, b0 + z b1).
  static std::array<Pair, 3> MinorsIJ(const Column& a0, const Column& a1, const Column& b0,
                                      const Column& b1) {
    return {MinorIJ(a0, b0), MinorIJ(a0, b1) + MinorIJ(a1, b0), MinorIJ(a1, b1)};
  }
  static Pair MinorPQ(const Column& c, const Column& d) { return P(c) * Q(d) - P(d) * Q(c); }
};

// Calls term(Rows<0>()), term(Rows<1>()) and term(Rows<2>()).
template <class Term>
inline void ForEachTerm(const Term& term) {
  term(Rows<0>());
  term(Rows<1>());
  term(Rows<2>());
}

}  // namespace rigel::laplace

#endif  // RIGEL_MINIMAL_NUMERICS_LAPLACE_H_
