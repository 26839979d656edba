#include "rigel/problems/io/json_text.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/io/json_message.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string Message(const std::string& text) {
  try {
    ParseJson(text);
  } catch (const std::exception& exception) {
    return JsonMessage(exception);
  }
  return "";
}

std::string Nested(int depth) { return std::string(depth, '[') + std::string(depth, ']'); }

TEST(JsonText, NestsAsDeepAsItMayAndNotDeeper) {
  EXPECT_EQ(Message(Nested(kMaxJsonDepth)), "");
  EXPECT_EQ(Message("\n\n" + Nested(kMaxJsonDepth + 1)), "line 3: nested more than 64 deep");
  EXPECT_EQ(Message(Nested(10000000)), "line 1: nested more than 64 deep");
  // Beside each other, and in strings, they do not count.
  std::string many = "[";
  for (int k = 0; k < 100; ++k) many += "[],{},";
  EXPECT_EQ(Message(many + "\"" + std::string(100, '[') + "\\\"" + std::string(100, '{') + "\"]"),
            "");
}

TEST(JsonText, MessagesQuoteOnlyAPart) {
  const std::string message = Message("[\"" + std::string(1000000, 'a'));
  EXPECT_THAT(message, HasSubstr("parse error"));
  EXPECT_THAT(message, Not(HasSubstr("json.exception")));
  EXPECT_LT(message.size(), 310u);
  EXPECT_EQ(QuoteJson(ParseJson(Nested(5))), "an array");
  EXPECT_EQ(QuoteJson(ParseJson("{}")), "an object");
  EXPECT_EQ(QuoteJson(ParseJson("1.5")), "'1.5'");
  EXPECT_EQ(QuoteJson("text"), "'\"text\"'");
  EXPECT_EQ(QuoteJson(std::string(100, 'a')), "'\"" + std::string(29, 'a') + "...'");
}

TEST(JsonMessage, WhatItQuotesOfAFileIsPrintable) {
  const std::string message = Message("{\"a\": 1, \x88\x9b: 2}");
  EXPECT_NE(message, "");
  EXPECT_EQ(Printable(message), message);
}

}  // namespace
}  // namespace rigel
