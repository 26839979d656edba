// What programs read: stdin, compressed files, names by numbers; and what of it reaches a terminal.
#include <algorithm>
#include <filesystem>

#include "rigel/problems/io/gzip.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class InputTest : public ToolsTest {
 protected:
  void SetUp() override {
    ToolsTest::SetUp();
    in_ = Simulate("in", {"--pairs=1", "--num_matches=40"}) + "/000000.matches";
  }

  std::string in_;
};

TEST_F(InputTest, StdinAndCompressedFilesAreReadAsFilesAre) {
  const Args solver = {"--solver=4pt-axis", "--no_times", "--csv=-"};
  const Outcome plain = RunTool("estimate", Args{"--matches=" + in_} + solver);
  ASSERT_EXIT_CODE(plain, 0);
  const auto motion = [](const Outcome& run) {
    const std::vector<std::string> lines = Lines(run.out);
    return lines.size() == 2 ? lines[1].substr(lines[1].find(',')) : "";
  };
  ASSERT_NE(motion(plain), "");
  WriteText(Path("a.matches.gz"), Gzip(ReadText(in_)));
  EXPECT_EQ(motion(RunTool("estimate", Args{"--matches=" + Path("a.matches.gz")} + solver)),
            motion(plain));
  for (const std::string& file : {in_, Path("a.matches.gz")}) {
    for (const char* threads : {"--threads=1", "--threads=4"}) {
      const Outcome run =
          RunTool("estimate", Args{"--matches=-", threads} + solver, Stdout::kCaptured, {}, file);
      EXPECT_EXIT_CODE(run, 0);
      EXPECT_EQ(motion(run), motion(plain));
      EXPECT_THAT(run.out, HasSubstr("\nstdin,ok,"));
    }
  }
  // One file is of one shard.
  int pairs = 0;
  for (const char* shard : {"--shard=0/2", "--shard=1/2"}) {
    const Outcome run = RunTool("compare", {"--matches=-", "--solvers=4pt-axis", shard, "--json=-"},
                                Stdout::kCaptured, {}, in_);
    pairs += ParseReport(run.out).at("pairs").get<int>();
  }
  EXPECT_EQ(pairs, 1);

  const Outcome rubbish = RunTool("estimate", {"--matches=-"});
  EXPECT_EXIT_CODE(rubbish, 1);
  EXPECT_THAT(rubbish.err, HasSubstr("stdin: the file ends without a 'format' line"));
  const Outcome twice = RunTool("estimate", {"--matches=-,-"});
  EXPECT_EXIT_CODE(twice, 2);
  EXPECT_THAT(twice.err, HasSubstr("stdin can be read only once"));
  for (const std::string& output : {std::string("--in_place"), "--output=" + Path("out")}) {
    const Outcome write = RunTool("calibrate_prior", {"--matches=-", output});
    EXPECT_EXIT_CODE(write, 2);
    EXPECT_THAT(write.err, HasSubstr("stdin cannot be written to"));
  }
}

TEST_F(InputTest, DamagedCompressedFilesCostThemselvesOnly) {
  const std::string whole = Gzip(ReadText(in_));
  WriteText(Path("in/cut.matches.gz"), whole.substr(0, whole.size() / 2));
  const Outcome run = RunTool("estimate", {"--matches=" + Path("in"), "--json=-"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), testing::Contains(Path("in/cut.matches.gz") +
                                                ": cut off: its gzip data ends before its end"));
  EXPECT_EQ(ParseReport(run.out).at("pairs").size(), 1u);
}

TEST_F(InputTest, NamesAreInTheOrderOfTheirNumbersAndThatIsSaidOnce) {
  for (const char* name : {"9.matches", "10.matches", "11.matches"}) {
    fs::copy(in_, Path(std::string("in/") + name));
  }
  const Outcome run = RunTool(
      "estimate", {"--matches=" + Path("in"), "--solver=4pt-axis", "--csv=-", "--threads=2"});
  EXPECT_EXIT_CODE(run, 0);
  const std::vector<std::string> lines = Lines(run.out);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_THAT(lines[2], HasSubstr("/9.matches,"));
  EXPECT_THAT(lines[3], HasSubstr("/10.matches,"));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), lines[1]), 1);
  EXPECT_EQ(run.err.find("in the order of the numbers"), run.err.rfind("in the order of the num"));
  EXPECT_THAT(run.err, HasSubstr("in the order of the numbers"));
}

