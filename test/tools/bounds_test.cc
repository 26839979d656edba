// rigel_compare as a test of recordings: bounds, a baseline and exit code 3.
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>

#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class BoundsTest : public ToolsTest {
 protected:
  void SetUp() override {
    ToolsTest::SetUp();
    args_ = {"--matches=" + Simulate("in", {"--pairs=4", "--num_matches=40", "--inter_share=0.5"}),
             "--solvers=4pt-axis", "--no_times"};
  }

  Outcome Compare(const Args& more) { return RunTool("compare", args_ + more); }

  Args args_;
};

TEST_F(BoundsTest, MissedOnesAreALineEachAndTheExitCodeIsThree) {
  const Outcome kept = Compare({"--fail_above=refined.rotation_deg.median:1", "--max_failures=0"});
  EXPECT_EXIT_CODE(kept, 0);
  EXPECT_THAT(kept.err, IsEmpty());
  const Outcome missed = Compare(
      {"--fail_above=refined.rotation_deg.median:1e-6,refined.scale.p90:1e-6,3pt/failures:0",
       "--json=" + Path("r.json")});
  EXPECT_EXIT_CODE(missed, 3);
  EXPECT_THAT(Lines(missed.err), ElementsAre(HasSubstr("4pt-axis: refined.rotation_deg.median is "),
                                             HasSubstr("4pt-axis: refined.scale.p90 is "),
                                             HasSubstr("3pt: failures is missing")));
  EXPECT_EQ(missed.out, kept.out) << "the table is there all the same";
  EXPECT_FALSE(ParseReport(ReadText(Path("r.json"))).is_null());
}

TEST_F(BoundsTest, TheReportOfARunIsItsBaseline) {
  const std::string report = Path("report.json");
  EXPECT_EXIT_CODE(Compare({"--json=" + report}), 0);
  EXPECT_EXIT_CODE(Compare({"--baseline=" + report, "--tolerance=0"}), 0);
  // Times are no part of it, and bounds are no options of a report.
  EXPECT_EXIT_CODE(Compare({"--baseline=" + report, "--json=" + Path("again.json")}), 0);
  EXPECT_EQ(ReadText(Path("again.json")), ReadText(report));

  std::string better = ReadText(report);
  const Json entry = ParseReport(better)["results"][0]["refined"]["rotation_deg"];
  const double median = entry["median"];
  const size_t refined = better.find("\"refined\": {\n        \"rotation_deg\"");
  ASSERT_NE(refined, std::string::npos);
  const size_t number = better.find("\"median\": ", refined) + 10;
  better.replace(number, better.find(',', number) - number, std::to_string(0.5 * median));
  WriteText(Path("better.json"), better);
  const Outcome run = Compare({"--baseline=" + Path("better.json"), "--tolerance=0.9"});
  EXPECT_EXIT_CODE(run, 3);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("4pt-axis: refined.rotation_deg.median is ")));
  EXPECT_EXIT_CODE(Compare({"--baseline=" + Path("better.json"), "--tolerance=1.1"}), 0);
}

TEST_F(BoundsTest, HoldForMergedReportsAndOfNoPart) {
  for (const char* k : {"0", "1"}) {
    EXPECT_EXIT_CODE(Compare({std::string("--shard=") + k + "/2", "--json=" + Path(k)}), 0);
  }
  EXPECT_EXIT_CODE(Compare({"--json=" + Path("whole")}), 0);
  const Args merge = {"--merge=" + Path("0") + "," + Path("1"), "--no_times"};
  EXPECT_EXIT_CODE(RunTool("compare", merge + Args{"--baseline=" + Path("whole"), "--tolerance=0"}),
                   0);
  EXPECT_EXIT_CODE(RunTool("compare", merge + Args{"--fail_above=refined.scale.rms:0"}), 3);
  const Outcome part = Compare({"--shard=0/2", "--max_failures=0"});
  EXPECT_EXIT_CODE(part, 2);
  EXPECT_THAT(part.err, HasSubstr("bounds are of the whole"));
}

TEST_F(BoundsTest, FilesThatCannotBeReadAreAFailureWhateverTheBounds) {
  const Outcome no_baseline = Compare({"--baseline=" + Path("nothing.json")});
  EXPECT_EXIT_CODE(no_baseline, 1);
  EXPECT_THAT(no_baseline.err, HasSubstr("nothing.json"));
  WriteText(Path("other.json"), "{}");
  const Outcome no_report = Compare({"--baseline=" + Path("other.json")});
  EXPECT_EXIT_CODE(no_report, 1);
  EXPECT_THAT(Lines(no_report.err), ElementsAre(HasSubstr("not a report of rigel_compare")));
  WriteText(Path("in/000001.matches"), "nonsense\n");
  const Outcome broken = Compare({"--fail_above=refined.rotation_deg.median:1e-6"});
  EXPECT_EXIT_CODE(broken, 1);
  EXPECT_THAT(broken.err, HasSubstr("--fail_above: 4pt-axis"));
}

TEST_F(BoundsTest, WrongValuesAreUsageErrorsBeforeAnyFileIsRead) {
  const Args wrong[] = {{"--fail_above=refined.rotation_deg:1"},
                        {"--fail_above=failures"},
                        {"--fail_above=5pt/failures:1"},
                        {"--max_failures=-2"},
                        {"--tolerance=0.1"},
                        {"--baseline=/nonexistent", "--tolerance=-1"},
                        {"--baseline=/nonexistent", "--tolerance=nan"}};
  for (const Args& args : wrong) {
    const Outcome run = RunTool("compare", Args{"--matches=/nonexistent"} + args);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, Not(HasSubstr("/nonexistent")));
  }
  WriteText(Path("report.json"), "{}");
  const Outcome over =
      Compare({"--baseline=" + Path("report.json"), "--json=" + Path("in/../report.json")});
  EXPECT_EXIT_CODE(over, 2);
  EXPECT_EQ(ReadText(Path("report.json")), "{}");
}

// The commands of docs/regression.md, in their order: lines of code that begin with a program's
// name, each with the exit code that stands behind it.
TEST_F(BoundsTest, TheDocumentationDoesWhatItSays) {
  const fs::path before = fs::current_path();
  fs::current_path(Path("in"));
  std::map<int, int> runs;
  std::string command;
  for (const std::string& line : Lines(ReadText(RIGEL_DOCS_DIR "/regression.md"))) {
    if (command.empty() && line.rfind("    rigel_", 0) != 0) continue;
    command += line;
    if (command.back() == '\\') {
      command.back() = ' ';
      continue;
    }
    int code = 0;
    const size_t comment = command.find("# exit code ");
    if (comment != std::string::npos) {
      code = std::stoi(command.substr(comment + 12));
      command.resize(comment);
    }
    std::istringstream words(command);
    std::string program;
    words >> program;
    Args args{std::istream_iterator<std::string>(words), {}};
    EXPECT_EXIT_CODE(RunTool(program.substr(6), args), code);
    ++runs[code];
    command.clear();
  }
  fs::current_path(before);
  EXPECT_EQ(runs, (std::map<int, int>{{0, 4}, {3, 2}}));
}

}  // namespace
}  // namespace rigel
