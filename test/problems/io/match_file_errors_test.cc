// Every broken match file is refused with the line and what was expected.
#include "rigel/problems/io/match_file.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

struct Broken {
  const char* what;
  std::string from;  // replaced in kValid by
  std::string to;
  int line;
  const char* phrase;  // of the message
};

void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.what; }

class BrokenMatchFile : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenMatchFile, IsRefused) {
  const Broken& c = GetParam();
  const std::string text = Replace(kValid, c.from, c.to);
  for (const std::string& variant : {text, ReplaceAll(text, "\n", "\r\n")}) {
    FramePair pair;
    pair.name = "untouched";
    pair.noise_px = 7;
    std::string error;
    ASSERT_FALSE(ParseMatches(variant, "x.matches", &pair, &error));
    EXPECT_EQ(error.rfind("x.matches:" + std::to_string(c.line) + ": ", 0), 0u) << error;
    EXPECT_NE(error.find(c.phrase), std::string::npos) << error;
    EXPECT_NE(error.find("expected"), std::string::npos) << error;
    EXPECT_TRUE(IsOnePrintableLine(error)) << error;
    EXPECT_EQ(pair.name, "untouched");
    EXPECT_EQ(pair.noise_px, 7);
    EXPECT_TRUE(pair.matches.empty() && pair.rig.cameras.empty());
  }
}

const char kRow[] = "0 34.25 103.5 0 11.75 101 0.5";
const char kCamera1[] = "camera 1 pinhole 710 711 610 190 1240 376 0.6 0.8 0 0 0.5 -0.1 2";
const char kColumns[] = "expected 7 (I U V J U2 V2 SCORE)";

