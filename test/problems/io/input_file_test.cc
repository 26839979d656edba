// Files as bytes: gzip, bounds, byte order marks; and lines of frames.
#include "rigel/problems/io/input_file.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/io/gzip.h"
#include "rigel/problems/io/text_lines.h"
#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

class InputFile : public testing::Test {
 protected:
  std::string Write(const std::string& text) {
    WriteText(dir_ / "a", text);
    return dir_ / "a";
  }
  // What is read, or the message.
  std::string Read(const std::string& text, size_t max_bytes = kMaxInputBytes) {
    InputBytes bytes;
    std::string error;
    const std::string path = Write(text);
    if (!ReadInputFile(path, &bytes, &error, max_bytes)) {
      EXPECT_TRUE(IsOnePrintableLine(error)) << error;
      EXPECT_EQ(error.rfind(path + ": ", 0), 0u) << error;
      return error;
    }
    return std::string(bytes.text());
  }
  std::string FrameLinesError(const std::string& text) {
    std::vector<TextLine> lines;
    std::string error;
    EXPECT_FALSE(ReadFrameLines(Write(text), &lines, &error)) << text;
    return error;
  }

  TempDir dir_;
};

TEST_F(InputFile, PlainAndCompressedAreTheSame) {
  std::string text;
  for (int k = 0; k < 30000; ++k) text += std::to_string(k * 7919) + "\n";
  EXPECT_EQ(Read(text), text);
  EXPECT_EQ(Read(Gzip(text)), text);
  EXPECT_EQ(Read(Gzip(text) + Gzip("more")), text + "more") << "two members";
  EXPECT_EQ(Read(Gzip(text) + std::string(512, '\0')), text) << "padded";
  EXPECT_EQ(Gzip(text), Gzip(text));
  EXPECT_EQ(Read(""), "");
  EXPECT_EQ(Read(Gzip("")), "");
}

TEST_F(InputFile, DamagedGzipIsToldInOneLine) {
  std::string text;
  for (int k = 0; k < 3000; ++k) text += std::to_string(k * 7919) + "\n";
  const std::string good = Gzip(text);
  for (const size_t size : {size_t{2}, size_t{9}, size_t{30}, good.size() / 2, good.size() - 1}) {
    EXPECT_THAT(Read(good.substr(0, size)), HasSubstr("cut off")) << size;
  }
  std::string damaged = good;
  damaged[good.size() - 6] ^= 1;  // the check sum
  EXPECT_THAT(Read(damaged), HasSubstr("damaged"));
  damaged = good;
  damaged[good.size() / 2] ^= 0x55;
  EXPECT_THAT(Read(damaged), HasSubstr("damaged"));
  EXPECT_THAT(Read(good + "rubbish"), HasSubstr("7 bytes after the end"));
}

TEST_F(InputFile, SizesAreBounded) {
  const std::string text(1000, 'x');
  EXPECT_EQ(Read(text, 1000), text);
  EXPECT_EQ(Read(Gzip(text), 1000), text);
  EXPECT_THAT(Read(text, 999), EndsWith("1000 bytes, expected no more than 999 bytes"));
  EXPECT_THAT(Read(Gzip(text), 999), HasSubstr("more than 999 bytes"));
  // Ten million bytes in ten thousand.
  EXPECT_THAT(Read(Gzip(std::string(10'000'000, 'x')), 1 << 20), HasSubstr("more than 1048576"));
  // Nothing tells the size of a pipe.
  std::FILE* const pipe = popen("head -c 5000 /dev/zero | tr '\\0' x", "r");
  ASSERT_NE(pipe, nullptr);
  InputBytes bytes;
  std::string error;
  EXPECT_FALSE(ReadInputFile("/dev/fd/" + std::to_string(fileno(pipe)), &bytes, &error, 4000));
  pclose(pipe);
  EXPECT_THAT(error, HasSubstr("more than 4000 bytes"));
}

