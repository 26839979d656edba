// Batches: results that depend neither on threads nor on shards, shards put together again and what
// keeps them from it, and motions of recorded drives.
#include <algorithm>
#include <filesystem>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class ShardsTest : public ToolsTest {
 protected:
  // Runs all shards and returns the list for --merge.
  std::string RunShards(int count, const Args& args, int exit_code = 0) {
    std::string list;
    for (int k = 0; k < count; ++k) {
      const std::string json = Path("shard" + std::to_string(k) + ".json");
      const Outcome run = RunTool(
          "compare", args + Args{"--shard=" + std::to_string(k) + "/" + std::to_string(count),
                                 "--json=" + json});
      EXPECT_EXIT_CODE(run, exit_code);
      list = json + (list.empty() ? "" : ",") + list;  // in any order
    }
    return list;
  }

  // All that a run writes: table, JSON and CSV.
  std::string Outputs(const Args& args, int exit_code = 0) {
    const std::string json = Path("all.json");
    const std::string csv = Path("all.csv");
    const Outcome run = RunTool("compare", args + Args{"--json=" + json, "--csv=" + csv});
    EXPECT_EXIT_CODE(run, exit_code);
    return run.out + ReadText(json) + ReadText(csv);
  }

  void ExpectSame(const Args& args, int count) {
    const std::string whole = Outputs(args + Args{"--no_times"});
    const Args merge = {"--merge=" + RunShards(count, args)};
    EXPECT_EQ(whole, Outputs(merge + Args{"--no_times"}));
    EXPECT_EQ(Outputs(args + Args{"--no_times", "--per_pair"}),
              Outputs(merge + Args{"--no_times", "--per_pair"}));
    EXPECT_EQ(Outputs(Args{"--merge=" + RunShards(count, args + Args{"--no_times"})}), whole);
  }

  void ExpectNotMerged(const std::string& list, const std::string& what) {
    const Outcome run = RunTool("compare", {"--merge=" + list, "--json=-"});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr(what)));
    EXPECT_THAT(run.out, IsEmpty());
  }
};

TEST_F(ShardsTest, MergedTheyAreTheReportOfTheWhole) {
  const std::string matches =
      Simulate("in", {"--pairs=11", "--num_matches=80", "--inter_share=0.5", "--motion=planar",
                      "--outlier_share=0.3", "--rotation_deg=3"});
  // Failures, sequences and a pair whose solver lacks its prior.
  for (const char* file : {"/000001.matches", "/000002.matches", "/000007.matches"}) {
    std::string text = ReadText(matches + file);
    text.replace(text.find("matches 80"), 0, "sequence b\n");
    WriteText(matches + file, text);
  }
  std::string text = ReadText(matches + "/000003.matches");
  text.erase(text.find("axis "), text.find("\n", text.find("axis ")) + 1 - text.find("axis "));
  WriteText(matches + "/000003.matches", text);
  text = text.substr(0, text.find("matches 80")) + "matches 0\n";
  WriteText(matches + "/000009.matches", text);

  const Args args = {"--matches=" + matches, "--prior_noise_deg=0.5", "--prior_noise_axis=random"};
  ExpectSame(args + Args{"--solvers=4pt-axis,3pt-approx", "--by=sequence"}, 4);
  ExpectSame(args + Args{"--solvers=4pt,17pt-li", "--refine=none"}, 2);
  // More shards than files: some are empty.
  ExpectSame(args + Args{"--solvers=4pt", "--use=inter"}, 13);
  // Solvers chosen by the priors: all but one shard would allow the axis.
  ExpectSame(args + Args{"--max_iterations=20"}, 3);
}