INSTANTIATE_TEST_SUITE_P(
    Header, BrokenMatchFile,
    ::testing::ValuesIn(std::vector<Broken>{
        {"no format line", "format rigmatch 1\n", "", 17, "no 'format' line before 'matches'"},
        {"no format line, comments only", std::string(kValid), "# nothing\n", 1, "without a 'form"},
        {"other format", "rigmatch 1", "colmap 1", 2, "format 'colmap' version '1'"},
        {"version 2", "rigmatch 1", "rigmatch 2", 2, "'format rigmatch 1', the version that is"},
        {"version 1.0", "rigmatch 1", "rigmatch 1.0", 2, "version '1.0'"},
        {"format short", "rigmatch 1", "rigmatch", 2, "2 columns, expected 3 (format rigmatch 1)"},
        {"unknown keyword", "time 1.5", "times 1.5", 5, "unknown keyword 'times'"},
        {"keyword in capitals", "time 1.5", "Time 1.5", 5,
         "expected one of format, camera, camera_sigma"},
        {"format twice", "time 1.5 1.625", "format rigmatch 1", 5,
         "second time, expected once (line 2"},
        {"time twice", "gravity1 0 1 0", "time 1 2", 7, "'time' for the second time"},
        {"truth twice", "time 1.5 1.625", "truth 1 0 0 0 0 0 0", 6, "once (line 5)"},
        {"gravity1 twice", "gravity2 0.6 0.8 0", "gravity1 0 1 0", 8, "'gravity1' for the second"},
        {"noise_px twice", "sequence loop-06", "noise_px 1", 16, "'noise_px' for the second"},
        {"sequence twice", "noise_px 0.75", "sequence a", 16, "'sequence' for the second"},
        {"camera twice", "camera 1", "camera 0", 4,
         "camera 0 for the second time, expected once (line 3)"},
        {"camera gap", "camera 1", "camera 2", 4, "camera 2 without a camera 1"},
        {"camera from 1", "camera 0", "camera 2", 4, "camera 1 without a camera 0"},
        {"camera negative", "camera 1", "camera -1", 4, "K is '-1', expected an integer from 0"},
        {"camera absurd", "camera 1", "camera 2147483647", 4, "without a camera 1"},
        {"camera overflow", "camera 1", "camera 4294967296", 4, "K is '4294967296'"},
        {"camera not a number", "camera 1", "camera left", 4, "K is 'left'"},
        {"camera model", "0 pinhole", "0 fisheye", 3,
         "camera model 'fisheye', expected one of pinhole, simple_pinhole, simple_radial, radial"},
        {"camera without a model", "0 pinhole 700.5 701 600 180.25 1226 370 1 0 0 0 0 0 0", "0", 3,
         "no camera model, expected 'camera K MODEL PARAMETER ..."},
        {"camera model's columns", "0 pinhole", "0 opencv_fisheye", 3,
         "16 columns, expected 20 (camera K opencv_fisheye FX FY CX CY K1 K2 K3 K4 WIDTH HEIGHT"},
        {"camera model's parameter", "0 pinhole 700.5", "0 fov 700.5 700.5", 3,
         "fov: omega is 180.250000, expected an angle between 0 and pi"},
        {"camera model's focal length", "0 pinhole 700.5 701", "0 eucm 0.6 1.1 -700.5 701", 3,
         "FX is '-700.5', expected a positive number"},
        {"camera short", " 0.5 -0.1 2", " 0.5 -0.1", 4,
         "15 columns, expected 16 (camera K pinhole FX"},
        {"camera long", " 0.5 -0.1 2", " 0.5 -0.1 2 3 4", 4, "18 columns, expected 16"},
        {"FX zero", "700.5 701", "0 701", 3, "FX is '0', expected a positive number"},
        {"FY negative", "700.5 701", "700.5 -701", 3, "FY is '-701', expected a positive number"},
        {"FX nan", "700.5 701", "nan 701", 3, "FX is 'nan', expected a finite number"},
        {"CX infinite", "701 600", "701 inf", 3, "CX is 'inf'"},
        {"CY not a number", "180.25", "180,25", 3, "CY is '180,25'"},
        {"WIDTH zero", "1226 370", "0 370", 3, "WIDTH is '0', expected an integer from 1"},
        {"HEIGHT negative", "1226 370", "1226 -370", 3, "HEIGHT is '-370'"},
        {"HEIGHT not whole", "1226 370", "1226 370.5", 3, "HEIGHT is '370.5'"},
        {"camera quaternion", "0.6 0.8 0 0", "0.6 0.81 0 0", 4, "quaternion has norm 1.008"},
        {"camera quaternion zero", "0.6 0.8 0 0", "0 0 0 0", 4,
         "has norm 0, expected 1 within 0.001"},
        {"camera position", "0.5 -0.1 2", "0.5 -0.1 1e999", 4, "SZ is '1e999'"},
        {"quaternion overflow", "0.6 0.8 0 0", "1e200 0 0 0", 4, "quaternion has norm"},
        {"camera_sigma of no camera", "time 1.5", "camera_sigma 2 1 1\ntime 1.5", 5,
         "K is '2', expected a declared camera (0 to 1)"},
        {"camera_sigma twice", "time 1.5", "camera_sigma 1 1 1\ncamera_sigma 1 1 1\ntime 1.5", 6,
         "camera_sigma 1 for the second time, expected once (line 5)"},
        {"camera_sigma short", "time 1.5", "camera_sigma 1 1\ntime 1.5", 5,
         "3 columns, expected 4 (camera_sigma K ROT_DEG POS_M [FOCAL_FRACTION])"},
        {"camera_sigma long", "time 1.5", "camera_sigma 1 1 1 1 1\ntime 1.5", 5,
         "6 columns, expected 4"},
        {"camera_sigma zero", "time 1.5", "camera_sigma 1 0 1\ntime 1.5", 5,
         "ROT_DEG is '0', expected a positive number"},
        {"camera_sigma negative", "time 1.5", "camera_sigma 1 1 -1\ntime 1.5", 5,
         "POS_M is '-1', expected a positive number"},
        {"camera_sigma focal", "time 1.5", "camera_sigma 1 1 1 0\ntime 1.5", 5,
         "[FOCAL_FRACTION] is '0', expected a positive number"},
        {"camera_sigma nan", "time 1.5", "camera_sigma 1 nan 1\ntime 1.5", 5,
         "ROT_DEG is 'nan', expected a finite number"},
        {"camera_time of no camera", "time 1.5", "camera_time 7 1\ntime 1.5", 5,
         "K is '7', expected a declared camera (0 to 1)"},
        {"camera_time twice", "time 1.5", "camera_time 0 1\ncamera_time 0 1\ntime 1.5", 6,
         "camera_time 0 for the second time, expected once (line 5)"},
        {"camera_time infinite", "time 1.5", "camera_time 0 inf\ntime 1.5", 5,
         "DT is 'inf', expected a finite number"},
        {"camera_time short", "time 1.5", "camera_time 0\ntime 1.5", 5,
         "2 columns, expected 3 (camera_time K DT)"},
        {"no camera",
         "camera 0 pinhole 700.5 701 600 180.25 1226 370 1 0 0 0 0 0 0\n" + std::string(kCamera1) +
             "\n",
         "", 16, "no 'camera' line before 'matches'"},
        {"time short", "1.5 1.625", "1.5", 5, "2 columns, expected 3 (time T1 T2)"},
        {"time nan", "1.5 1.625", "1.5 -nan", 5, "T2 is '-nan'"},
        {"time infinity", "1.5 1.625", "infinity 1.5", 5, "T1 is 'infinity'"},
        {"truth short", "0.25 -0.5 1.25", "0.25 -0.5", 6, "7 columns, expected 8 (truth QW"},
        {"truth quaternion", "0.8 0 -0.6 0", "0.8 0 -0.6 0.1", 6, "quaternion has norm 1.00499"},
        {"truth translation", "0.25 -0.5 1.25", "0.25 x 1.25", 6, "TY is 'x'"},
        {"gravity1 zero", "gravity1 0 1 0", "gravity1 0 0 0", 7, "direction has norm 0,"},
        {"gravity1 9.81", "gravity1 0 1 0", "gravity1 0 9.81 0", 7, "norm 9.81, expected 1 within"},
        {"gravity2 off by 0.0011", "gravity2 0.6 0.8 0", "gravity2 0.6 0.801376 0", 8,
         "direction has norm 1.0011"},
        {"gravity2 long", "gravity2 0.6 0.8 0", "gravity2 0.6 0.8 0 0", 8,
         "5 columns, expected 4 (gravity2 GX GY"},
        {"gravity sigma zero", "deg 0.5", "deg 0", 9, "S is '0', expected a positive number"},
        {"gravity sigma negative", "deg 0.5", "deg -0.5", 9, "S is '-0.5', expected a positive"},
        {"gravity sigma nan", "deg 0.5", "deg nan", 9, "S is 'nan', expected a finite"},
        {"gravity sigma vanishes", "deg 0.5", "deg 4.9e-324", 9, "expected a positive number"},
        {"axis norm", "axis 0 0.6 0.8", "axis 0 0.6 0.7", 10, "direction has norm 0.921954"},
        {"axis nan", "axis 0 0.6 0.8", "axis nan 0.6 0.8", 10, "NX is 'nan'"},
        {"axis sigma zero", "deg 0.25", "deg 0.0", 11, "S is '0.0'"},
        {"normal norm", "normal 0 -1 0", "normal 0 -2 0", 12, "direction has norm 2,"},
        {"normal sigma", "deg 2", "deg", 13, "1 column, expected 2 (normal_sigma_deg S)"},
        {"forward norm", "normal_sigma_deg 2", "forward 1 1 0", 13, "direction has norm 1.41421"},
        {"forward short", "normal_sigma_deg 2", "forward 1 0", 13,
         "3 columns, expected 4 (forward FX FY FZ)"},
        {"forward nan", "normal_sigma_deg 2", "forward 0 nan 1", 13, "FY is 'nan'"},
        {"forward twice", "normal 0 -1 0\nnormal_sigma_deg 2", "forward 1 0 0\nforward 1 0 0", 13,
         "'forward'"},
        {"rotation sigma missing", "distance 1.5 0.125", "rotation 1 0 0 0", 14,
         "5 columns, expected 6 (rotation QW QX QY QZ SIGMA_DEG)"},
        {"rotation sigma zero", "distance 1.5 0.125", "rotation 1 0 0 0 0", 14,
         "SIGMA_DEG is '0', expected a positive"},
        {"rotation too long", "distance 1.5 0.125", "rotation 1 0 0 1 0.5", 14, "quaternion"},
        {"rotation twice", "distance 1.5 0.125", "rotation 1 0 0 0 1\nrotation 1 0 0 0 1", 15,
         "'rotation'"},
        {"distance negative", "1.5 0.125", "-1.5 0.125", 14, "D is '-1.5', expected a number >= 0"},
        {"distance sigma zero", "1.5 0.125", "1.5 0", 14, "SIGMA is '0', expected a positive"},
        {"distance sigma missing", "1.5 0.125", "1.5", 14,
         "2 columns, expected 3 (distance D SIGMA)"},
        {"noise zero", "noise_px 0.75", "noise_px 0", 15, "S is '0', expected a positive"},
        {"noise unit", "noise_px 0.75", "noise_px 0.75px", 15, "S is '0.75px'"},
        {"sequence empty", "sequence loop-06", "sequence", 16,
         "1 column, expected 2 (sequence NAME)"},
        {"sequence of two words", "loop-06", "loop 06", 16, "3 columns, expected 2"},
        {"sequence with control", "loop-06", "lo\x1bop", 16, "NAME is 'lo\\x1bop'"},
        {"sequence not UTF-8", "loop-06", "Z\xfcrich", 16,
         "NAME is 'Z\\xfcrich', expected a name in UTF"},
        {"sequence cut UTF-8", "loop-06", "Z\xc3", 16, "a name in UTF-8"},
        {"sequence surrogate", "loop-06", "\xed\xa0\x80", 16, "a name in UTF-8"}}));

