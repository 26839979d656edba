// Shards cover a list once, in order.
#include "rigel/problems/evaluation/shard.h"

#include <limits>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(Shard, RangesFollowEachOtherAndDifferByOneAtMost) {
  for (const int n : {0, 1, 3, 7, 100, 23190, std::numeric_limits<int>::max()}) {
    for (const int count : {1, 2, 4, 7, 1000}) {
      int end = 0;
      for (int index = 0; index < count; ++index) {
        const auto [first, second] = Shard{index, count}.Range(n);
        EXPECT_EQ(first, end);
        EXPECT_GE(second - first, n / count);
        EXPECT_LE(second - first - 1, n / count);
        end = second;
      }
      EXPECT_EQ(end, n);
    }
  }
}

TEST(Shard, ParsesIndexAndCountAndNothingElse) {
  Shard shard;
  ASSERT_TRUE(ParseShard("3/4", &shard));
  EXPECT_EQ(shard.index, 3);
  EXPECT_EQ(shard.count, 4);
  for (const char* wrong : {"", "/", "4/4", "-1/2", "a/b", "1/0", "0/0", "1", "1/", "/2", "1/2/3",
                            "1 /2", "1/2 ", "+0/2", "0/-1", "0x0/2", "0/99999999999"}) {
    EXPECT_FALSE(ParseShard(wrong, &shard)) << wrong;
  }
  EXPECT_EQ(shard.index, 3);
  EXPECT_EQ(shard.count, 4);
}

}  // namespace
}  // namespace rigel
