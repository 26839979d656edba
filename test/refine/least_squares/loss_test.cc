// Robust losses: their names, derivatives, and the weight that belongs to each.
#include "rigel/refine/least_squares/loss.h"

#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace rigel {
namespace {

constexpr LossKind kKinds[] = {LossKind::kNone, LossKind::kHuber, LossKind::kCauchy,
                               LossKind::kTukey, LossKind::kTruncated};

TEST(Loss, NamesRoundTrip) {
  for (const LossKind kind : kKinds) {
    LossKind parsed = kind == LossKind::kNone ? LossKind::kTukey : LossKind::kNone;
    EXPECT_TRUE(ParseLoss(LossName(kind), &parsed)) << LossName(kind);
    EXPECT_EQ(parsed, kind);
  }
  EXPECT_STREQ(LossName(LossKind::kCauchy), "cauchy");
  LossKind kind = LossKind::kHuber;
  for (const char* name : {"", "Cauchy", "cauchy ", "unknown", "l2"}) {
    EXPECT_FALSE(ParseLoss(name, &kind)) << name;
    EXPECT_EQ(kind, LossKind::kHuber);
  }
  EXPECT_STREQ(LossName(static_cast<LossKind>(99)), "unknown");
}

TEST(Loss, NoneIsWhatCeresTakesForPlainLeastSquares) {
  EXPECT_EQ(MakeLoss(LossKind::kNone, 1.0), nullptr);
  for (const double r : {0.0, 1.0, 1e9}) EXPECT_EQ(LossWeight(LossKind::kNone, 1.0, r), 1.0);
}

TEST(Loss, DerivativesMatchNumericDifferentiation) {
  for (const LossKind kind : kKinds) {
    if (kind == LossKind::kNone) continue;
    for (const double scale : {0.3, 1.5, 20.0}) {
      const std::unique_ptr<ceres::LossFunction> loss = MakeLoss(kind, scale);
      ASSERT_NE(loss, nullptr) << LossName(kind);
      // At both sides of the scale, not on it: huber and truncated have a corner there.
      for (const double ratio : {1e-4, 0.1, 0.7, 0.98, 1.02, 1.5, 10.0}) {
        const double s = ratio * scale * scale;
        const double h = 1e-5 * s;
        double at[3], low[3], high[3];
        loss->Evaluate(s, at);
        loss->Evaluate(s - h, low);
        loss->Evaluate(s + h, high);
        EXPECT_NEAR(at[1], (high[0] - low[0]) / (2 * h), 1e-6) << LossName(kind) << ' ' << ratio;
        EXPECT_NEAR(at[2], (high[1] - low[1]) / (2 * h), 1e-6 / s)
            << LossName(kind) << ' ' << ratio;
        EXPECT_GE(at[0], 0.0);
        EXPECT_LE(at[0], s * (1 + 1e-12)) << "a robust loss must not exceed the square";
      }
    }
  }
}

TEST(Loss, WeightIsTheDerivativeOfTheLoss) {
  for (const LossKind kind : kKinds) {
    if (kind == LossKind::kNone) continue;
    for (const double scale : {0.3, 1.5, 20.0}) {
      const std::unique_ptr<ceres::LossFunction> loss = MakeLoss(kind, scale);
      for (const double r : {-30.0, -1.6, -0.2, 0.0, 1e-9, 0.1, 0.29, 1.4, 1.51, 19.0, 21.0, 1e6}) {
        double rho[3];
        loss->Evaluate(r * r, rho);
        EXPECT_NEAR(LossWeight(kind, scale, r), rho[1], 1e-12) << LossName(kind) << ' ' << r;
      }
    }
  }
}

TEST(Loss, TruncatedIsTheSquareUpToItsScaleAndFlatBeyond) {
  const std::unique_ptr<ceres::LossFunction> loss = MakeLoss(LossKind::kTruncated, 2.0);
  double rho[3];
  loss->Evaluate(3.999, rho);
  EXPECT_EQ(rho[0], 3.999);
  EXPECT_EQ(rho[1], 1.0);
  EXPECT_EQ(rho[2], 0.0);
  for (const double s : {4.0, 4.001, 1e12}) {
    loss->Evaluate(s, rho);
    EXPECT_EQ(rho[0], 4.0);
    EXPECT_EQ(rho[1], 0.0);
    EXPECT_EQ(rho[2], 0.0);
  }
  EXPECT_EQ(LossWeight(LossKind::kTruncated, 2.0, 1.999), 1.0);
  EXPECT_EQ(LossWeight(LossKind::kTruncated, 2.0, 2.0), 0.0);
}

}  // namespace
}  // namespace rigel