INSTANTIATE_TEST_SUITE_P(
    Matches, BrokenMatchFile,
    ::testing::ValuesIn(std::vector<Broken>{
        {"no matches line", std::string(kValid.substr(kValid.find("matches 3"))), "", 17,
         "the file ends without a 'matches' line"},
        {"rows without a matches line", "matches 3\n", "", 18, "unknown keyword '0'"},
        {"matches before format", "format rigmatch 1", "matches 3", 2,
         "no 'format' line before 'matches'"},
        {"matches without N", "matches 3", "matches", 18, "1 column, expected 2 (matches N)"},
        {"matches negative", "matches 3", "matches -3", 18,
         "N is '-3', expected an integer from 0"},
        {"matches not whole", "matches 3", "matches 3.0", 18, "N is '3.0'"},
        {"matches overflow", "matches 3", "matches 99999999999999999999", 18, "N is '999999999"},
        {"matches absurd", "matches 3", "matches 2147483647", 21,
         "ends after 3 rows, expected 2147483647"},
        {"fewer rows", "matches 3", "matches 4", 21, "ends after 3 rows, expected 4"},
        {"more rows", "matches 3", "matches 2", 21, "more rows than 'matches 2' announces"},
        {"rubbish after the rows", "3 4 -1\n", "3 4 -1\nend\n", 22, "more rows than 'matches 3'"},
        {"none announced", "matches 3", "matches 0", 19, "more rows than 'matches 0'"},
        {"matches twice", "matches 3", "matches 3\nmatches 3", 19, "'matches' after 'matches'"},
        {"matches again at the end", "3 4 -1\n", "3 4 -1\nmatches 3\n", 22,
         "'matches' after 'matches'"},
        {"header among the rows", "0 -4.5", "noise_px 1\n0 -4.5", 20, "'noise_px' after 'matches'"},
        {"header after the rows", "3 4 -1\n", "3 4 -1\nnoise_px 1\n", 22,
         "'noise_px' after 'matches'"},
        {"row short", kRow, "0 34.25 103.5 0 11.75 101", 19, kColumns},
        {"row long", kRow, "0 34.25 103.5 0 11.75 101 0.5 1", 19, "8 columns, expected 7"},
        {"row of one column", kRow, "0", 19, "1 column, expected 7"},
        {"row with a comment", kRow, std::string(kRow) + " # good", 19, "9 columns, expected 7"},
        {"truncated last row", "3 4 -1\n", "3", 21, "5 columns, expected 7 (I U V J U2 V2 SCORE)"},
        {"row of a thousand columns", kRow, ReplaceAll(std::string(1000, '1'), "1", "1 "), 19,
         "1000 columns, expected 7"},
        {"U nan", "34.25", "nan", 19, "U is 'nan', expected a finite number"},
        {"V nan(1)", "103.5", "nan(1)", 19, "V is 'nan(1)'"},
        {"U2 infinite", "11.75", "-inf", 19, "U2 is '-inf'"},
        {"V2 too large", " 101 ", " 1e400 ", 19, "V2 is '1e400'"},
        {"SCORE nan", "101 0.5", "101 NaN", 19, "SCORE is 'NaN'"},
        {"SCORE infinite", "101 0.5", "101 INF", 19, "SCORE is 'INF'"},
        {"two signs", "34.25", "+-34.25", 19, "U is '+-34.25'"},
        {"hexadecimal", "34.25", "0x10", 19, "U is '0x10'"},
        {"decimal comma", "34.25", "34,25", 19, "U is '34,25'"},
        {"camera 1 not declared", kRow, "2 34.25 103.5 0 11.75 101 0.5", 19,
         "I is '2', expected a declared camera (0 to 1)"},
        {"camera 2 not declared", "0 11.75", "7 11.75", 19, "J is '7', expected a declared camera"},
        {"camera negative", "0 11.75", "-1 11.75", 19, "J is '-1', expected an integer from 0"},
        {"camera not whole", "0 11.75", "0.5 11.75", 19, "J is '0.5', expected an integer"},
        {"camera overflow", "0 11.75", "4294967296 11.75", 19, "J is '4294967296'"}}));