// A sparse file of 10 TB is refused by its size; /dev/zero, which has none, by its first NUL.
TEST_F(InputFile, WhatHasNoEndIsRefusedAtOnce) {
  const std::string path = Write("x");
  std::error_code code;
  fs::resize_file(path, 10'000'000'000'000, code);
  InputBytes bytes;
  std::string error;
  if (!code) {
    EXPECT_FALSE(ReadInputFile(path, &bytes, &error));
    EXPECT_THAT(error, EndsWith("10000000000000 bytes, expected no more than 2 GiB"));
  }
  FramePair pair;
  EXPECT_FALSE(ReadMatchFile("/dev/zero", &pair, &error));
  EXPECT_THAT(error, HasSubstr("/dev/zero:1: a NUL byte"));
  // As much as a gigabyte of them compressed.
  const std::string zeros = Write(Gzip(std::string(50'000'000, '\0')));
  EXPECT_FALSE(ReadMatchFile(zeros, &pair, &error));
  EXPECT_THAT(error, HasSubstr(":1: a NUL byte"));
}

TEST_F(InputFile, ByteOrderMarksAreSkippedOrTold) {
  std::vector<TextLine> lines;
  std::string error;
  for (const auto& read : {&ReadTextLines, &ReadFrameLines}) {
    ASSERT_TRUE(read(Write("\xef\xbb\xbf"
                           "1 2\r\n3\n"),
                     &lines, &error))
        << error;
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].text, "1 2");
    for (const std::string mark : {"\xff\xfe", "\xfe\xff"}) {
      EXPECT_FALSE(read(Write(mark + std::string("1\0", 2)), &lines, &error));
      EXPECT_THAT(error, EndsWith("/a: UTF-16, by its byte order mark, expected UTF-8 text"));
    }
    EXPECT_FALSE(read(Write(std::string("1\n2\0\n", 5)), &lines, &error));
    EXPECT_THAT(error, EndsWith("/a:2: a NUL byte, expected UTF-8 text"));
  }
}

TEST_F(InputFile, BytesAreReadAsTheyAre) {
  const std::string with_nul("a\0b", 3);
  for (const std::string& text : {with_nul, Gzip(with_nul), std::string()}) {
    InputBytes bytes;
    std::string error;
    ASSERT_TRUE(ReadBytes(Write(text), &bytes, &error, 1000)) << error;
    EXPECT_EQ(bytes.text(), text);
  }
  InputBytes bytes;
  std::string error;
  EXPECT_FALSE(ReadBytes(Write("12345"), &bytes, &error, 4));
  EXPECT_THAT(error, EndsWith("/a: 5 bytes, expected no more than 4 bytes"));
  EXPECT_FALSE(ReadBytes(dir_ / "none", &bytes, &error, 4));
  EXPECT_THAT(error, EndsWith("/none: cannot be opened: No such file or directory"));
}

TEST_F(InputFile, LinesOfFramesKeepTheirPlaces) {
  std::vector<TextLine> lines;
  std::string error;
  for (const char* text : {"0.1\n0.2\n0.3", "0.1\n0.2\n0.3\n", "0.1\r\n0.2\r\n0.3\r\n \r\n\n"}) {
    ASSERT_TRUE(ReadFrameLines(Write(text), &lines, &error)) << error;
    ASSERT_EQ(lines.size(), 3u);
    EXPECT_EQ(lines[2].text, "0.3");
    EXPECT_EQ(lines[2].number, 3);
  }
  EXPECT_THAT(FrameLinesError("0.1\n\n0.3\n"),
              EndsWith("/a:2: a blank line, expected that of frame 1: every line is that of a "
                       "frame"));
  EXPECT_THAT(FrameLinesError("\n0.1\n"), HasSubstr("/a:1: a blank line"));
  EXPECT_THAT(FrameLinesError("\xef\xbb\xbf# seconds\n0.1\n"), HasSubstr("/a:1: a comment"));
  EXPECT_THAT(FrameLinesError("0.1\n0.2\n #\n"), HasSubstr("/a:3: a comment"));
}

}  // namespace
}  // namespace rigel
