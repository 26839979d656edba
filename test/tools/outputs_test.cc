// What an output may not do: destroy an input, a device, a file's mode, a link, or half a file.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>

#include "rigel/problems/io/match_file.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

class OutputsTest : public ToolsTest {
 protected:
  void SetUp() override {
    ToolsTest::SetUp();
    matches_ = Simulate("in", {"--pairs=2", "--num_matches=40", "--inter_share=0.5"});
    file_ = matches_ + "/000000.matches";
  }

  // Names beginning with `stem` in the directory of the test.
  std::vector<std::string> Named(const std::string& stem) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(Path(""))) {
      const std::string name = entry.path().filename().string();
      if (name.compare(0, stem.size(), stem) == 0) names.push_back(name);
    }
    return names;
  }

  std::string matches_;  // two files
  std::string file_;     // one of them
};

TEST_F(OutputsTest, AnInputIsNoOutputByAnyName) {
  const std::string before = ReadText(file_);
  fs::create_symlink(file_, Path("soft"));
  fs::create_hard_link(file_, Path("hard"));
  fs::create_directory_symlink(matches_, Path("directory"));
  for (const std::string& output :
       {file_, Path("soft"), Path("hard"), matches_ + "/.././in/000000.matches",
        Path("directory/000000.matches")}) {
    for (const char* flag : {"json", "csv", "g2o", "kitti_trajectory", "tum_trajectory"}) {
      const Outcome run =
          RunTool("estimate", {"--matches=" + matches_, "--" + std::string(flag) + "=" + output});
      EXPECT_EXIT_CODE(run, 2);
      EXPECT_THAT(Lines(run.err)[0], AllOf(HasSubstr("--" + std::string(flag) + "=" + output),
                                           HasSubstr("would overwrite the input " + file_)));
      EXPECT_THAT(run.out, IsEmpty());
    }
    for (const char* tool : {"calibrate_prior", "compare"}) {
      EXPECT_EXIT_CODE(RunTool(tool, {"--matches=" + file_, "--json=" + output}), 2);
    }
    EXPECT_EXIT_CODE(RunTool("benchmark", {"--ransac=speed", "--solvers=4pt", "--matches=" + file_,
                                           "--json=" + output}),
                     2);
  }
  // Of another shard, too.
  EXPECT_EXIT_CODE(RunTool("estimate", {"--matches=" + matches_, "--shard=1/2", "--json=" + file_}),
                   2);
  EXPECT_EQ(ReadText(file_), before);
  // As one of several trajectories would be called.
  const std::string two = Simulate("two", {"--pairs=2", "--num_matches=40", "--inter_share=0.5"});
  WriteText(Path("track_1.matches"), ReadText(two + "/000001.matches"));
  const Outcome run = RunTool("estimate", {"--matches=" + file_ + "," + Path("track_1.matches"),
                                           "--kitti_trajectory=" + Path("track.matches")});
  EXPECT_EQ(ReadText(Path("track_1.matches")), ReadText(two + "/000001.matches"))
      << run.command << "\n"
      << run.err;
}

TEST_F(OutputsTest, AMergedReportIsNoOutput) {
  const std::string report = Path("0.json");
  ASSERT_EXIT_CODE(RunTool("compare", {"--matches=" + matches_, "--solvers=4pt-axis", "--shard=0/1",
                                       "--json=" + report}),
                   0);
  const std::string before = ReadText(report);
  const Outcome run = RunTool("compare", {"--merge=" + report, "--csv=" + Path("./0.json")});
  EXPECT_EXIT_CODE(run, 2);
  EXPECT_THAT(run.err, HasSubstr("would overwrite the input " + report));
  EXPECT_EQ(ReadText(report), before);
}

