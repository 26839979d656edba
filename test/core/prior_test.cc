#include "rigel/core/prior.h"

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

}  // namespace
}  // namespace rigel
