// Lists of match files from files and directories.
#include "rigel/problems/match_file.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/test/problems/match_file_text.h"

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

TEST(ListMatchFiles, NothingGivesNothing) {
  std::vector<std::string> errors;
  EXPECT_TRUE(ListMatchFiles("", &errors).empty());
  EXPECT_TRUE(ListMatchFiles(",", &errors).empty());
  EXPECT_TRUE(errors.empty());
}

}  // namespace
}  // namespace rigel
