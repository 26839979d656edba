// How far a run is: rates of fast and slow runs, and the time that is left.
#include "rigel/problems/io/progress_text.h"

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(ProgressText, HasTheRateAndTheTimeThatIsLeft) {
  EXPECT_EQ(ProgressText(0, 10, 5), "0 of 10");
  EXPECT_EQ(ProgressText(1, 10, 0), "1 of 10");
  EXPECT_EQ(ProgressText(3, 100, 1.2), "3 of 100, 2.5 per second, 39 s left");
  EXPECT_EQ(ProgressText(500, 4540, 10), "500 of 4540, 50 per second, 81 s left");
  EXPECT_EQ(ProgressText(2, 3, 24), "2 of 3, 12.0 s each, 12 s left");
  EXPECT_EQ(ProgressText(1, 61, 10), "1 of 61, 10.0 s each, 10 min left");
  EXPECT_EQ(ProgressText(1, 1201, 10), "1 of 1201, 10.0 s each, 3 h 20 min left");
  EXPECT_EQ(ProgressText(10, 10, 5), "10 of 10, 2.0 per second");
}

}  // namespace
}  // namespace rigel
