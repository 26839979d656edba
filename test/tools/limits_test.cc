// Programs to which the system gives less than they want: memory, threads.
#include <sys/stat.h>

#include <filesystem>

#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::StartsWith;

#ifdef RIGEL_SANITIZED
constexpr bool kSanitized = true;  // the programs
#else
constexpr bool kSanitized = false;
#endif
#ifdef RIGEL_LEAK_CHECK
constexpr bool kLeakCheck = true;
#else
constexpr bool kLeakCheck = false;
#endif

class LimitsTest : public ToolsTest {
 protected:
  void SetUp() override {
    ToolsTest::SetUp();
    matches_ = Simulate("in", {"--pairs=6", "--num_matches=60"});
    // Another user has to get there.
    chmod(Path("").c_str(), 0777);
  }

  // As a user who may have no more processes than there are.
  static Outcome RunAlone(const std::string& tool, const Args& args) {
    Limits limits;
    limits.as_nobody = true;
    limits.processes = 1;
    return RunTool(tool, args, Stdout::kCaptured, limits);
  }

  std::string matches_;
};

TEST_F(LimitsTest, AFileThatThereIsNoMemoryForDoesNotStopTheOthers) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer needs more memory than any limit leaves";
  std::string text = ReadText(matches_ + "/000000.matches");
  text.resize(text.find("columns "));
  text += "matches 1000000\n";
  for (int k = 0; k < 1000000; ++k) {
    const std::string u = std::to_string(k % 640), v = std::to_string(k / 640 % 480);
    text += "0 " + u + " " + v + " 0 " + v + " " + u + " 0\n";
  }
  const std::string large = matches_ + "/000002.matches";
  WriteText(large, text);
  Limits limits;
  for (const size_t megabytes : {120, 250}) {
    limits.memory_bytes = megabytes << 20;
    for (const char* threads : {"--threads=1", "--threads=3"}) {
      const Outcome run = RunTool("estimate", {"--matches=" + matches_, "--json=-", threads},
                                  Stdout::kCaptured, limits);
      EXPECT_EXIT_CODE(run, 1);
      EXPECT_THAT(Lines(run.err), Each(HasSubstr("not enough memory")));
      EXPECT_THAT(run.err, HasSubstr(large + ": "));
      const Json report = ParseReport(run.out);
      EXPECT_GE(report["pairs"].size(), threads == std::string("--threads=1") ? 5u : 1u);
    }
  }
}

TEST_F(LimitsTest, FilesOfNoEndAreToldAndNotReadToIt) {
  namespace fs = std::filesystem;
  const std::string sparse = matches_ + "/000001.matches";
  const std::string device = matches_ + "/000003.matches";
  std::error_code no_such_size;
  fs::resize_file(sparse, uintmax_t{10} << 40, no_such_size);  // 10 TiB
  if (no_such_size) fs::resize_file(sparse, uintmax_t{3} << 30);
  fs::remove(device);
  fs::create_symlink("/dev/zero", device);
  for (const char* tool : {"estimate", "compare"}) {
    const Outcome run = RunTool(tool, {"--matches=" + matches_, "--json=-"});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err),
                testing::ElementsAre(
                    testing::AllOf(StartsWith(sparse + ": "), HasSubstr("no more than 2 GiB")),
                    testing::AllOf(StartsWith(device), HasSubstr("a NUL byte"))));
    const Json report = ParseReport(run.out);
    EXPECT_EQ(
        tool == std::string("compare") ? report["pairs"].get<size_t>() : report["pairs"].size(),
        4u);
  }
}

TEST_F(LimitsTest, WithFewerThreadsTheWorkGoesOn) {
  if (kLeakCheck) GTEST_SKIP() << "the leak check starts a process of its own";
  const Args args = {"--matches=" + matches_, "--no_times", "--json=-"};
  const Outcome one = RunTool("estimate", args);
  const Outcome run = RunAlone("estimate", args + Args{"--threads=1024"});
  if (run.exit_code == 126 || run.exit_code == 125) {
    GTEST_SKIP() << "no other user, or not with these programs";
  }
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_EQ(run.out, one.out);
  EXPECT_EXIT_CODE(
      RunAlone("compare", {"--matches=" + matches_, "--solvers=4pt,4pt-axis", "--threads=1024"}),
      0);
  EXPECT_EXIT_CODE(
      RunAlone("simulate", {"--output=" + Path("new"), "--pairs=20", "--threads=1024"}), 0);
}

}  // namespace
}  // namespace rigel
