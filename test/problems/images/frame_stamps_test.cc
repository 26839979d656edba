// Frames of several cameras by their time stamps.
#include "rigel/problems/images/frame_stamps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FrameStamps, ImagesOfThreeCamerasAreFrames) {
  // The second camera drops an image, and the third begins earlier.
  const StampFrames grouped = GroupStamps(
      {{1000000, 2000000, 3000000}, {1000010, 3000020}, {0, 1000000, 2000030, 3000000}}, 0.0001);
  std::vector<int64_t> times;
  for (const StampFrame& frame : grouped.frames) times.push_back(frame.time);
  EXPECT_THAT(times, ElementsAre(0, 1000000, 2000000, 3000000));
  EXPECT_THAT(grouped.frames[0].images, ElementsAre(-1, -1, 0));
  EXPECT_THAT(grouped.frames[1].images, ElementsAre(0, 0, 1));
  EXPECT_THAT(grouped.frames[2].images, ElementsAre(1, -1, 2));
  EXPECT_THAT(grouped.frames[3].images, ElementsAre(2, 1, 3));
  EXPECT_EQ(grouped.largest, 30);
  EXPECT_EQ(grouped.setting, "sync_tolerance_ms 1e-04");
}

TEST(FrameStamps, BeyondTheToleranceTheyAreFramesOfTheirOwn) {
  const StampFrames grouped = GroupStamps({{1000, 2000}, {1100, 2101}}, {});
  EXPECT_THAT(grouped.within, HasSubstr("1e-04 ms, a tenth of the frame interval"));
  ASSERT_EQ(grouped.frames.size(), 3u);
  EXPECT_THAT(grouped.frames[0].images, ElementsAre(0, 0));
  EXPECT_THAT(grouped.frames[1].images, ElementsAre(1, -1));
  EXPECT_THAT(grouped.frames[2].images, ElementsAre(-1, 1));
}

TEST(FrameStamps, EqualStampsNeedNoSetting) {
  const StampFrames grouped = GroupStamps({{5, 7}, {5, 7}}, 0.0);
  EXPECT_EQ(grouped.frames.size(), 2u);
  EXPECT_EQ(grouped.setting, "");
}

}  // namespace
}  // namespace rigel
