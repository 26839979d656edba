#include "rigel/minimal/numerics/twenty_solutions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/LU>

#include "rigel/core/random.h"
#include "rigel/minimal/numerics/polynomial_system.h"

namespace rigel::polynomial_system {
namespace {

using Complex = std::complex<long double>;
using Point = std::array<Complex, 3>;
using Matrix = Eigen::Matrix<Complex, 20, 20>;

Complex Monomial(const Point& p, int index) {
  Complex product = 1.0L;
  for (int i = 0; i < 3; ++i) {
    for (int n = 0; n < kMonomials.exponents[index][i]; ++n) product *= p[i];
  }
  return product;
}

// Multiplication by x where the solutions are twenty points: as many real ones as given, some of
// them in the origin, the others in complex pairs.
class Problem {
 public:
  // Coordinates are of the order of 1 / `spread` to `spread`; the origin is a solution `at_zero` <=
  // 2 times.
  Problem(int num_real, int at_zero, double spread, uint64_t seed) {
    Random random = Random::Stream(23, seed);
    std::vector<Point> points;
    for (int k = 0; k < num_real; ++k) {
      const double scale = std::pow(spread, random.Uniform(-1, 1));
      const Eigen::Vector3d p = scale * random.NormalVector3();
      points.push_back({p[0], p[1], p[2]});
      if (k < at_zero) points.back() = {};
      if (k >= at_zero) real.push_back(p);
    }
    while (points.size() < 20) {
      const Eigen::Vector3d re = random.NormalVector3();
      const Eigen::Vector3d im = random.NormalVector3();
      points.emplace_back();
      for (int i = 0; i < 3; ++i) points.back()[i] = Complex(re[i], im[i]);
      points.push_back(points.back());
      for (Complex& c : points.back()) c = std::conj(c);
    }
    Matrix v, xv;
    for (int b = 0; b < 20; ++b) {
      for (int p = 0; p < 20; ++p) {
        v(b, p) = Monomial(points[p], b);
        xv(b, p) = points[p][0] * v(b, p);
      }
    }
    if (at_zero == 2) {
      // A double point: the derivative of the monomials in some direction takes the second's place.
      const Eigen::Vector3d direction = random.UnitVector3();
      v.col(1).setZero();
      for (int i = 0; i < 3; ++i) v(1 + i, 1) = direction[i];
      xv.col(1) = Complex(direction[0]) * v.col(0);
    }
    const Matrix A = xv * Eigen::FullPivLU<Matrix>(v).inverse();
    for (int b = 0; b < 20; ++b) {
      for (int k = 0; k < 20; ++k) action.entries[b][k] = static_cast<double>(A(b, k).real());
      if (b >= NumMonomials(2)) continue;
      // x times a monomial is a monomial: one entry.
      std::fill(action.entries[b], action.entries[b] + 20, 0.0);
      action.entries[b][kMonomials.product[b][1]] = 1.0;
    }
  }

  // How many real solutions are not among `count` in `found`.
  int NumMissed(const double (*found)[3], int count, double tolerance) const {
    int missed = 0;
    for (const Eigen::Vector3d& p : real) {
      double best = 1e300;
      for (int k = 0; k < count; ++k) {
        best = std::min(best, (Eigen::Vector3d(found[k]) - p).norm() / p.norm());
      }
      missed += best < tolerance ? 0 : 1;
    }
    return missed;
  }

  std::vector<Eigen::Vector3d> real;  // but the origin
  ActionMatrix<20> action;
};

TEST(TwentySolutions, RealSolutionsAreFoundNearAndFar) {
  int missed = 0, total = 0;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const int num_real = 2 + 2 * static_cast<int>(seed % 4);
    Problem problem(num_real, 0, 10.0, seed);
    double found[20][3];
    const int count = FindTwentySolutions(0, &problem.action, found);
    ASSERT_GE(count, 0);
    ASSERT_LE(count, 20);
    missed += problem.NumMissed(found, count, 1e-4);
    total += num_real;
  }
  EXPECT_LE(missed, total / 1000);
}

TEST(TwentySolutions, SolutionsInTheOriginAreLeftOut) {
  int missed = 0, total = 0;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const int at_zero = 1 + static_cast<int>(seed % 2);
    Problem problem(6, at_zero, 10.0, seed);
    double found[20][3];
    const int count = FindTwentySolutions(at_zero, &problem.action, found);
    for (int k = 0; k < count; ++k) EXPECT_GT(std::abs(found[k][0]), 1e-9) << seed;
    missed += problem.NumMissed(found, count, 1e-4);
    total += 6 - at_zero;
  }
  EXPECT_LE(missed, total / 1000);
}

TEST(TwentySolutions, PathsGiveTheSameBits) {
  if (BestCpuPath() == CpuPath::kBaseline) GTEST_SKIP() << "one path only";
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const Problem problem(6, 0, 10.0, seed);
    ActionMatrix<20> action1 = problem.action;
    ActionMatrix<20> action2 = problem.action;
    double found1[20][3], found2[20][3];
    const int count = FindTwentySolutions(0, &action1, found1, CpuPath::kBaseline);
    ASSERT_EQ(FindTwentySolutions(0, &action2, found2, BestCpuPath()), count);
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < 3; ++i) EXPECT_EQ(found1[k][i], found2[k][i]) << seed;
    }
  }
}

}  // namespace
}  // namespace rigel::polynomial_system
