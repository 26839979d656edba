#include "rigel/problems/io/whole_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/io/run_lock.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class WholeFileTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "/rigel_whole_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(directory_, ignored);
  }

  std::string Path(const std::string& name) const { return directory_ + "/" + name; }

  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  static std::string Read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  static void Put(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  }

  static void Write(const std::string& path, const std::string& text) {
    std::string error;
    EXPECT_TRUE(WriteWholeFile(path, text, &error)) << error;
  }

  std::string directory_;
  std::string error_;
};

mode_t Mode(const std::string& path) {
  struct stat status;
  return stat(path.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
}

TEST_F(WholeFileTest, AFileIsReplacedBehindItsLinksAndKeepsItsMode) {
  fs::create_directory(Path("below"));
  Put(Path("below/real"), "old");
  ASSERT_EQ(chmod(Path("below/real").c_str(), 0640), 0);
  fs::create_symlink("below/real", Path("link"));
  fs::create_symlink("link", Path("link_to_link"));
  Write(Path("link_to_link"), "new");
  EXPECT_EQ(Read(Path("below/real")), "new");
  EXPECT_EQ(Mode(Path("below/real")), 0640u);
  EXPECT_TRUE(fs::is_symlink(Path("link")));
  EXPECT_TRUE(fs::is_symlink(Path("link_to_link")));
  // A link that leads to nothing yet.
  fs::create_symlink("below/not_yet", Path("dangling"));
  Write(Path("dangling"), "text");
  EXPECT_EQ(Read(Path("below/not_yet")), "text");
  EXPECT_TRUE(fs::is_symlink(Path("dangling")));
  EXPECT_THAT(Names(), ElementsAre("below", "dangling", "link", "link_to_link"));
}

TEST_F(WholeFileTest, ANewFileHasTheModeOfTheMask) {
  const mode_t mask = umask(027);
  Write(Path("new"), "text");
  umask(mask);
  EXPECT_EQ(Mode(Path("new")), 0640u);
}

TEST_F(WholeFileTest, AnotherOwnerIsKept) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root";
  Put(Path("of_nobody"), "old");
  ASSERT_EQ(chown(Path("of_nobody").c_str(), 65534, 65534), 0);
  Write(Path("of_nobody"), "new");
  struct stat status;
  ASSERT_EQ(stat(Path("of_nobody").c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, 65534u);
  EXPECT_EQ(status.st_gid, 65534u);
  EXPECT_EQ(Read(Path("of_nobody")), "new");
}

TEST_F(WholeFileTest, AFifoAndADeviceAreWrittenTo) {
  ASSERT_EQ(mkfifo(Path("fifo").c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = Read(Path("fifo")); });
  Write(Path("fifo"), "text");
  reader.join();
  EXPECT_EQ(read, "text");
  EXPECT_TRUE(fs::is_fifo(Path("fifo")));
  fs::create_symlink("/dev/null", Path("null"));
  Write(Path("null"), "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(WriteWholeFile("/dev/full", "text", &error_));
  EXPECT_THAT(error_, HasSubstr("/dev/full: cannot be written: "));
  EXPECT_THAT(Names(), ElementsAre("fifo", "null"));
}

TEST_F(WholeFileTest, AnOpenFileOfTheProcessIsWrittenTo) {
  const int descriptor = open(Path("opened").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_GE(descriptor, 0);
  ASSERT_EQ(write(descriptor, "first ", 6), 6);
  Write("/dev/fd/" + std::to_string(descriptor), "second");
  close(descriptor);
  EXPECT_EQ(Read(Path("opened")), "first second");
  EXPECT_EQ(FollowLinks("/dev/stdout").descriptor, 1);
}

TEST_F(WholeFileTest, WhatCannotBeWrittenSaysWhyAndLeavesNothing) {
  Put(Path("file"), "old");
  EXPECT_FALSE(WriteWholeFile(directory_, "text", &error_));
  EXPECT_EQ(error_, directory_ + ": cannot be written: it is a directory");
  EXPECT_FALSE(WriteWholeFile(Path("no/such/file"), "text", &error_));
  EXPECT_EQ(error_, Path("no/such/file") + ": cannot be written: the directory " + Path("no/such") +
                        " does not exist");
  for (const std::string& path : {directory_, Path("no/such/file"), std::string("/proc/x/y")}) {
    EXPECT_FALSE(CanWriteWholeFile(path, &error_)) << path;
  }
  for (const std::string& path : {Path("file"), Path("other"), std::string("/dev/null")}) {
    EXPECT_TRUE(CanWriteWholeFile(path, &error_)) << error_;
  }
  if (geteuid() != 0) {
    ASSERT_EQ(chmod(Path("file").c_str(), 0400), 0);
    EXPECT_FALSE(WriteWholeFile(Path("file"), "text", &error_));
  }
  EXPECT_EQ(Read(Path("file")), "old");
  EXPECT_THAT(Names(), ElementsAre("file"));
}

TEST_F(WholeFileTest, ALongNameIsNoObstacle) {
  const std::string name(255, 'n');
  Write(Path(name), "text");
  EXPECT_THAT(Names(), ElementsAre(name));
}

TEST_F(WholeFileTest, WhatAKilledRunLeftIsRemovedAndThatOfALivingRunIsNot) {
  Put(Path("file.rigel-tmp0"), "half a te");
  Put(Path("file.rigel-tmp7"), "half a te");
  Put(Path("other.rigel-tmp0"), "half a te");
  Put(Path("file.tmp0"), "a user's");
  const int living = open(Path("file.rigel-tmp3").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(flock(living, LOCK_EX), 0);
  Write(Path("file"), "text");
  EXPECT_THAT(Names(), ElementsAre("file", "file.rigel-tmp3", "file.tmp0", "other.rigel-tmp0"));
  RemoveLeftOvers(directory_, [](const std::string& name) { return name != "other"; });
  EXPECT_THAT(Names(), ElementsAre("file", "file.rigel-tmp3", "file.tmp0", "other.rigel-tmp0"));
  close(living);
  RemoveLeftOvers(directory_, [](const std::string&) { return true; });
  EXPECT_THAT(Names(), ElementsAre("file", "file.tmp0"));
}

TEST_F(WholeFileTest, ManyFilesAreStagedWithFewOpenFiles) {
  constexpr int kFiles = 1200;  // more than the usual limit of 1024
  {
    StagedFiles files;
    for (int k = 0; k < kFiles; ++k) {
      ASSERT_TRUE(files.Add(Path(std::to_string(k)), "text", &error_)) << error_;
    }
    EXPECT_EQ(Names().size(), static_cast<size_t>(kFiles));
    EXPECT_FALSE(fs::exists(Path("0")));
  }
  EXPECT_THAT(Names(), testing::IsEmpty());
}

TEST_F(WholeFileTest, WhatWasWholeTakesItsPlaceLater) {
  Put(Path("file"), "old");
  Put(Path("file.rigel-tmp0"), "whole");
  const auto accept = [](const std::string& path) { return Read(path) == "whole"; };
  EXPECT_FALSE(FinishLeftOver(Path("other"), accept));
  EXPECT_TRUE(FinishLeftOver(Path("file"), accept));
  EXPECT_EQ(Read(Path("file")), "whole");
  Put(Path("file.rigel-tmp0"), "half");
  EXPECT_FALSE(FinishLeftOver(Path("file"), accept));
  EXPECT_EQ(Read(Path("file")), "whole");
}

TEST_F(WholeFileTest, ManyRunsCanWriteOneFile) {
  // Each is one of the texts as a whole, whoever comes last.
  constexpr int kThreads = 4, kTimes = 50;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      const std::string text(1000 * (t + 1), static_cast<char>('a' + t));
      for (int k = 0; k < kTimes; ++k) Write(Path("file"), text);
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::string text = Read(Path("file"));
  EXPECT_EQ(text, std::string(1000 * (text[0] - 'a' + 1), text[0]));
  EXPECT_THAT(Names(), ElementsAre("file"));
}

TEST_F(WholeFileTest, OnePlaceIsOnePlaceByAnySpelling) {
  fs::create_directory(Path("d"));
  Put(Path("d/file"), "text");
  fs::create_directory_symlink("d", Path("link"));
  fs::create_hard_link(Path("d/file"), Path("hard"));
  fs::create_symlink("d/file", Path("soft"));
  const auto same = [&](const std::string& a, const std::string& b) {
    return SamePlace(FollowLinks(a), FollowLinks(b));
  };
  for (const char* name : {"d/file", "d/../d/./file", "link/file", "hard", "soft"}) {
    EXPECT_TRUE(same(Path("d/file"), Path(name))) << name;
  }
  for (const char* name : {"d/new", "d//new", "link/new", "link/../d/new"}) {
    EXPECT_TRUE(same(Path("d/new"), Path(name))) << name;
    EXPECT_FALSE(same(Path("d/file"), Path(name))) << name;
  }
  EXPECT_FALSE(same(Path("d/new"), Path("new")));
  EXPECT_FALSE(same("/dev/null", "/dev/null"));
  EXPECT_TRUE(same("/dev/stdout", "/proc/self/fd/1"));
}

TEST_F(WholeFileTest, OneRunAtATimeHasTheLock) {
  const std::string path = Path("run.lock");
  {
    RunLock first, second;
    EXPECT_TRUE(first.Take(path, &error_)) << error_;
    EXPECT_FALSE(second.Take(path, &error_));
    EXPECT_EQ(error_, path + ": another run is at work in this directory");
  }
  EXPECT_THAT(Names(), testing::IsEmpty());
  Put(path, "of a killed run");
  RunLock third;
  EXPECT_TRUE(third.Take(path, &error_)) << error_;
  RunLock nowhere;
  EXPECT_FALSE(nowhere.Take(Path("no/such/x"), &error_));
  EXPECT_THAT(error_, HasSubstr("cannot be written"));
}

TEST_F(WholeFileTest, ALoopOfLinksStaysOne) {
  fs::create_symlink("b", Path("a"));
  fs::create_symlink("a", Path("b"));
  std::string error;
  EXPECT_FALSE(WriteWholeFile(Path("a"), "text", &error));
  EXPECT_THAT(error, testing::HasSubstr("Too many levels of symbolic links"));
  EXPECT_TRUE(fs::is_symlink(Path("a")));
  EXPECT_THAT(Names(), ElementsAre("a", "b"));
}

}  // namespace
}  // namespace rigel