INSTANTIATE_TEST_SUITE_P(
    Rubbish, BrokenMatchFile,
    ::testing::ValuesIn(std::vector<Broken>{
        {"other text", std::string(kValid), "Dear reader,\n", 1, "'Dear', expected a match file"},
        {"a picture", std::string(kValid), "\x89PNG\r\n\x1a\n", 1,
         "'\\x89PNG', expected a match file"},
        {"NUL in a comment", "a comment", std::string("a\0comment", 9), 1, "a NUL byte"},
        {"NUL in a row", "103.5", std::string("103\0005", 5), 19, "a NUL byte, expected a match"},
        {"control characters", "103.5", "\x01\x07\x7f", 19, "V is '\\x01\\x07\\x7f'"},
        {"vertical tab", "34.25 103.5", "34.25\v103.5", 19, "6 columns, expected 7"},
        {"a very long word", "103.5", std::string(100000, '7') + "x", 19,
         "V is '777777777777777777777777777777...', expected"}}));

TEST(MatchFile, EmptyTextHasNoLine) {
  for (const std::string_view text : {"", "\xef\xbb\xbf"}) {
    FramePair pair;
    std::string error;
    EXPECT_FALSE(ParseMatches(text, "x.matches", &pair, &error));
    EXPECT_EQ(error,
              "x.matches: the file ends without a 'format' line, expected 'format rigmatch 1'");
  }
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ParseMatches(std::string_view(), "x.matches", &pair, &error));
}

