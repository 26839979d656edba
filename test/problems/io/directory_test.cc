// What is in a directory, and that what cannot be listed is told.
#include "rigel/problems/io/directory.h"

#include <filesystem>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/test/problems/io/match_file_text.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::Pair;

TEST(Directory, ListsFilesAndDirectories) {
  TempDir dir;
  WriteText(dir / "file", "text");
  std::filesystem::create_directory(dir / "folder");
  EXPECT_TRUE(Exists(dir / "file"));
  EXPECT_FALSE(IsDirectory(dir / "file"));
  EXPECT_TRUE(IsDirectory(dir / "folder"));
  EXPECT_FALSE(Exists(dir / "none"));
  std::map<std::string, bool> entries;
  std::string error;
  const auto add = [&](const std::string& name, bool is_directory) {
    entries[name] = is_directory;
  };
  ASSERT_TRUE(ListDirectory(std::filesystem::path(dir / "file").parent_path(), add, &error));
  EXPECT_THAT(entries, ElementsAre(Pair("file", false), Pair("folder", true)));
  EXPECT_FALSE(ListDirectory(dir / "none", add, &error));
  EXPECT_THAT(error, EndsWith("/none: cannot be listed: No such file or directory"));
}

}  // namespace
}  // namespace rigel
