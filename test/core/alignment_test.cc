#include "rigel/core/alignment.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/core/pose.h"
#include "rigel/core/random.h"

namespace rigel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr int kSeeds = 200;

// Gravities as of a car: small tilts, but for some that are anything.
MotionPrior MakePrior(uint64_t seed) {
  Random random = Random::Stream(1, seed);
  const double tilt = seed % 4 == 0 ? 3.0 : 0.1;
  MotionPrior prior;
  prior.gravity1 = ExpSO3(tilt * random.NormalVector3()) * Vector3d::UnitY();
  prior.gravity2 = ExpSO3(tilt * random.NormalVector3()) * *prior.gravity1;
  prior.axis = random.UnitVector3();
  prior.normal = random.UnitVector3();
  return prior;
}

Alignment Make(const MotionPrior& prior, PriorKind kind) {
  Alignment alignment;
  std::string error;
  EXPECT_TRUE(MakeAlignment(prior, kind, &alignment, &error)) << error;
  EXPECT_EQ(alignment.kind, kind);
  return alignment;
}

Matrix3d RotationAt(const Alignment& alignment, double angle) {
  return alignment.Rotation(std::cos(angle), std::sin(angle));
}

// v cos + (n x v) sin + n (n.v) (1 - cos), column by column: Rodrigues' formula.
Matrix3d Rodrigues(const Vector3d& n, double angle) {
  return std::cos(angle) * Matrix3d::Identity() + std::sin(angle) * Skew(n) +
         (1 - std::cos(angle)) * n * n.transpose();
}

TEST(Alignment, RotationIsTheProductOfItsParts) {
  for (const PriorKind kind :
       {PriorKind::kNone, PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Alignment alignment = Make(MakePrior(seed), kind);
      for (const double angle : {-3.0, -0.02, 0.0, 1e-9, 0.7, 2.0}) {
        const Matrix3d R = RotationAt(alignment, angle);
        EXPECT_LT((R - alignment.A2.transpose() * RotationY(angle) * alignment.A1).norm(), 1e-14);
        EXPECT_LT((R.transpose() * R - Matrix3d::Identity()).norm(), 1e-14);
        EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
      }
    }
  }
}

TEST(Alignment, EveryMemberOfTheVerticalFamilyKeepsGravity) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    const MotionPrior prior = MakePrior(seed);
    const Alignment alignment = Make(prior, PriorKind::kVertical);
    EXPECT_LT((alignment.A1 * *prior.gravity1 - Vector3d::UnitY()).norm(), 1e-14);
    EXPECT_LT((alignment.A2 * *prior.gravity2 - Vector3d::UnitY()).norm(), 1e-14);
    for (const double angle : {-1.0, 0.0, 0.3}) {
      EXPECT_LT((RotationAt(alignment, angle) * *prior.gravity1 - *prior.gravity2).norm(), 1e-14);
    }
  }
}

TEST(Alignment, AngleZeroIsTheSmallestRotationThatTheGravitiesAllow) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    const MotionPrior prior = MakePrior(seed);
    const Alignment alignment = Make(prior, PriorKind::kVertical);
    const double between = TranslationDirectionError(*prior.gravity1, *prior.gravity2);
    EXPECT_NEAR(LogSO3(RotationAt(alignment, 0.0)).norm(), between, 1e-13) << seed;
    for (double angle = -3.1; angle < 3.1; angle += 0.1) {
      EXPECT_GE(LogSO3(RotationAt(alignment, angle)).norm(), between - 1e-13);
    }
  }
}

TEST(Alignment, AxisAndPlanarFamiliesAreRodriguesRotations) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    const MotionPrior prior = MakePrior(seed);
    const Alignment axis = Make(prior, PriorKind::kAxis);
    const Alignment planar = Make(prior, PriorKind::kPlanar);
    for (const double angle : {-2.0, -1e-3, 0.0, 0.4, 3.0}) {
      EXPECT_LT((RotationAt(axis, angle) - Rodrigues(*prior.axis, angle)).norm(), 1e-14);
      EXPECT_LT((RotationAt(planar, angle) - Rodrigues(*prior.normal, angle)).norm(), 1e-14);
    }
    EXPECT_TRUE(axis.contains_identity);
    EXPECT_TRUE(planar.contains_identity);
  }
}

TEST(Alignment, NoPriorLeavesTheFramesAlone) {
  const Alignment alignment = Make(MotionPrior(), PriorKind::kNone);
  EXPECT_EQ(alignment.A1, Matrix3d::Identity());
  EXPECT_EQ(alignment.A2, Matrix3d::Identity());
}