TEST(MatchFile, Utf16IsToldApart) {
  std::string text = "\xff\xfe";
  for (const char c : kValid) text += {c, '\0'};
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ParseMatches(text, "x.matches", &pair, &error));
  EXPECT_EQ(error, "x.matches: UTF-16, by its byte order mark, expected a match file (UTF-8 text)");
}

TEST(MatchFile, Utf8SequenceNames) {
  const FramePair pair =
      MustParse(Replace(kValid, "loop-06", "Z\xc3\xbcrich-\xe2\x82\xac-\xf0\x9f\x9a\x97"));
  EXPECT_EQ(pair.sequence, "Z\xc3\xbcrich-\xe2\x82\xac-\xf0\x9f\x9a\x97");
}

TEST(MatchFile, PathDoesNotBreakTheMessage) {
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ParseMatches("rubbish", "a\nb\x1b.matches", &pair, &error));
  EXPECT_TRUE(IsOnePrintableLine(error)) << error;
  EXPECT_FALSE(ReadMatchFile("/nowhere/a\nb", &pair, &error));
  EXPECT_EQ(error, "/nowhere/a\\x0ab: cannot be opened: No such file or directory");
}

// Deterministic: a failure names its round. Cuts, copies and swaps lines, changes, inserts and
// removes bytes, and puts words in where they do not belong.
TEST(MatchFile, MutatedTextsNeverCrash) {
  const std::vector<std::string> words = {
      "nan",     "inf",      "-1",          "0",  "1e999", "2147483648",
      "-0",      "+",        "#",           "\n", "\r\n",  "\t",
      "matches", "camera 2", "format",      "1",  "1.",    std::string(1, '\0'),
      " ",       "\xff",     "\xef\xbb\xbf"};
  constexpr int kRounds = 20000;
  int num_parsed = 0;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE(round);
    Random random = Random::Stream(1, round);
    std::string text(kValid);
    for (int n = 1 + random.Index(4); n > 0; --n) {
      const size_t at = random.Index(static_cast<int>(text.size()) + 1);
      const size_t line_begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
      const size_t line_end = std::min(text.find('\n', at), text.size());
      const std::string line = text.substr(line_begin, line_end - line_begin);
      switch (random.Index(8)) {
        case 0:
          if (at < text.size()) text[at] = static_cast<char>(random.Index(256));
          break;
        case 1:
          text.erase(at, 1 + random.Index(3));
          break;
        case 2:
          text.insert(at, 1, static_cast<char>(random.Index(256)));
          break;
        case 3:
          text.insert(at, words[random.Index(static_cast<int>(words.size()))]);
          break;
        case 4:
          text.erase(line_begin, line.size() + 1);
          break;
        case 5:
          text.insert(line_begin, line + "\n");
          break;
        case 6:  // a line moves
          text.erase(line_begin, line.size() + 1);
          text.insert(std::min(text.find('\n', text.size() / 2), text.size()), "\n" + line);
          break;
        default:
          if (random.Index(4) == 0) text.resize(at);
          if (at < text.size() && text[at] >= '0' && text[at] <= '9') {
            text[at] = static_cast<char>('0' + random.Index(10));
          }
          break;
      }
    }
    // On the heap and of its exact size, so that AddressSanitizer sees a read past the end.
    const std::vector<char> exact(text.begin(), text.end());
    FramePair pair;
    std::string error;
    if (ParseMatches({exact.data(), exact.size()}, "x", &pair, &error)) {
      ++num_parsed;
      ASSERT_TRUE(pair.IsValid(&error)) << error;
      FramePair again;
      ASSERT_TRUE(ParseMatches(FormatMatches(pair), "x", &again, &error)) << error;
    } else {
      ASSERT_EQ(error.rfind("x:", 0), 0u) << error;
      ASSERT_TRUE(IsOnePrintableLine(error)) << error;
      ASSERT_LT(error.size(), 300u) << error;
    }
  }
  // Both outcomes are met often, or the mutations test nothing.
  EXPECT_GT(num_parsed, kRounds / 20);
  EXPECT_LT(num_parsed, kRounds / 2);
}

// Cut anywhere, a file is refused, except inside its very last number.
TEST(MatchFile, TruncationIsSeen) {
  for (size_t size = 0; size < kValid.size() - 2; ++size) {
    FramePair pair;
    std::string error;
    EXPECT_FALSE(ParseMatches(kValid.substr(0, size), "x", &pair, &error)) << size;
  }
}

TEST(MatchFile, UnreadableFilesAreNamed) {
  const TempDir dir;
  FramePair pair;
  std::string error;
  EXPECT_FALSE(ReadMatchFile(dir / "none.matches", &pair, &error));
  EXPECT_EQ(error, dir / "none.matches: cannot be opened: No such file or directory");
  EXPECT_FALSE(ReadMatchFile(dir.path(), &pair, &error));
  EXPECT_EQ(error, dir.path() + ": cannot be read: Is a directory");
  WriteText(dir / "bad.matches", "format rigmatch 1\nhello\n");
  EXPECT_FALSE(ReadMatchFile(dir / "bad.matches", &pair, &error));
  EXPECT_EQ(error.rfind(dir / "bad.matches:2: unknown keyword 'hello'", 0), 0u) << error;
}

}  // namespace
}  // namespace rigel