TEST_F(InputTest, CalibratedCompressedFilesStayCompressed) {
  const std::string clip = Simulate("clip", {"--pairs=12", "--motion=planar", "--rotation_deg=5"});
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(clip)) names.push_back(entry.path().string());
  for (const std::string& name : names) {
    WriteText(name + ".gz", Gzip(ReadText(name)));
    fs::remove(name);
  }
  const Outcome run = RunTool("calibrate_prior", {"--matches=" + clip, "--in_place"});
  ASSERT_EXIT_CODE(run, 0);
  for (const std::string& name : names) EXPECT_TRUE(IsGzip(ReadText(name + ".gz"))) << name;
  EXPECT_EXIT_CODE(RunTool("estimate", {"--matches=" + clip, "--solver=3pt"}), 0);
}

// Whether anything in it would be obeyed by a terminal.
bool HasControl(const std::string& text) {
  for (size_t k = 0; k < text.size(); ++k) {
    const auto c = static_cast<unsigned char>(text[k]);
    if ((c < 0x20 && c != '\n') || c == 0x7f) return true;
    if (c == 0xc2 && k + 1 < text.size() && static_cast<unsigned char>(text[k + 1]) < 0xa0) {
      return true;
    }
  }
  return text.find("\xe2\x80\xae") != std::string::npos;
}

TEST_F(InputTest, NoNameReachesTheTerminalAsACommand) {
  const std::string bad =
      "Z\xc3\xbc\xc2\x9b"
      "2J\xe2\x80\xae";
  std::string text = ReadText(in_);
  const size_t sequence = text.find("\nsequence ");
  if (sequence != std::string::npos) text.erase(sequence, text.find('\n', sequence + 1) - sequence);
  text.insert(text.find("\nmatches ") + 1, "sequence " + bad + "\n");
  fs::create_directories(Path("bad"));
  WriteText(Path("bad/1\x1b[2J" + bad + ".matches"), text);
  WriteText(Path("bad/2" + bad + "\x07.matches"), "format \x1b[2J" + bad);
  for (const Args& args : {Args{}, Args{"--json=-"}, Args{"--csv=-"}}) {
    for (const char* tool : {"estimate", "compare", "calibrate_prior"}) {
      if (tool == std::string("calibrate_prior") && args == Args{"--csv=-"}) continue;
      const Outcome run = RunTool(tool, Args{"--matches=" + Path("bad")} + args);
      EXPECT_EXIT_CODE(run, 1);
      EXPECT_FALSE(HasControl(run.out)) << run.command << "\n" << run.out;
      EXPECT_FALSE(HasControl(run.err)) << run.command << "\n" << run.err;
    }
  }
  const Outcome by = RunTool("compare", {"--matches=" + Path("bad"), "--by=sequence"});
  EXPECT_FALSE(HasControl(by.out)) << by.out;
  EXPECT_THAT(by.out, HasSubstr("Z\xc3\xbc\\xc2\\x9b2J")) << "readable but for that";
  // JSON is read back as it was.
  const Json report =
      ParseReport(RunTool("estimate", {"--matches=" + Path("bad"), "--json=-"}).out);
  EXPECT_EQ(report.at("pairs").at(0).at("sequence"), bad);
}

TEST_F(InputTest, ByteOrderMarksOfReportsAreSkipped) {
  const Outcome run = RunTool("compare", {"--matches=" + in_, "--solvers=4pt-axis", "--shard=0/1",
                                          "--json=" + Path("shard.json")});
  ASSERT_EXIT_CODE(run, 0);
  const std::string text = ReadText(Path("shard.json"));
  WriteText(Path("shard.json"), "\xef\xbb\xbf" + text);
  EXPECT_EXIT_CODE(RunTool("compare", {"--merge=" + Path("shard.json")}), 0);
  WriteText(Path("shard.json"), "\xff\xfe" + text);
  const Outcome wide = RunTool("compare", {"--merge=" + Path("shard.json")});
  EXPECT_EXIT_CODE(wide, 1);
  EXPECT_THAT(wide.err, HasSubstr("shard.json: UTF-16, by its byte order mark"));
}

}  // namespace
}  // namespace rigel
