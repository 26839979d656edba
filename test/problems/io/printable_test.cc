// What may reach a terminal.
#include "rigel/problems/io/printable.h"

#include <gtest/gtest.h>

#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

TEST(Printable, WhatCommandsATerminalIsShownInHexadecimal) {
  const std::pair<std::string, std::string> cases[] = {
      {"plain, Z\xc3\xbcrich \xe2\x82\xac \xf0\x9f\x9a\x97", ""},  // stays
      {"\x1b[2J", "\\x1b[2J"},
      {"a\nb\tc\x7f", "a\\x0ab\\x09c\\x7f"},
      {"\xc2\x9b"
       "2J",
       "\\xc2\\x9b2J"},  // C1 in UTF-8
      {"\x9b"
       "2J",
       "\\x9b2J"},                                // C1 of one byte: no UTF-8
      {"\xe2\x80\xaegpj", "\\xe2\\x80\\xaegpj"},  // right-to-left override
      {"\xe2\x81\xa6x", "\\xe2\\x81\\xa6x"},      // isolate
      {"\xe2\x80\xa8", "\\xe2\\x80\\xa8"},        // line separator
      {"\xef\xbb\xbfP0", "\\xef\\xbb\\xbfP0"},    // byte order mark
      {"\xc3", "\\xc3"},
      {"\xed\xa0\x80", "\\xed\\xa0\\x80"},  // surrogate
      {"\xc0\x9b", "\\xc0\\x9b"},           // overlong
      {std::string(1, '\0'), "\\x00"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_EQ(Printable(text), expected.empty() ? text : expected);
    Table table;
    table.AddHeader({text});
    table.AddRow({text});
    EXPECT_EQ(table.Format().substr(0, Printable(text).size() + 1), Printable(text) + "\n");
    EXPECT_EQ(CsvText(text + "\""), "\"" + Printable(text) + "\"\"\"");
  }
}

TEST(Printable, WordsAreCutBetweenCharacters) {
  EXPECT_EQ(Quoted("\x1b"), "'\\x1b'");
  EXPECT_EQ(Quoted(std::string(30, 'a')), "'" + std::string(30, 'a') + "'");
  EXPECT_EQ(Quoted(std::string(31, 'a')), "'" + std::string(30, 'a') + "...'");
  EXPECT_EQ(Quoted(std::string(29, 'a') + "\xe2\x82\xac"), "'" + std::string(29, 'a') + "...'");
}

TEST(Printable, JsonKeepsItsStrings) {
  EXPECT_EQ(PrintableJson("{\n  \"Z\xc3\xbcrich\": \"a\\u001bb\"\n}\n"),
            "{\n  \"Z\xc3\xbcrich\": \"a\\u001bb\"\n}\n");
  EXPECT_EQ(PrintableJson("[\"\x7f\xc2\x9b\xe2\x80\xae\xef\xbb\xbf\"]"),
            "[\"\\u007f\\u009b\\u202e\\ufeff\"]");
}

}  // namespace
}  // namespace rigel
