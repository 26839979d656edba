#include "rigel/minimal/ransac/ransac_options.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(RansacOptions, SaysWhatIsWrong) {
  std::string error = "untouched";
  EXPECT_TRUE(RansacOptions().IsValid(&error));
  EXPECT_EQ(error, "untouched");
  struct Case {
    const char* name;
    void (*damage)(RansacOptions*);
  };
  const Case cases[] = {
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = 1e-13; }},
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = -1.0; }},
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = kNan; }},
      {"threshold_px", [](RansacOptions* o) { o->threshold_px = kInf; }},
      {"confidence", [](RansacOptions* o) { o->confidence = 0.0; }},
      {"confidence", [](RansacOptions* o) { o->confidence = 1.0; }},
      {"confidence", [](RansacOptions* o) { o->confidence = kNan; }},
      {"max_iterations", [](RansacOptions* o) { o->max_iterations = 0; }},
      {"min_iterations", [](RansacOptions* o) { o->min_iterations = -1; }},
      {"num_finalists", [](RansacOptions* o) { o->num_finalists = -1; }},
      {"num_finalists", [](RansacOptions* o) { o->num_finalists = kMaxFinalists + 1; }},
  };
  for (const Case& c : cases) {
    RansacOptions options;
    c.damage(&options);
    EXPECT_FALSE(options.IsValid(&error)) << c.name;
    EXPECT_THAT(error, HasSubstr(c.name));
  }
}

}  // namespace
}  // namespace rigel
