#include "rigel/minimal/numerics/polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <unsupported/Eigen/Polynomials>

#include "rigel/core/random.h"
#include "rigel/minimal/numerics/polish.h"

namespace rigel {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kEps = 2.3e-16;

std::vector<long double> TimesLinear(const std::vector<long double>& c, long double root) {
  std::vector<long double> product(c.size() + 1, 0.0L);
  for (size_t k = 0; k < c.size(); ++k) {
    product[k] -= root * c[k];
    product[k + 1] += c[k];
  }
  return product;
}

// Times (x - m e^ia)(x - m e^-ia).
std::vector<long double> TimesPair(const std::vector<long double>& c, long double m, double a) {
  std::vector<long double> product(c.size() + 2, 0.0L);
  for (size_t k = 0; k < c.size(); ++k) {
    product[k] += m * m * c[k];
    product[k + 1] -= 2.0L * m * std::cos(a) * c[k];
    product[k + 2] += c[k];
  }
  return product;
}

std::vector<double> FromRoots(const std::vector<double>& roots) {
  std::vector<long double> c = {1.0L};
  for (const double root : roots) c = TimesLinear(c, root);
  return {c.begin(), c.end()};
}

template <int N>
std::vector<double> Solve(const std::vector<double>& c) {
  EXPECT_EQ(c.size(), N + 1u);
  // One more slot, to see that it is not written.
  std::vector<double> roots(N + 1, 123.0);
  const int count = RealRoots<N>(c.data(), roots.data());
  EXPECT_GE(count, 0);
  EXPECT_LE(count, N);
  EXPECT_EQ(roots[N], 123.0) << "wrote beyond the degree";
  roots.resize(std::max(count, 0));
  return roots;
}

std::vector<double> SolveAny(const std::vector<double>& c) {
  switch (c.size()) {
    case 2:
      return Solve<1>(c);
    case 3:
      return Solve<2>(c);
    case 4:
      return Solve<3>(c);
    case 5:
      return Solve<4>(c);
    case 6:
      return Solve<5>(c);
    case 7:
      return Solve<6>(c);
    case 8:
      return Solve<7>(c);
    case 9:
      return Solve<8>(c);
  }
  ADD_FAILURE() << "degree";
  return {};
}

double Nearest(const std::vector<double>& roots, double x) {
  double best = kInf;
  for (const double root : roots) best = std::min(best, std::abs(root - x));
  return best;
}

double Value(const std::vector<double>& c, double x) {
  double value = 0.0;
  for (size_t k = c.size(); k-- > 0;) value = value * x + c[k];
  return value;
}

double Slope(const std::vector<double>& c, double x) {
  double slope = 0.0;
  for (size_t k = c.size(); k-- > 1;) slope = slope * x + k * c[k];
  return slope;
}

double Magnitude(const std::vector<double>& c, double x) {
  double value = 0.0;
  for (size_t k = c.size(); k-- > 0;) value = value * std::abs(x) + std::abs(c[k]);
  return value;
}

// How far the rounding of the coefficients may move the root x.
double Conditioning(const std::vector<double>& c, double x) {
  return 4.0 * c.size() * kEps * Magnitude(c, x) / std::abs(Slope(c, x)) + 1e-13 * std::abs(x);
}

// Sorted; the real roots are known, the rest are complex pairs.
struct KnownPolynomial {
  std::vector<double> real;
  std::vector<double> c;
};

// Magnitudes of the roots spread evenly in the logarithm over 10^-decades .. 10^decades.
KnownPolynomial MakePolynomial(int degree, double decades, bool pairs, uint64_t seed) {
  Random random = Random::Stream(100 + degree, seed);
  KnownPolynomial p;
  std::vector<long double> c = {1.0L};
  for (int left = degree; left > 0;) {
    const double magnitude = std::pow(10.0, random.Uniform(-decades, decades));
    if (pairs && left >= 2 && random.Uniform() < 0.4) {
      c = TimesPair(c, magnitude, random.Uniform(0.05, 3.09));
      left -= 2;
    } else {
      p.real.push_back(random.Uniform() < 0.5 ? magnitude : -magnitude);
      c = TimesLinear(c, p.real.back());
      left -= 1;
    }
  }
  std::sort(p.real.begin(), p.real.end());
  // An overall factor must not matter.
  const long double factor = std::pow(10.0, random.Uniform(-20.0, 20.0));
  for (const long double coefficient : c) p.c.push_back(coefficient * factor);
  return p;
}

// True if the leading coefficient is one that the header takes as zero, or nearly so.
bool NegligibleLeading(const std::vector<double>& c) {
  double largest = 0.0;
  for (const double coefficient : c) largest = std::max(largest, std::abs(coefficient));
  return std::abs(c.back()) < 1e-13 * largest;
}

// Every root that the coefficients determine is found; every root found is one.
void ExpectKnownRoots(const KnownPolynomial& p, const std::vector<double>& roots, uint64_t seed,
                      int* num_known) {
  for (size_t k = 0; k < p.real.size(); ++k) {
    const double x = p.real[k];
    const double tolerance = Conditioning(p.c, x);
    double gap = kInf;
    if (k > 0) gap = std::min(gap, x - p.real[k - 1]);
    if (k + 1 < p.real.size()) gap = std::min(gap, p.real[k + 1] - x);
    if (tolerance > 0.01 * gap || tolerance > 1e-3 * std::abs(x)) continue;
    ++*num_known;
    EXPECT_LE(Nearest(roots, x), 10.0 * tolerance)
        << "degree " << p.c.size() - 1 << " seed " << seed << " lost " << x;
  }
  for (const double root : roots) {
    EXPECT_LE(std::abs(Value(p.c, root)), 1e-11 * Magnitude(p.c, root))
        << "degree " << p.c.size() - 1 << " seed " << seed << " invented " << root;
  }
}

TEST(Polynomial, EvaluatesValueAndSlope) {
  const std::vector<double> c = {5.0, -3.0, 2.0, 0.5, -1.0};
  for (const double x : {-2.0, 0.0, 0.3, 7.0}) {
    double slope = 0.0;
    EXPECT_NEAR(EvaluatePolynomial<4>(c.data(), x), Value(c, x), 1e-11);
    EXPECT_NEAR(EvaluatePolynomial<4>(c.data(), x, &slope), Value(c, x), 1e-11);
    EXPECT_NEAR(slope, Slope(c, x), 1e-11);
    EXPECT_NEAR(PolynomialMagnitude<4>(c.data(), x), Magnitude(c, x), 1e-11);
  }
}

TEST(Polynomial, FindsKnownRootsOfEveryDegree) {
  for (int degree = 1; degree <= 8; ++degree) {
    for (const bool pairs : {false, true}) {
      for (const double decades : {0.5, 1.0, 2.0}) {
        int num_known = 0;
        for (uint64_t seed = 0; seed < 1500; ++seed) {
          const KnownPolynomial p = MakePolynomial(degree, decades, pairs, seed);
          ExpectKnownRoots(p, SolveAny(p.c), seed, &num_known);
        }
        // The checks above were not all skipped.
        EXPECT_GT(num_known, (pairs ? 400 : 1000) * degree);
      }
    }
  }
}

TEST(Polynomial, FindsTinyRootsBesideHugeOnes) {
  for (int degree = 3; degree <= 8; ++degree) {
    for (const bool pairs : {false, true}) {
      int num_known = 0;
      for (uint64_t seed = 0; seed < 1500; ++seed) {
        const KnownPolynomial p = MakePolynomial(degree, 4.0, pairs, seed);
        if (NegligibleLeading(p.c)) continue;
        ExpectKnownRoots(p, SolveAny(p.c), seed, &num_known);
      }
      EXPECT_GT(num_known, 1000 * (degree / (pairs ? 4 : 2)));
    }
  }
  for (const std::vector<double>& roots : {std::vector<double>{1e-6, 1e6},
                                           {1e-10, -3.0, 1e3},
                                           {-1e-3, 2e-3, 1e4},
                                           {1e-12, 1.0, 2.0},
                                           {1.0, -2.0, 1e8},
                                           {1.0, -2.0, 1e12},
                                           {1.0, 1e6, -3e6},
                                           {1e-9, 2e-3, -1.0, 1e5},
                                           {1e-6, -1e-3, 2.0, 3e3}}) {
    const std::vector<double> found = SolveAny(FromRoots(roots));
    EXPECT_EQ(found.size(), roots.size());
    for (const double x : roots) EXPECT_LT(Nearest(found, x), 1e-10 * std::abs(x)) << x;
  }
}

TEST(Polynomial, AgreesWithTheCompanionMatrixOnRandomCoefficients) {
  for (int degree = 2; degree <= 8; ++degree) {
    int num_roots = 0;
    for (uint64_t seed = 0; seed < 1000; ++seed) {
      Random random = Random::Stream(200 + degree, seed);
      std::vector<double> c(degree + 1);
      for (double& coefficient : c) coefficient = random.Normal();
      if (std::abs(c.back()) < 1e-2) continue;
      const Eigen::VectorXd coefficients = Eigen::Map<Eigen::VectorXd>(c.data(), degree + 1);
      const Eigen::PolynomialSolver<double, Eigen::Dynamic> solver(coefficients);
      const std::vector<double> found = SolveAny(c);
      int num_real = 0;
      bool clear = true;
      for (const std::complex<double>& root : solver.roots()) {
        const double imaginary = std::abs(root.imag());
        // Neither clearly real nor clearly complex: a near-double root.
        if (imaginary > 0.0 && imaginary < 1e-4 * std::abs(root)) clear = false;
        if (imaginary > 0.0) continue;
        ++num_real;
        const double x = root.real();
        EXPECT_LT(Nearest(found, x), 1e-6 * std::abs(x)) << "degree " << degree << " seed " << seed;
      }
      if (clear) {
        EXPECT_EQ(static_cast<int>(found.size()), num_real) << degree << " seed " << seed;
        num_roots += num_real;
      }
    }
    EXPECT_GT(num_roots, 1000);
  }
}

// Roots on a grid of sixteenths: the halving meets them exactly, at its own borders.
TEST(Polynomial, FindsRootsOnTheBordersOfTheHalving) {
  for (const double sign : {1.0, -1.0}) {
    for (const bool reversed : {false, true}) {
      int lost = 0;
      for (int a = 1; a < 14; ++a) {
        for (int b = a + 1; b < 15; ++b) {
          for (int d = b + 1; d < 17; ++d) {
            for (int e = d + 1; e < 20; e += 2) {
              std::vector<double> roots = {a / 16.0, b / 16.0, d / 16.0, e / 16.0};
              for (double& root : roots) root = sign * (reversed ? 1.0 / root : root);
              std::vector<double> c = FromRoots({a / 16.0, b / 16.0, d / 16.0, e / 16.0});
              if (reversed) std::reverse(c.begin(), c.end());
              for (size_t k = 1; k < c.size(); k += 2) c[k] *= sign;
              const std::vector<double> found = Solve<4>(c);
              for (const double x : roots) lost += Nearest(found, x) > 1e-9 * std::abs(x);
            }
          }
        }
      }
      EXPECT_EQ(lost, 0) << "sign " << sign << " reversed " << reversed;
    }
  }
}

TEST(Polynomial, FindsDoubleRoots) {
  // All exact in double precision, so that the roots are double indeed; rounding would make a pair
  // of simple or of complex ones.
  for (const std::vector<double>& roots : {std::vector<double>{3, 3},
                                           {-0.5, -0.5, 2},
                                           {1, 1, 1},
                                           {0.5, 0.5, 2, 3},
                                           {-2, -2, 1, 5},
                                           {0.25, 0.25, 0.75, -3, 2},
                                           {-2, -2, 3, 5, 0.5, 7}}) {
    const std::vector<double> found = SolveAny(FromRoots(roots));
    for (const double x : roots) EXPECT_LT(Nearest(found, x), 1e-6) << x;
    for (const double x : found) EXPECT_LT(Nearest(roots, x), 1e-4) << "invented";
  }
  // Quadratics and cubics hold a double root through rounding: the double root of a tangent
  // hypothesis is a solution, not a loss.
  for (uint64_t seed = 0; seed < 2000; ++seed) {
    Random random = Random::Stream(300, seed);
    const double x = random.Normal();
    const double apart = random.Uniform(0.5, 3.0);
    const double y = random.Uniform() < 0.5 ? x - apart : x + apart;
    EXPECT_LT(Nearest(SolveAny(FromRoots({x, x})), x), 1e-7 * std::abs(x)) << seed;
    EXPECT_LT(Nearest(SolveAny(FromRoots({x, x, y})), y), 1e-9) << seed;
    EXPECT_LT(Nearest(SolveAny(FromRoots({x, x, y})), x), 1e-5) << seed;
  }
}

TEST(Polynomial, SeparatesNeighbouringRoots) {
  for (int degree = 2; degree <= 8; ++degree) {
    for (uint64_t seed = 0; seed < 300; ++seed) {
      Random random = Random::Stream(400 + degree, seed);
      const double x = random.Uniform(0.2, 5.0) * (seed % 2 == 0 ? 1.0 : -1.0);
      std::vector<double> roots = {x, x * (1 + 1e-4)};
      while (static_cast<int>(roots.size()) < degree) {
        roots.push_back(-x * random.Uniform(0.3, 3.0));
      }
      const std::vector<double> found = SolveAny(FromRoots(roots));
      EXPECT_LT(Nearest(found, roots[0]), 2e-5 * std::abs(x)) << degree << " seed " << seed;
      EXPECT_LT(Nearest(found, roots[1]), 2e-5 * std::abs(x)) << degree << " seed " << seed;
    }
  }
}

TEST(Polynomial, FindsZeroRoots) {
  for (int multiplicity = 1; multiplicity <= 8; ++multiplicity) {
    for (int others = 0; multiplicity + others <= 8; ++others) {
      std::vector<double> roots(multiplicity, 0.0);
      for (int k = 0; k < others; ++k) roots.push_back(k % 2 == 0 ? 1.5 + k : -0.4 * k);
      const std::vector<double> found = SolveAny(FromRoots(roots));
      for (const double x : roots) {
        EXPECT_LT(Nearest(found, x), 1e-9) << multiplicity << " zeros, " << others << " others";
      }
      for (const double x : found) EXPECT_LT(Nearest(roots, x), 1e-9) << "invented";
    }
  }
}

// The pieces meet at 1 and -1: a root there must be found by one of them, exactly or not.
TEST(Polynomial, FindsRootsAtOneAndMinusOne) {
  for (int degree = 2; degree <= 8; ++degree) {
    for (uint64_t seed = 0; seed < 500; ++seed) {
      Random random = Random::Stream(500 + degree, seed);
      std::vector<double> roots = {1.0, -1.0};
      for (int k = 2; k < degree; ++k) {
        const double x = std::exp(random.Uniform(0.2, 1.5) * (seed % 2 == 0 ? 1.0 : -1.0));
        roots.push_back(random.Uniform() < 0.5 ? -x : x);
      }
      const std::vector<double> c = FromRoots(roots);
      const std::vector<double> found = SolveAny(c);
      EXPECT_LT(Nearest(found, 1.0), 20 * Conditioning(c, 1.0)) << degree << " seed " << seed;
      EXPECT_LT(Nearest(found, -1.0), 20 * Conditioning(c, -1.0)) << degree << " seed " << seed;
    }
  }
  for (int k = -3; k <= 3; ++k) {
    const double x = 1.0 + k * 2.2e-16;
    EXPECT_LT(Nearest(SolveAny(FromRoots({x, 3.0, -0.3, 7.0})), x), 1e-14) << k;
    EXPECT_LT(Nearest(SolveAny(FromRoots({-x, 3.0, -0.3, 7.0})), -x), 1e-14) << k;
  }
}

TEST(Polynomial, NegligibleLeadingCoefficientsLowerTheDegree) {
  for (int degree = 1; degree <= 8; ++degree) {
    for (int used = 1; used <= degree; ++used) {
      for (const double leading : {0.0, 1e-300, 1e-17}) {
        std::vector<double> roots;
        for (int k = 0; k < used; ++k) roots.push_back((k % 2 == 0 ? 1.0 : -1.0) * (0.5 + 0.7 * k));
        std::vector<double> c = FromRoots(roots);
        while (static_cast<int>(c.size()) < degree + 1) c.push_back(leading);
        const std::vector<double> found = SolveAny(c);
        EXPECT_EQ(found.size(), roots.size()) << degree << " used " << used;
        for (const double x : roots) EXPECT_LT(Nearest(found, x), 1e-9);
      }
    }
  }
}

TEST(Polynomial, NoRealRoots) {
  EXPECT_TRUE(SolveAny({1, 0, 1}).empty());
  EXPECT_TRUE(SolveAny({1, 0, 0, 0, 1}).empty());
  EXPECT_TRUE(SolveAny({1, 1, 1, 1, 1, 1, 1}).empty());
  EXPECT_TRUE(SolveAny({-3, 0, 0, 0, -1, 0, 0, 0, -1}).empty());
  EXPECT_EQ(SolveAny({1, 1, 1, 1}).size(), 1u) << "only -1";
}

TEST(Polynomial, ZeroAndConstantPolynomialsHaveNoRoots) {
  for (int degree = 1; degree <= 8; ++degree) {
    std::vector<double> c(degree + 1, 0.0);
    EXPECT_TRUE(SolveAny(c).empty()) << degree;
    c[0] = -2.0;
    EXPECT_TRUE(SolveAny(c).empty()) << degree;
  }
}

TEST(Polynomial, NonFiniteCoefficientsHaveNoRoots) {
  for (int degree = 1; degree <= 8; ++degree) {
    for (int k = 0; k <= degree; ++k) {
      for (const double bad : {kNan, kInf, -kInf}) {
        // x^degree - ... with a sign change, so that roots would be found.
        std::vector<double> c(degree + 1, 0.3);
        c[0] = -1.0;
        c[degree] = 1.0;
        ASSERT_FALSE(SolveAny(c).empty());
        c[k] = bad;
        EXPECT_TRUE(SolveAny(c).empty()) << "degree " << degree << ": c[" << k << "] = " << bad;
      }
    }
  }
}

TEST(Polish, ConvergesToTheRootOfEachStart) {
  const std::vector<double> c = FromRoots({0.01, 0.5, -1.0, 4.0});
  const double starts[] = {0.011, 0.45, -1.1};
  double roots[3];
  ASSERT_EQ(PolishRoots<4>(c.data(), starts, 3, roots), 3);
  EXPECT_NEAR(roots[0], 0.01, 1e-14);
  EXPECT_NEAR(roots[1], 0.5, 1e-14);
  EXPECT_NEAR(roots[2], -1.0, 1e-14);
}

TEST(Polish, DropsDuplicatesAndWhatDoesNotConverge) {
  const std::vector<double> c = FromRoots({0.01, 0.5, -1.0, 4.0});
  double roots[3];
  const double twice[] = {0.011, 0.009};
  EXPECT_EQ(PolishRoots<4>(c.data(), twice, 2, roots), 1);
  // x^2 + 1: Newton's steps wander for ever.
  const double no_root[] = {1, 0, 1, 0, 0};
  const double starts[] = {0.3, 1.7, -2.0};
  EXPECT_EQ(PolishRoots<4>(no_root, starts, 3, roots), 0);
  const double bad[] = {kNan, 1, 1, 1, 1};
  EXPECT_EQ(PolishRoots<4>(bad, starts, 3, roots), 0);
  const double constant[] = {1, 0, 0, 0, 0};
  EXPECT_EQ(PolishRoots<4>(constant, starts, 3, roots), 0);
}

TEST(Polish, KeepsTheRootAtZero) {
  // Pure translation: the start is rounding.
  const std::vector<double> c = FromRoots({0.0, 0.5, -1.0, 4.0});
  const double starts[] = {1e-9};
  double roots[1];
  ASSERT_EQ(PolishRoots<4>(c.data(), starts, 1, roots), 1);
  EXPECT_LT(std::abs(roots[0]), 1e-14);
}

}  // namespace
}  // namespace rigel
