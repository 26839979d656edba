#include "rigel/minimal/numerics/elimination.h"

#include <cmath>

#include <gtest/gtest.h>

#include "rigel/core/random.h"

namespace rigel {
namespace {

TEST(Elimination, SolvesSixEquations) {
  Random rng(1);
  for (int trial = 0; trial < 200; ++trial) {
    double a[6][8], x[6], solution[6];
    for (double& value : x) value = rng.Normal();
    for (auto& row : a) {
      row[6] = row[7] = 0.0;
      for (int k = 0; k < 6; ++k) {
        row[k] = rng.Normal();
        row[6] += row[k] * x[k];
      }
    }
    // Rows must change places.
    if (trial % 2 == 1) {
      a[0][6] -= a[0][0] * x[0];
      a[0][0] = 0.0;
    }
    SolveSixBySix(a, solution);
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(solution[k], x[k], 1e-9) << trial;
  }
}

TEST(Elimination, DependentEquationsAreNotFinite) {
  double a[6][8] = {};
  for (int r = 0; r < 6; ++r) a[r][r] = a[r][6] = 1.0;
  a[5][5] = 0.0;
  double x[6];
  SolveSixBySix(a, x);
  EXPECT_FALSE(std::isfinite(x[5]));
}

TEST(Elimination, NullVectorOfSixRows) {
  Random rng(2);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Vector4d null;
    for (int c = 0; c < 4; ++c) null[c] = rng.Normal();
    null.normalize();
    double M[6][4];
    for (auto& row : M) {
      Eigen::Vector4d v;
      for (int c = 0; c < 4; ++c) v[c] = rng.Normal();
      v -= v.dot(null) * null;
      for (int c = 0; c < 4; ++c) row[c] = v[c];
    }
    const Eigen::Vector4d found = NullVector(M).normalized();
    EXPECT_NEAR(std::abs(found.dot(null)), 1.0, 1e-12) << trial;
  }
}

}  // namespace
}  // namespace rigel
