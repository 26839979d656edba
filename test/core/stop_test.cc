#include "rigel/core/stop.h"

#include <atomic>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(Stop, WithoutLimitAndFlagItNeverStops) {
  Stop none;
  EXPECT_FALSE(none.Asked());
  EXPECT_EQ(none.reason(), StopReason::kNone);
  EXPECT_EQ(none.Message(), "");
  EXPECT_FALSE(none.SecondsLeft().has_value());
}

TEST(Stop, ALimitThatIsOverStopsAndALongOneDoesNot) {
  Stop over(0.0, nullptr);
  EXPECT_EQ(over.reason(), StopReason::kNone) << "not asked yet";
  EXPECT_TRUE(over.Asked());
  EXPECT_EQ(over.reason(), StopReason::kTimeLimit);
  EXPECT_EQ(over.Message(), "stopped at the time limit of 0 ms");
  EXPECT_EQ(over.SecondsLeft(), 0.0);

  Stop later(1e300, nullptr);
  EXPECT_FALSE(later.Asked());
  EXPECT_GT(*later.SecondsLeft(), 1e299);
}

TEST(Stop, TheFlagStopsAndTheAnswerStays) {
  std::atomic<bool> cancel{false};
  Stop stop(0.05 * 1e9, &cancel);
  EXPECT_FALSE(stop.Asked());
  cancel = true;
  EXPECT_TRUE(stop.Asked());
  cancel = false;
  EXPECT_TRUE(stop.Asked());
  EXPECT_EQ(stop.reason(), StopReason::kCancelled);
  EXPECT_EQ(stop.Message(), "cancelled");
}

TEST(Stop, ALimitIsFiniteAndNotNegative) {
  std::string error;
  EXPECT_TRUE(IsValidTimeLimit(std::nullopt, &error));
  EXPECT_TRUE(IsValidTimeLimit(0.0, &error));
  EXPECT_TRUE(IsValidTimeLimit(1e-3, &error));
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {-1e-9, inf, -inf, std::numeric_limits<double>::quiet_NaN()}) {
    error.clear();
    EXPECT_FALSE(IsValidTimeLimit(bad, &error)) << bad;
    EXPECT_NE(error.find("time_limit"), std::string::npos);
  }
}

TEST(Stop, ReasonsHaveNames) {
  EXPECT_STREQ(StopReasonName(StopReason::kNone), "none");
  EXPECT_STREQ(StopReasonName(StopReason::kTimeLimit), "time limit");
  EXPECT_STREQ(StopReasonName(StopReason::kCancelled), "cancelled");
}

}  // namespace
}  // namespace rigel
