#include "rigel/core/enum_names.h"

#include <gtest/gtest.h>

namespace rigel {
namespace {

enum class Colour { kRed, kGreen, kBlue };

constexpr EnumName<Colour> kNames[] = {{Colour::kRed, "red"}, {Colour::kGreen, "green"}};

TEST(EnumNames, FindsEitherByTheOther) {
  for (const auto& [value, name] : kNames) {
    Colour found = Colour::kBlue;
    EXPECT_TRUE(FindValue(kNames, name, &found));
    EXPECT_EQ(found, value);
    EXPECT_STREQ(NameOf(kNames, value), name);
  }
}

TEST(EnumNames, WhatTheTableDoesNotHave) {
  Colour untouched = Colour::kBlue;
  EXPECT_FALSE(FindValue(kNames, "blue", &untouched));
  EXPECT_FALSE(FindValue(kNames, "", &untouched));
  EXPECT_EQ(untouched, Colour::kBlue);
  EXPECT_STREQ(NameOf(kNames, Colour::kBlue), "unknown");
}

}  // namespace
}  // namespace rigel
