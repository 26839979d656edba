#include "rigel/core/prior.h"

#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(Prior, HasPriorAsksForWhatTheKindNeedsAndNoMore) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  MotionPrior prior;
  EXPECT_TRUE(HasPrior(prior, PriorKind::kNone));
  for (const PriorKind kind : {PriorKind::kVertical, PriorKind::kAxis, PriorKind::kPlanar}) {
    EXPECT_FALSE(HasPrior(prior, kind));
  }
  prior.gravity1 = y;
  EXPECT_FALSE(HasPrior(prior, PriorKind::kVertical)) << "one gravity is not enough";
  prior.gravity2 = y;
  EXPECT_TRUE(HasPrior(prior, PriorKind::kVertical));
  EXPECT_FALSE(HasPrior(prior, PriorKind::kAxis));
  prior.axis = y;
  EXPECT_TRUE(HasPrior(prior, PriorKind::kAxis));
  EXPECT_FALSE(HasPrior(prior, PriorKind::kPlanar));
  prior.normal = y;
  EXPECT_TRUE(HasPrior(prior, PriorKind::kPlanar));
}

TEST(Prior, DirectionsAreUnitVectorsAndSigmasPositive) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto error_of = [](const MotionPrior& prior) {
    std::string error = "valid";
    return prior.IsValid(&error) ? std::string("valid") : error;
  };
  EXPECT_EQ(error_of(MotionPrior()), "valid");
  const std::pair<std::optional<Eigen::Vector3d> MotionPrior::*, const char*> directions[] = {
      {&MotionPrior::gravity1, "gravity1"},
      {&MotionPrior::gravity2, "gravity2"},
      {&MotionPrior::axis, "axis"},
      {&MotionPrior::normal, "normal"},
      {&MotionPrior::forward, "forward"}};
  for (const auto& [member, name] : directions) {
    for (const double bad : {0.0, 0.99, 2.0, nan, inf}) {
      MotionPrior prior;
      prior.*member = Eigen::Vector3d(0, bad, 0);
      EXPECT_NE(error_of(prior).find(name), std::string::npos) << bad;
    }
    MotionPrior prior;
    prior.*member = Eigen::Vector3d(0, 0, 1.0 - 0.9 * kMaxUnitError);
    EXPECT_EQ(error_of(prior), "valid");
  }
  const std::pair<std::optional<double> MotionPrior::*, const char*> sigmas[] = {
      {&MotionPrior::gravity_sigma, "gravity_sigma"},
      {&MotionPrior::axis_sigma, "axis_sigma"},
      {&MotionPrior::normal_sigma, "normal_sigma"}};
  for (const auto& [member, name] : sigmas) {
    for (const double bad : {0.0, -1e-3, nan, inf}) {
      MotionPrior prior;
      prior.*member = bad;
      EXPECT_NE(error_of(prior).find(name), std::string::npos) << bad;
    }
  }
  for (const double bad : {-1.0, nan, inf}) {
    MotionPrior prior;
    prior.distance = bad;
    EXPECT_NE(error_of(prior).find("distance"), std::string::npos);
    prior = MotionPrior();
    prior.distance_sigma = bad;
    EXPECT_NE(error_of(prior).find("distance_sigma"), std::string::npos);
  }
  MotionPrior still;
  still.distance = 0.0;
  EXPECT_EQ(error_of(still), "valid");
}

}  // namespace
}  // namespace rigel