TEST_F(OutputsTest, ADeviceStaysADevice) {
  const std::string null = Path("null"), full = Path("full");
  if (geteuid() != 0 || mknod(null.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0 ||
      mknod(full.c_str(), S_IFCHR | 0666, makedev(1, 7)) != 0) {
    GTEST_SKIP() << "needs root that may make devices";
  }
  fs::create_symlink(null, Path("link"));
  for (const char* flag : {"json", "csv", "g2o", "kitti_trajectory", "tum_trajectory"}) {
    for (const std::string& output : {null, Path("link")}) {
      const Outcome run =
          RunTool("estimate", {"--matches=" + matches_, "--" + std::string(flag) + "=" + output});
      EXPECT_EXIT_CODE(run, 0);
    }
    const Outcome run =
        RunTool("estimate", {"--matches=" + matches_, "--" + std::string(flag) + "=" + full});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err), ElementsAre(StartsWith(full + ": cannot be written: ")));
  }
  EXPECT_EXIT_CODE(RunTool("compare", {"--matches=" + matches_, "--solvers=4pt", "--json=" + null,
                                       "--csv=" + null}),
                   0);
  EXPECT_TRUE(fs::is_character_file(null));
  EXPECT_TRUE(fs::is_character_file(full));
  EXPECT_TRUE(fs::is_symlink(Path("link")));
  EXPECT_THAT(Named("null"), SizeIs(1));
  EXPECT_THAT(Named("full"), SizeIs(1));
}