TEST_F(ShardsTest, StandingStillHasFiniteNumbersInEveryReport) {
  WriteText(Path("poses/00.txt"),
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0.003\n");
  const std::string matches =
      Simulate("in", {"--poses=" + Path("poses"), "--num_matches=80", "--inter_share=0.5"});
  const Args args = {"--matches=" + matches, "--solvers=4pt-axis"};
  const Outcome run = RunTool("compare", args + Args{"--per_pair", "--json=-"});
  const Json report = ParseReport(run.out);
  EXPECT_EQ(report["results"][0]["failures"], 0);
  EXPECT_EQ(report["results"][0]["direction_pairs"], 0);
  const Json bound = report["results"][0].value("bound", Json::object());
  EXPECT_FALSE(bound.contains("translation_dir_deg") || bound.contains("rig_direction_deg"));
  ExpectSame(args, 2);
}

TEST_F(ShardsTest, TimesAreMergedToo) {
  const std::string matches = Simulate("in", {"--pairs=3", "--num_matches=40"});
  const Args args = {"--matches=" + matches, "--solvers=4pt"};
  const std::string list = RunShards(2, args);
  const Json merged = ParseReport(RunTool("compare", {"--merge=" + list, "--json=-"}).out);
  std::vector<double> ransac;
  for (const char* shard : {"shard0.json", "shard1.json"}) {
    const Json report = ParseReport(ReadText(Path(shard)));
    for (const Json& pair : report["pair_results"]) {
      ransac.push_back(pair["solvers"]["4pt"]["time_ms"]["ransac"]);
    }
  }
  ASSERT_THAT(ransac, SizeIs(3));
  std::sort(ransac.begin(), ransac.end());
  EXPECT_EQ(merged["results"][0]["time_ms"]["ransac"]["median"], ransac[1]);
  // One without: no statistic of the times of some.
  RunTool("compare", args + Args{"--shard=1/2", "--no_times", "--json=" + Path("shard1.json")});
  EXPECT_THAT(RunTool("compare", {"--merge=" + list, "--json=-", "--per_pair"}).out,
              AllOf(HasSubstr("\"time_ms\":"), Not(HasSubstr("\"time_ms\": {"))));
}

TEST_F(ShardsTest, ShardKeepsThePairsAndSaysWhichItIs) {
  const std::string matches = Simulate("in", {"--pairs=5", "--num_matches=40"});
  const Outcome run = RunTool("compare", {"--matches=" + matches, "--solvers=4pt,17pt-li",
                                          "--shard=1/2", "--no_times", "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  const Json report = ParseReport(run.out);
  EXPECT_EQ(report["pairs"], 3);
  EXPECT_EQ(report["shard"], Json({{"index", 1}, {"count", 2}, {"files", 5}}));
  EXPECT_FALSE(report["options"].contains("shard"));
  EXPECT_FALSE(report["options"].contains("no_times"));
  ASSERT_THAT(report["pair_results"], SizeIs(3));
  EXPECT_EQ(report["pair_results"][0]["pair"], matches + "/000002.matches");
  EXPECT_THAT(Keys(report["pair_results"][0]["solvers"]), ElementsAre("17pt-li", "4pt"));
  EXPECT_THAT(Keys(report["pair_results"][0]["solvers"]["4pt"]),
              ElementsAre("bound", "inlier_ratio", "iterations", "nees", "nees_rig_direction",
                          "nees_rotation", "raw", "refined", "status"));
}

TEST_F(ShardsTest, UnreadableFilesAreLeftOutAndFailTheirShardAlone) {
  const std::string matches = Simulate("in", {"--pairs=6", "--num_matches=60"});
  WriteText(matches + "/000002.matches", "rubbish\n");
  WriteText(matches + "/000003.matches", "rubbish\n");
  const Args args = {"--matches=" + matches, "--solvers=4pt-axis", "--no_times",
                     "--prior_noise_deg=1"};
  const std::string whole = Outputs(args, 1);
  std::string list;
  for (int k = 0; k < 3; ++k) {
    const std::string json = Path("shard" + std::to_string(k) + ".json");
    const Outcome run =
        RunTool("compare", args + Args{"--shard=" + std::to_string(k) + "/3", "--json=" + json});
    EXPECT_EXIT_CODE(run, k == 1 ? 1 : 0);
    // The first line says which way is down for --prior_noise_deg.
    EXPECT_THAT(Lines(run.err), SizeIs(k == 1 ? 2 : 1));
    list += (k == 0 ? "" : ",") + json;
  }
  EXPECT_EQ(Outputs({"--merge=" + list}), whole);
  // A whole without any pair is no report, whether it was read in one piece or not.
  for (const char* file : {"0", "1", "4", "5"}) {
    WriteText(matches + "/00000" + file + ".matches", "rubbish\n");
  }
  ExpectNotMerged(RunShards(2, args, 1), "no pair in any of the reports");
}

TEST_F(ShardsTest, WhatDoesNotBelongTogetherIsNotMerged) {
  const std::string matches = Simulate("in", {"--pairs=4", "--num_matches=40"});
  const Args args = {"--matches=" + matches, "--solvers=4pt"};
  RunShards(3, args);
  const auto path = [&](int k) { return Path("shard" + std::to_string(k) + ".json"); };
  ExpectNotMerged(path(0) + "," + path(2), "shard 1/3 is missing: 2 reports of 3");
  ExpectNotMerged(path(0), "shard 1/3 is missing: 1 reports of 3");
  ExpectNotMerged(path(1) + "," + path(0), "shard 2/3 is missing: 2 reports of 3");
  ExpectNotMerged(path(0) + "," + path(1) + "," + path(0), "both are shard 0/3");
  ExpectNotMerged(path(0) + "," + Path("none.json"), "none.json: cannot be opened");

  const auto other = [&](const Args& more) {
    EXPECT_EXIT_CODE(RunTool("compare", args + more + Args{"--json=" + Path("x.json")}), 0);
    return path(0) + "," + path(1) + "," + Path("x.json");
  };
  ExpectNotMerged(other({"--shard=2/3", "--seed=2"}), "other options: seed is '1' and '2'");
  ExpectNotMerged(other({"--shard=2/4"}), "not shards of the same input: 0/3 of 4 files and 2/4");
  ExpectNotMerged(other({"--per_pair"}),
                  "x.json: not a report that can be merged: it is not the "
                  "report of a shard");
  std::filesystem::copy_file(matches + "/000000.matches", matches + "/000004.matches");
  ExpectNotMerged(other({"--shard=2/3"}), "0/3 of 4 files and 2/3 of 5");
}

TEST_F(ShardsTest, BrokenReportIsToldInOneLine) {
  const std::string matches = Simulate("in", {"--pairs=2", "--num_matches=40"});
  RunShards(2, {"--matches=" + matches, "--solvers=4pt"});
  const std::string good = ReadText(Path("shard1.json"));
  const auto changed = [&](const std::string& what, const std::string& to) {
    std::string text = good;
    EXPECT_NE(text.find(what), std::string::npos) << what;
    return text.replace(text.find(what), what.size(), to);
  };
  const std::pair<std::string, std::string> broken[] = {
      {"", "parse error"},
      {"{}", "'format'"},
      {"[1, 2]\n", "cannot use"},
      {"\x01\x02\n\n", "parse error"},
      {good.substr(0, good.size() / 2), "parse error"},
      {changed("rigel-report 1", "rigel-report 2"), "rigel-report 1"},
      {changed("\"pair_results\"", "\"pair_result\""), "'pair_results'"},
      {changed("\"pairs\": 1", "\"pairs\": 2"), "the results of 1 pairs, expected 2"},
      {changed("\"index\": 1", "\"index\": 2"), "not below count"},
      {changed("\"index\": 1", "\"index\": -1"), "expected an integer from 0"},
      {changed("\"index\": 1", "\"index\": 1.5"), "expected an integer"},
      {changed("\"count\": 2", "\"count\": 99999999999"), "expected an integer"},
      {changed("\"status\":\"ok\"", "\"status\":\"fine\""), "no status 'fine'"},
      {changed("},\"inlier_ratio\":", "},\"inlier_ratio\":null,\"x\":"), "must be number"},
      {changed("\"rotation_deg\":", "\"rotation_deg\":1e999,\"x\":"),
       "number overflow parsing '1e999'"},
      {changed("\"solver\": \"4pt\"", "\"solver\": \"5pt\""), "'5pt'"},
  };
  for (const auto& [text, what] : broken) {
    WriteText(Path("shard1.json"), text);
    const Outcome run =
        RunTool("compare", {"--merge=" + Path("shard0.json") + "," + Path("shard1.json")});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err),
                ElementsAre(AllOf(ContainsRegex("shard1\\.json(:[0-9]+)?: not a report that can "
                                                "be merged: "),
                                  HasSubstr(what), Not(HasSubstr("json.exception")))));
    if (what == std::string("number overflow parsing '1e999'")) {
      const size_t lines = std::count(text.begin(), text.begin() + text.find("1e999"), '\n') + 1;
      EXPECT_THAT(run.err, HasSubstr("shard1.json:" + std::to_string(lines) + ": "));
    }
    EXPECT_THAT(run.out, IsEmpty());
  }
}

class ThreadsTest : public ToolsTest {};

TEST_F(ThreadsTest, ReportsAreTheSameBytesForAnyNumberOfThreads) {
  const std::string matches =
      Simulate("in", {"--pairs=12", "--num_matches=100", "--outlier_share=0.3"});
  const auto bytes = [&](const std::string& tool, const Args& args, int threads) {
    const Outcome run =
        RunTool(tool, args + Args{"--matches=" + matches, "--no_times",
                                  "--threads=" + std::to_string(threads),
                                  "--json=" + Path("x.json"), "--csv=" + Path("x.csv")});
    EXPECT_EXIT_CODE(run, 0);
    EXPECT_THAT(ReadText(Path("x.json")), Not(HasSubstr("time_ms")));
    return run.out + ReadText(Path("x.json")) + ReadText(Path("x.csv"));
  };
  const std::pair<std::string, Args> runs[] = {
      {"compare", {"--solvers=4pt-axis,4pt-approx", "--per_pair"}}, {"estimate", {}}};
  for (const auto& [tool, args] : runs) {
    const std::string one = bytes(tool, args, 1);
    for (const int threads : {1, 2, 8}) EXPECT_EQ(one, bytes(tool, args, threads)) << threads;
  }
}

TEST_F(ThreadsTest, ShardsOfEstimatesAreItsParts) {
  const std::string matches = Simulate("in", {"--pairs=5", "--num_matches=60"});
  const Args args = {"--matches=" + matches, "--no_times", "--prior_noise_deg=1"};
  const Json whole = ParseReport(RunTool("estimate", args + Args{"--json=-"}).out)["pairs"];
  Json parts = Json::array();
  for (const char* shard : {"--shard=0/7", "--shard=1/7", "--shard=2/7", "--shard=3/7",
                            "--shard=4/7", "--shard=5/7", "--shard=6/7"}) {
    const Outcome run =
        RunTool("estimate", args + Args{shard, "--down=y", "--forward=z", "--json=-"});
    EXPECT_EXIT_CODE(run, 0);
    EXPECT_THAT(run.err, IsEmpty());
    const Json report = ParseReport(run.out);
    for (const Json& pair : report["pairs"]) parts.push_back(pair);
  }
  EXPECT_EQ(whole, parts);
}

class PosesTest : public ToolsTest {
 protected:
  std::string Bytes(const std::string& directory) {
    std::string bytes;
    std::vector<std::string> errors;
    for (const std::string& path : ListMatchFiles(directory, &errors)) bytes += ReadText(path);
    return bytes;
  }
};

TEST_F(PosesTest, DrivesAreSimulatedOneFileAMotion) {
  std::string drive;
  for (int k = 0; k < 7; ++k) {
    drive += "1 0 0 " + std::to_string(0.1 * k) + " 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
  }
  WriteText(Path("poses/03.txt"), drive);
  WriteText(Path("poses/01.txt"), drive.substr(0, drive.size() / 2 + 2));
  const Args args = {"--poses=" + Path("poses"), "--num_matches=50", "--outlier_share=0.2"};
  const Outcome run = RunTool("simulate", args + Args{"--output=" + Path("out")});
  EXPECT_EXIT_CODE(run, 1);  // 01.txt ends within a line
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("01.txt:4: ")));
  EXPECT_FALSE(std::filesystem::exists(Path("out")));

  WriteText(Path("poses/01.txt"), Lines(drive)[0] + "\n" + Lines(drive)[1] + "\n");
  const std::string bytes = Bytes(Simulate("one", args));
  EXPECT_EQ(bytes, Bytes(Simulate("eight", args + Args{"--threads=8"})));
  std::vector<std::string> errors;
  const std::vector<std::string> paths = ListMatchFiles(Path("one"), &errors);
  ASSERT_THAT(paths, SizeIs(7));
  for (size_t k = 0; k < paths.size(); ++k) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(paths[k], &pair, &error)) << error;
    EXPECT_EQ(pair.sequence, k == 0 ? "01" : "03");
    EXPECT_NEAR((pair.truth->t - Eigen::Vector3d(-0.1, 0, -1)).norm(), 0, 1e-6);
    EXPECT_THAT(pair.matches, SizeIs(50));
  }
  Simulate("thin", args + Args{"--every=3"});
  EXPECT_THAT(ListMatchFiles(Path("thin"), &errors), SizeIs(3));
}

TEST_F(PosesTest, MotionOutOfViewIsToldOnceHoweverManyThreads) {
  std::string drive = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  for (int k = 0; k < 6; ++k) {
    drive += k % 2 == 0 ? "-1 0 0 0 0 1 0 0 0 0 -1 0\n" : "1 0 0 0 0 1 0 0 0 0 1 0\n";
  }
  WriteText(Path("poses/00.txt"), "1 0 0 0 0 1 0 0 0 0 1 0\n" + drive);
  for (const char* threads : {"--threads=1", "--threads=8"}) {
    const Outcome run =
        RunTool("simulate", {"--output=" + Path("out"), "--poses=" + Path("poses"), threads});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(Lines(run.err),
                ElementsAre(AllOf(HasSubstr("000001.matches: "), HasSubstr("hardly any point"))));
  }
}

}  // namespace
}  // namespace rigel
