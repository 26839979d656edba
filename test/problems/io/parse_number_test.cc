// A word is a number as a whole or not at all.
#include "rigel/problems/io/parse_number.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(ParseNumber, FiniteNumbers) {
  double value = 0.0;
  EXPECT_TRUE(ParseFinite("-1.5e3", &value));
  EXPECT_EQ(value, -1500.0);
  EXPECT_TRUE(ParseFinite("+2", &value));
  EXPECT_EQ(value, 2.0);
  for (const char* word : {"", "+", "+-1", "1x", " 1", "1 ", "nan", "inf", "1e999", "0,5"}) {
    EXPECT_FALSE(ParseFinite(word, &value)) << word;
  }
}

TEST(ParseNumber, IntegersFromALeastOne) {
  int value = 0;
  EXPECT_TRUE(ParseInteger("12", 12, &value));
  EXPECT_EQ(value, 12);
  EXPECT_FALSE(ParseInteger("11", 12, &value));
  EXPECT_TRUE(ParseInteger("-3", -3, &value));
  for (const char* word : {"", "+1", "1.0", "1x", " 1", "2147483648"}) {
    EXPECT_FALSE(ParseInteger(word, 0, &value)) << word;
  }
  int64_t large = 0;
  EXPECT_TRUE(ParseInteger("2147483648", int64_t{0}, &large));
  EXPECT_EQ(large, int64_t{1} << 31);
}

}  // namespace
}  // namespace rigel