TEST_F(OutputsTest, LinksAndModesAreKept) {
  WriteText(Path("real.json"), "old");
  ASSERT_EQ(chmod(Path("real.json").c_str(), 0604), 0);
  fs::create_symlink("real.json", Path("link.json"));
  EXPECT_EXIT_CODE(RunTool("estimate", {"--matches=" + file_, "--json=" + Path("link.json")}), 0);
  EXPECT_TRUE(fs::is_symlink(Path("link.json")));
  ParseReport(ReadText(Path("real.json")));
  struct stat status;
  ASSERT_EQ(stat(Path("real.json").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0604u);
}

TEST_F(OutputsTest, StdoutByItsNameIsStdout) {
  const Outcome dash = RunTool("estimate", {"--matches=" + file_, "--no_times", "--json=-"});
  for (const char* name : {"/dev/stdout", "/proc/self/fd/1", "/dev/fd/1"}) {
    const Outcome run =
        RunTool("estimate", {"--matches=" + file_, "--no_times", "--json=" + std::string(name)});
    EXPECT_EXIT_CODE(run, 0);
    EXPECT_EQ(run.out, dash.out);
    EXPECT_EXIT_CODE(
        RunTool("estimate", {"--matches=" + file_, "--csv=-", "--json=" + std::string(name)}), 2);
  }
}

TEST_F(OutputsTest, HalfAFileIsNoneAndAKilledRunsIsRemoved) {
  const std::string json = Path("x.json");
  WriteText(json, "of an earlier run");
  WriteText(json + ".rigel-tmp0", "{\"half");
  // A disk that takes no more than half of it.
  Limits limits;
  limits.file_bytes = 2048;
  const Args args = {"--matches=" + matches_, "--json=" + json};
  const Outcome full = RunTool("compare", args, Stdout::kFullDevice, limits);
  EXPECT_EXIT_CODE(full, 1);
  EXPECT_THAT(Lines(full.err),
              ElementsAre(HasSubstr("stdout: "), StartsWith(json + ": cannot be")));
  EXPECT_EQ(ReadText(json), "of an earlier run");
  EXPECT_THAT(Named("x.json"), ElementsAre("x.json"));
  EXPECT_EXIT_CODE(RunTool("compare", args), 0);
  ParseReport(ReadText(json));
  EXPECT_THAT(Named("x.json"), ElementsAre("x.json"));
}

TEST_F(OutputsTest, OneExperimentADirectory) {
  const Args args = {"--name=outliers", "--quick", "--pairs=1", "--output=" + Path("out"),
                     "--nofigures"};
  fs::create_directory(Path("out"));
  const std::string lock = Path("out/rigel_experiment.lock");
  const int other = open(lock.c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  const Outcome refused = RunTool("experiment", args);
  EXPECT_EXIT_CODE(refused, 1);
  EXPECT_THAT(Lines(refused.err), ElementsAre(lock + ": another run is at work in this directory"));
  EXPECT_FALSE(fs::exists(Path("out/outliers.points.jsonl")));
  close(other);  // as if it had been killed: its file is still there
  WriteText(Path("out/claims.md.rigel-tmp0"), "half");
  EXPECT_EXIT_CODE(RunTool("experiment", args), 0);
  EXPECT_FALSE(fs::exists(lock));
  EXPECT_FALSE(fs::exists(Path("out/claims.md.rigel-tmp0")));
  const std::vector<std::string> lines = Lines(ReadText(Path("out/outliers.points.jsonl")));
  const Json first = Json::parse(lines.front());
  for (const std::string& line : lines) EXPECT_EQ(Json::parse(line)["run"], first["run"]);
  // The page is no other result.
  const Outcome page =
      RunTool("experiment", args + Args{"--overwrite", "--html=" + Path("out/outliers.csv")});
  EXPECT_EXIT_CODE(page, 2);
  EXPECT_THAT(page.err, HasSubstr("writes to this file already"));
}

TEST_F(OutputsTest, AFlagFileNamesNoOther) {
  const Args matches = {"--matches=" + file_};
  WriteText(Path("good"), "# flags\n--solver=4pt\n--no_times\n");
  EXPECT_EXIT_CODE(RunTool("estimate", matches + Args{"--flagfile=" + Path("good")}), 0);
  EXPECT_EXIT_CODE(RunTool("estimate", matches + Args{"--flagfile", Path("good")}), 0);
  const std::string itself = Path("itself");
  WriteText(itself, "--solver=4pt\n  -flagfile=" + itself + "\n");
  WriteText(Path("environment"), "--fromenv=flagfile\n");
  WriteText(Path("large"), std::string((1 << 20) + 1, '#'));
  WriteText(Path("binary"), std::string("--solver=4pt\n\0", 14));
  WriteText(Path("packed"), MatchFileBytes("x.gz", "--solver=4pt\n"));
  const std::pair<Args, std::string> wrong[] = {
      {{"--flagfile=" + itself}, itself + ": line 2: --flagfile is not taken from a flag file"},
      {{"-flagfile", itself}, itself + ": line 2"},
      {{"--flagfile=" + Path("good") + "," + itself}, itself + ": line 2"},
      {{"--flagfile=" + Path("environment")}, "line 1: --fromenv is not taken"},
      {{"--fromenv=solver,flagfile"}, "--fromenv=flagfile: a flag file is only taken"},
      {{"--flagfile=" + Path("large")}, "expected no more than 1048576 bytes"},
      {{"--flagfile=" + Path("packed")}, Path("packed") + ": compressed, expected plain text"},
      {{"--flagfile=" + Path("binary")}, Path("binary") + ": a NUL byte, expected UTF-8 text"},
      {{"--flagfile=/dev/zero"}, "/dev/zero: no regular file, expected one"},
      {{"--flagfile=" + Path("none")}, Path("none") + ": cannot be opened"},
  };
  for (const auto& [args, what] : wrong) {
    const Outcome run = RunTool("estimate", matches + args);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(Lines(run.err), AllOf(SizeIs(2), testing::Contains(HasSubstr(what))));
  }
}

TEST_F(OutputsTest, NestedReportsAreRefusedShortly) {
  for (const int depth : {100, 10000000}) {
    WriteText(Path("deep.json"), "{\"format\": " + std::string(depth, '['));
    const Outcome run = RunTool("compare", {"--merge=" + Path("deep.json")});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("line 1: nested more than 64 deep")));
  }
  // A report of no end, and one that is longer than any.
  const Outcome zero = RunTool("compare", {"--merge=/dev/zero"});
  EXPECT_EXIT_CODE(zero, 1);
  EXPECT_THAT(Lines(zero.err), ElementsAre("/dev/zero:1: a NUL byte, expected UTF-8 text"));
  fs::resize_file(Path("deep.json"), uintmax_t{1} << 40);
  const Outcome longest = RunTool("compare", {"--merge=" + Path("deep.json")});
  EXPECT_EXIT_CODE(longest, 1);
  EXPECT_THAT(
      Lines(longest.err),
      ElementsAre(Path("deep.json") + ": 1099511627776 bytes, expected no more than 1 GiB"));
  const std::string nested = std::string(50, '[') + std::string(50, ']');
  WriteText(Path("deep.json"),
            "{\"format\": \"rigel-report 1\", \"shard\": {\"index\": " + nested + "}}");
  const Outcome run = RunTool("compare", {"--merge=" + Path("deep.json")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("an array, expected an integer")));
}

TEST_F(OutputsTest, AFlagFileIsAnInput) {
  const std::string flags = Path("flags");
  const std::string text = "--matches=" + file_ + "\n--json=" + flags + "\n";
  WriteText(flags, text);
  const Outcome run = RunTool("estimate", {"--flagfile=" + flags});
  EXPECT_EXIT_CODE(run, 2);
  EXPECT_THAT(run.err, HasSubstr("would overwrite the input " + flags));
  EXPECT_EQ(ReadText(flags), text);
}

}  // namespace
}  // namespace rigel
