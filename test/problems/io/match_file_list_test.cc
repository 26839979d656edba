// Lists of match files from files and directories.
#include "rigel/problems/io/match_file_list.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/problems/io/name_order.h"
#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

TEST(ListMatchFiles, FilesAndDirectoriesInOrder) {
  const TempDir dir;
  fs::create_directories(dir / "d/below.matches");
  fs::create_directories(dir / "empty");
  for (const char* name :
       {"d/b.matches", "d/B.matches", "d/a10.matches", "d/a9.matches", "d/\xc3\xa4.matches",
        "d/a.txt", "d/amatches", "d/a.matches.tmp0", "d/below.matches/x.matches", "other.txt"}) {
    WriteText(dir / name, "");
  }
  const std::vector<std::string> in_d = {dir / "d/B.matches", dir / "d/a10.matches",
                                         dir / "d/a9.matches", dir / "d/b.matches",
                                         dir / "d/\xc3\xa4.matches"};
  std::vector<std::string> errors;
  EXPECT_EQ(ListMatchFiles(dir / "d", &errors), in_d);
  EXPECT_EQ(ListMatchFiles(dir / "d/", &errors), in_d);
  EXPECT_TRUE(errors.empty());

  std::vector<std::string> expected = {dir / "other.txt"};
  expected.insert(expected.end(), in_d.begin(), in_d.end());
  expected.push_back(dir / "d/b.matches");
  const std::string list = (dir / "other.txt") + "," + (dir / "none") + "," + (dir / "d") + ",," +
                           (dir / "empty") + "," + (dir / "d/b.matches");
  EXPECT_EQ(ListMatchFiles(list, &errors), expected);
  EXPECT_EQ(errors,
            (std::vector<std::string>{dir / "none: cannot be opened: No such file or directory",
                                      dir / "empty: no .matches files in this directory"}));
}

TEST(ListMatchFiles, NumbersAscendAndThatIsSaid) {
  const TempDir dir;
  fs::create_directories(dir / "d");
  fs::create_directories(dir / "e");
  const std::vector<std::string> in_order = {"9-10.matches", "10-9.matches", "10-11.matches.gz",
                                             "100-1.matches"};
  std::vector<std::string> paths;
  for (const std::string& name : in_order) {
    WriteText(dir / ("d/" + name), "");
    paths.push_back(dir / ("d/" + name));
  }
  std::vector<std::string> errors, notes;
  EXPECT_EQ(ListMatchFiles(dir / "d", &errors, &notes), paths);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("in the order of the numbers in their names"), std::string::npos);
  // Once for all directories, and not at all where byte order is the same or a name has no number.
  for (const char* name : {"e/000009.matches", "e/000010.matches"}) WriteText(dir / name, "");
  notes.clear();
  ListMatchFiles((dir / "e") + "," + (dir / "d") + "," + (dir / "d"), &errors, &notes);
  EXPECT_EQ(notes.size(), 1u);
  WriteText(dir / "d/x.matches", "");
  notes.clear();
  EXPECT_EQ(ListMatchFiles(dir / "d", &errors, &notes)[0], dir / "d/10-11.matches.gz");
  EXPECT_TRUE(notes.empty());
  EXPECT_TRUE(errors.empty());
}

TEST(ListMatchFiles, DecimalsAreNoNumbersOfTheirOwn) {
  std::vector<std::string> names = {"9.5", "10.25", "10.3"};
  EXPECT_TRUE(SortByNumbers(&names));
  EXPECT_EQ(names, (std::vector<std::string>{"9.5", "10.25", "10.3"}));
  EXPECT_FALSE(ComesBeforeByNumbers("1.5", "1.25"));
  // Of equal numbers one comes first, whatever the order they come in.
  EXPECT_NE(ComesBeforeByNumbers("1", "01"), ComesBeforeByNumbers("01", "1"));
  EXPECT_FALSE(ComesBeforeByNumbers("7a", "7a"));
}

TEST(ListMatchFiles, StdinOnceAndOneOfAFileAndItsCompressedLike) {
  const TempDir dir;
  WriteText(dir / "a.matches", "");
  WriteText(dir / "a.matches.gz", "");
  WriteText(dir / "b.matches.gz", "");
  std::vector<std::string> errors;
  EXPECT_EQ(ListMatchFiles("-," + (dir / "") + ",-", &errors),
            (std::vector<std::string>{"-", dir / "a.matches", dir / "b.matches.gz"}));
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_NE(errors[0].find("a.matches.gz: left out, a.matches is there too"), std::string::npos);
  EXPECT_EQ(errors[1], "-: named twice, expected once: stdin can be read but once");
}

TEST(ListMatchFiles, NothingGivesNothing) {
  std::vector<std::string> errors;
  EXPECT_TRUE(ListMatchFiles("", &errors).empty());
  EXPECT_TRUE(ListMatchFiles(",", &errors).empty());
  EXPECT_TRUE(errors.empty());
}

}  // namespace
}  // namespace rigel