TEST(Alignment, ContainsIdentityOnlyIfTheGravitiesAreTheSame) {
  MotionPrior prior;
  prior.gravity1 = Vector3d(0.1, 1.0, -0.2).normalized();
  prior.gravity2 = prior.gravity1;
  EXPECT_TRUE(Make(prior, PriorKind::kVertical).contains_identity);
  prior.gravity2 = ExpSO3(Vector3d(1e-9, 0, 0)) * *prior.gravity1;
  EXPECT_FALSE(Make(prior, PriorKind::kVertical).contains_identity);
}

TEST(Alignment, NearestAngleInvertsTheFamily) {
  for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Alignment alignment = Make(MakePrior(seed), kind);
      for (const double angle : {-3.0, -1e-8, 0.0, 0.2, 3.1}) {
        EXPECT_NEAR(alignment.NearestAngle(RotationAt(alignment, angle)), angle, 1e-14);
      }
    }
  }
}

TEST(Alignment, NearestAngleIsTheNearestForOtherRotations) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(2, seed);
    const Alignment alignment = Make(MakePrior(seed), PriorKind::kVertical);
    const Matrix3d tilt = ExpSO3(0.3 * random.NormalVector3());
    const Matrix3d R = tilt * RotationAt(alignment, random.Uniform(-3.0, 3.0));
    const double angle = alignment.NearestAngle(R);
    const double nearest = RotationError(R, RotationAt(alignment, angle));
    for (const double step : {1e-3, 0.1, 1.0, 3.0}) {
      EXPECT_LT(nearest, RotationError(R, RotationAt(alignment, angle + step)));
      EXPECT_LT(nearest, RotationError(R, RotationAt(alignment, angle - step)));
    }
  }
}

TEST(Alignment, AxisInFrame2TurnsTheFamilyFromTheLeft) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Alignment alignment = Make(MakePrior(seed), PriorKind::kVertical);
    const double h = 0.1;
    EXPECT_LT((ExpSO3(h * alignment.AxisInFrame2()) * RotationAt(alignment, 0.4) -
               RotationAt(alignment, 0.4 + h))
                  .norm(),
              1e-14);
  }
}

TEST(Alignment, WorksForUpsideDownFrames) {
  // Body frames with Y up: A1 is a half turn. Near it the axis of the smallest rotation is badly
  // conditioned, which must not tilt the aligned frame.
  for (const double tilt : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
    MotionPrior prior;
    prior.gravity1 = ExpSO3(Vector3d(0.6 * tilt, 0.0, 0.8 * tilt)) * -Vector3d::UnitY();
    prior.gravity2 = prior.gravity1;
    prior.axis = prior.normal = prior.gravity1;
    for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
      const Alignment alignment = Make(prior, kind);
      EXPECT_LT((alignment.A1 * *prior.gravity1 - Vector3d::UnitY()).norm(), 2e-12) << tilt;
      EXPECT_LT((alignment.A1.transpose() * alignment.A1 - Matrix3d::Identity()).norm(), 1e-14);
    }
  }
}

TEST(Alignment, NormalizesNearlyUnitDirections) {
  MotionPrior prior;
  prior.axis = 1.0009 * Vector3d(1, 2, 3).normalized();
  const Alignment alignment = Make(prior, PriorKind::kAxis);
  EXPECT_LT((alignment.A1 * Vector3d(1, 2, 3).normalized() - Vector3d::UnitY()).norm(), 1e-14);
}

TEST(Alignment, SaysWhichPartOfThePriorIsMissingOrBad) {
  struct Case {
    PriorKind kind;
    std::optional<Vector3d> MotionPrior::*part;
    const char* name;
  };
  const Case cases[] = {{PriorKind::kVertical, &MotionPrior::gravity1, "gravity1"},
                        {PriorKind::kVertical, &MotionPrior::gravity2, "gravity2"},
                        {PriorKind::kAxis, &MotionPrior::axis, "axis"},
                        {PriorKind::kPlanar, &MotionPrior::normal, "normal"}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Case& c : cases) {
    const std::optional<Vector3d> bad_values[] = {
        std::nullopt,          Vector3d(0, 0, 0),   Vector3d(0, 1.002, 0), Vector3d(0, 0.998, 0),
        Vector3d(0, 1.0, nan), Vector3d(inf, 1, 0), Vector3d(1, 1, 1)};
    for (const std::optional<Vector3d>& bad : bad_values) {
      MotionPrior prior = MakePrior(1);
      prior.*c.part = bad;
      Alignment alignment;
      alignment.A1 = 2.0 * Matrix3d::Identity();
      std::string error;
      EXPECT_FALSE(MakeAlignment(prior, c.kind, &alignment, &error));
      EXPECT_THAT(error, HasSubstr(c.name));
      EXPECT_EQ(alignment.A1, 2.0 * Matrix3d::Identity()) << "the output is left alone";
      // What other kinds need is of no interest.
      EXPECT_TRUE(MakeAlignment(prior, PriorKind::kNone, &alignment, &error));
    }
  }
}

}  // namespace
}  // namespace rigel
