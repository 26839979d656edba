// rigel_compare: its report (DESIGN.md, section 9), its options, and what fails a run.
#include <algorithm>
#include <sstream>

#include "rigel/test/tools/compare_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::UnorderedElementsAre;

void ExpectStatistics(const Json& entry, const Args& wanted) {
  EXPECT_THAT(Keys(entry), testing::UnorderedElementsAreArray(wanted));
  for (const auto& [name, s] : entry.items()) {
    EXPECT_THAT(Keys(s), UnorderedElementsAre("median", "mean", "rms", "p90")) << name;
    EXPECT_GE(s["median"], 0.0) << name;
    EXPECT_GE(s["rms"].get<double>() * (1 + 1e-12), s["mean"].get<double>()) << name;
    EXPECT_GE(s["p90"], s["median"]) << name;
  }
}

TEST_F(CompareTest, JsonHasTheStructureOfTheFormat) {
  const std::string matches =
      Simulate("in", {"--pairs=6", "--inter_share=0.5", "--outlier_share=0.2", "--motion=planar"});
  const Json report = Compare({"--matches=" + matches});
  EXPECT_THAT(Keys(report),
              UnorderedElementsAre("format", "rigel_version", "pairs", "options", "results"));
  EXPECT_EQ(report["format"], "rigel-report 1");
  EXPECT_EQ(report["pairs"], 6);
  EXPECT_TRUE(report["options"].is_object());
  std::vector<std::string> solvers;
  for (const Json& entry : report["results"]) {
    solvers.push_back(entry["solver"]);
    EXPECT_EQ(entry["sequence"], "all");
    EXPECT_EQ(entry["pairs"], 6);
    const int failures = entry["failures"];
    if (failures == 6) continue;  // a baseline that does not fit this motion
    EXPECT_THAT(Keys(entry), UnorderedElementsAre("solver", "sequence", "pairs", "failures",
                                                  "direction_pairs", "raw", "refined", "bound",
                                                  "nees", "nees_rotation", "nees_rig_direction",
                                                  "inlier_ratio", "iterations", "time_ms"));
    ExpectStatistics(entry["raw"], {"rotation_deg", "translation_dir_deg", "scale"});
    ExpectStatistics(entry["refined"],
                     {"rotation_deg", "translation_dir_deg", "scale", "rig_direction_deg"});
    ExpectStatistics(entry["bound"], {"rotation_deg", "translation_dir_deg", "rig_direction_deg"});
    ExpectStatistics(entry["time_ms"], {"ransac", "refine"});
    ExpectStatistics({{"inlier_ratio", entry["inlier_ratio"]}, {"iterations", entry["iterations"]}},
                     {"inlier_ratio", "iterations"});
    EXPECT_LE(entry["direction_pairs"], 6 - failures) << entry["solver"];
    EXPECT_LE(entry["inlier_ratio"]["p90"], 1.0);
  }
  // All solvers that the priors of the files allow, each once.
  for (const char* solver :
       {"4pt-approx", "4pt-axis-approx", "3pt-approx", "4pt-approx-polished",
        "4pt-axis-approx-polished", "3pt-approx-polished", "4pt", "4pt-axis", "3pt"}) {
    EXPECT_EQ(std::count(solvers.begin(), solvers.end(), solver), 1) << solver;
  }
}

TEST_F(CompareTest, OwnSolversReachTheBound) {
  const std::string matches =
      Simulate("in", {"--pairs=20", "--inter_share=0.5", "--outlier_share=0.2", "--motion=planar",
                      "--noise_px=0.1"});
  const Json report =
      Compare({"--matches=" + matches,
               "--solvers=4pt-approx,4pt-axis-approx-polished,4pt,4pt-axis,3pt-approx,3pt"});
  ASSERT_EQ(report["results"].size(), 6u);
  for (const Json& entry : report["results"]) {
    EXPECT_EQ(entry["failures"], 0) << entry["solver"];
    for (const char* quantity : {"rotation_deg", "translation_dir_deg", "rig_direction_deg"}) {
      EXPECT_LT(entry["refined"][quantity]["rms"],
                1.5 * entry["bound"][quantity]["rms"].get<double>())
          << entry["solver"] << " " << quantity;
    }
  }
}

TEST_F(CompareTest, WithoutRefinementThereIsNothingRefined) {
  const std::string matches = Simulate("in", {"--pairs=3", "--inter_share=0.5"});
  const Json entry = Entry({"--matches=" + matches, "--solvers=4pt", "--refine=none"});
  EXPECT_FALSE(entry.contains("refined"));
  EXPECT_FALSE(entry.contains("bound"));
  EXPECT_TRUE(entry.contains("raw"));
  EXPECT_EQ(entry["failures"], 0);
  EXPECT_TRUE(entry["raw"].contains("scale"));
  // Matches within the cameras do not say whether they determine it.
  const Json intra =
      Entry({"--matches=" + matches, "--solvers=4pt", "--refine=none", "--use=intra"});
  EXPECT_FALSE(intra["raw"].contains("scale"));
  EXPECT_TRUE(intra["raw"].contains("translation_dir_deg"));
}

TEST_F(CompareTest, ScaleThatIsNotObservableIsLeftOut) {
  const std::string matches = Simulate("in", {"--pairs=6", "--num_matches=100"});
  const Json entry = Entry({"--matches=" + matches, "--solvers=4pt-axis"});
  EXPECT_FALSE(entry["raw"].contains("scale"));
  EXPECT_FALSE(entry["refined"].contains("scale"));
  EXPECT_EQ(entry["direction_pairs"], 6);
}

TEST_F(CompareTest, NoBoundWhereTheNoiseIsNotStated) {
  const std::string matches = Simulate("in", {"--pairs=3", "--inter_share=0.5"});
  EXPECT_TRUE(Entry({"--matches=" + matches, "--solvers=4pt"}).contains("bound"));
  RemoveLine(matches + "/000001.matches", "noise_px");
  EXPECT_FALSE(Entry({"--matches=" + matches, "--solvers=4pt"}).contains("bound"));
}

TEST_F(CompareTest, BySequenceAddsAnEntryForEachSequence) {
  const std::string matches = Simulate("in", {"--pairs=5", "--inter_share=0.5"});
  AddLine(matches + "/000000.matches", "sequence b");
  AddLine(matches + "/000002.matches", "sequence b");
  AddLine(matches + "/000003.matches", "sequence a");  // two files have none
  const Args args = {"--matches=" + matches, "--solvers=4pt,4pt-axis"};
  EXPECT_EQ(Compare(args)["results"].size(), 2u);
  const Json report = Compare(args + Args{"--by=sequence"});
  std::vector<std::string> entries;
  for (const Json& entry : report["results"]) {
    entries.push_back(entry["solver"].get<std::string>() + " " +
                      entry["sequence"].get<std::string>() + " " + entry["pairs"].dump());
  }
  EXPECT_THAT(entries, UnorderedElementsAre("4pt all 5", "4pt a 1", "4pt b 2", "4pt-axis all 5",
                                            "4pt-axis a 1", "4pt-axis b 2"));
  const Outcome table = RunTool("compare", args + Args{"--by=sequence"});
  EXPECT_THAT(table.out, AllOf(HasSubstr("all pairs, 5 of them"), HasSubstr("time [ms], mean"),
                               HasSubstr("\nrotation error [deg], median\n"),
                               HasSubstr("\ntranslation direction error [deg], median\n")));
  int rows = 0;
  for (const std::string& line : Lines(table.out)) {
    rows += line.substr(0, 2) == "a " ? 1 : 0;
  }
  EXPECT_EQ(rows, 3) << table.out;
  // None of them is a sequence or a solver of the paper.
  EXPECT_THAT(table.out, Not(HasSubstr("paper")));
  const Outcome no_times = RunTool("compare", args + Args{"--by=sequence", "--no_times"});
  EXPECT_THAT(no_times.out, Not(HasSubstr("time [ms], mean")));
  EXPECT_THAT(table.err, IsEmpty());
  EXPECT_EXIT_CODE(RunTool("compare", args + Args{"--by=camera"}), 2);
}

TEST_F(CompareTest, BySequenceSaysThatNoFileNamesOne) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=40"});
  const Outcome run =
      RunTool("compare", {"--matches=" + matches, "--solvers=4pt", "--by=sequence"});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("no file names a sequence")));
  EXPECT_THAT(run.out, StartsWith("one pair\n"));
}

TEST_F(CompareTest, CsvAgreesWithTheJson) {
  const std::string matches = Simulate("in", {"--pairs=5", "--inter_share=0.5"});
  const Outcome run = RunTool("compare", {"--matches=" + matches, "--solvers=4pt,4pt-axis",
                                          "--csv=-", "--json=" + Path("report.json")});
  ASSERT_EXIT_CODE(run, 0);
  const std::vector<std::string> lines = Lines(run.out);
  ASSERT_EQ(lines.size(), 11u);
  const auto cells = [](const std::string& line) {
    std::vector<std::string> result;
    std::istringstream stream(line + ",");
    for (std::string cell; std::getline(stream, cell, ',');) result.push_back(cell);
    return result;
  };
  const std::vector<std::string> header = cells(lines[0]);
  const auto column = [&](const std::string& name) {
    return std::find(header.begin(), header.end(), name) - header.begin();
  };
  const Json report = ParseReport(ReadText(Path("report.json")));
  for (const Json& entry : report["results"]) {
    for (const std::string stage : {"raw", "refined"}) {
      for (const std::string quantity : {"rotation_deg", "translation_dir_deg", "scale"}) {
        std::vector<double> values;
        for (size_t k = 1; k < lines.size(); ++k) {
          const std::vector<std::string> row = cells(lines[k]);
          ASSERT_EQ(row.size(), header.size()) << lines[k];
          if (row[column("solver")] != entry["solver"]) continue;
          values.push_back(std::stod(row[column(stage + "_" + quantity)]));
        }
        ASSERT_EQ(values.size(), 5u);
        std::sort(values.begin(), values.end());
        EXPECT_NEAR(entry[stage][quantity]["median"], values[2], 1e-12);
      }
    }
  }
}

TEST_F(CompareTest, TablesFitIntoAHundredColumns) {
  const std::string matches = Simulate("in", {"--pairs=4", "--inter_share=0.5", "--motion=planar"});
  AddLine(matches + "/000000.matches", "sequence " + std::string(150, 'x'));
  // Wrong priors and little to go by: errors of tens of degrees, scales of thousands of percent.
  const std::string noise = Simulate("noise", {"--pairs=4", "--inter_share=1", "--outlier_share=1",
                                               "--num_matches=25", "--motion=planar"});
  for (const Args& more : std::vector<Args>{{},
                                            {"--by=sequence"},
                                            {"--refine=none", "--matches=" + noise},
                                            {"--matches=" + noise},
                                            {"--refine=none", "--prior_noise_deg=60"}}) {
    // Few iterations: the baselines with 6 degrees of freedom are slow, the numbers do not matter.
    const Outcome run =
        RunTool("compare", Args{"--matches=" + matches, "--max_iterations=50"} + more);
    // Outliers alone have no motion.
    const bool outliers = !more.empty() && more.back() == "--matches=" + noise;
    EXPECT_EXIT_CODE(run, outliers ? 1 : 0);
    EXPECT_LE(Width(run.out), 100u) << run.out;
    EXPECT_THAT(run.out, HasSubstr("4pt-axis-approx-polished"));
    EXPECT_THAT(run.out, Not(HasSubstr("nan")));
  }
}

TEST_F(CompareTest, ResultsDoNotDependOnThreadsAndRuns) {
  const std::string matches =
      Simulate("in", {"--pairs=8", "--inter_share=0.3", "--outlier_share=0.4"});
  const Args args = {"--matches=" + matches, "--solvers=4pt-axis,4pt-approx",
                     "--prior_noise_deg=0.5", "--prior_noise_axis=random"};
  const Json one = WithoutTimes(Compare(args + Args{"--threads=1"}));
  EXPECT_EQ(one, WithoutTimes(Compare(args + Args{"--threads=1"})));
  EXPECT_EQ(one, WithoutTimes(Compare(args + Args{"--threads=4"})));
  EXPECT_NE(one["results"], WithoutTimes(Compare(args + Args{"--seed=2"}))["results"]);
}

TEST_F(CompareTest, DashWritesOnlyTheReportToStdout) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=40"});
  const Args args = {"--matches=" + matches, "--solvers=4pt"};
  const Outcome json = RunTool("compare", args + Args{"--json=-"});
  EXPECT_THAT(json.out, StartsWith("{"));
  EXPECT_THAT(json.err, IsEmpty());  // progress is for terminals
  const Outcome csv = RunTool("compare", args + Args{"--csv=-"});
  EXPECT_THAT(csv.out, StartsWith("pair,"));
  EXPECT_THAT(Lines(csv.out), SizeIs(2));
}

TEST_F(CompareTest, FileWithoutTruthFailsTheRunAndTheOthersAreReported) {
  const std::string matches = Simulate("in", {"--pairs=3", "--num_matches=40"});
  RemoveLine(matches + "/000001.matches", "truth");
  const Outcome run = RunTool("compare", {"--matches=" + matches, "--solvers=4pt", "--json=-"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("000001.matches: has no truth line")));
  const Json report = ParseReport(run.out);
  EXPECT_EQ(report["pairs"], 2);
  EXPECT_EQ(report["results"][0]["pairs"], 2);
  EXPECT_EQ(report["results"][0]["failures"], 0);

  RemoveLine(matches + "/000000.matches", "truth");
  RemoveLine(matches + "/000002.matches", "truth");
  const Outcome none = RunTool("compare", {"--matches=" + matches, "--json=-"});
  EXPECT_EXIT_CODE(none, 1);
  EXPECT_THAT(none.out, IsEmpty());
  EXPECT_THAT(Lines(none.err), ElementsAre(AllOf(HasSubstr("000000.matches: has no truth line"),
                                                 HasSubstr("(3 files alike)"))));
}

TEST_F(CompareTest, DegenerateFilesCountAsFailures) {
  const std::string matches = Simulate("in", {"--pairs=3", "--inter_share=0.5"});
  const std::string text = ReadText(matches + "/000000.matches");
  const std::string header = text.substr(0, text.find("\ncolumns") + 1);
  std::string same = header + "matches 50\n";
  for (int k = 0; k < 50; ++k) same += "0 100 100 0 110 101 0\n";
  WriteText(matches + "/same.matches", same);
  WriteText(matches + "/none.matches", header + "matches 0\n");
  WriteText(matches + "/three.matches",
            header + "matches 3\n0 1 2 0 3 4 0\n1 5 6 1 7 8 0\n0 9 9 0 9 8 0\n");
  const Outcome run =
      RunTool("compare", {"--matches=" + matches, "--solvers=4pt-axis", "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("(3 files alike but for the numbers)")));
  const Json entry = ParseReport(run.out)["results"][0];
  EXPECT_EQ(entry["pairs"], 6);
  EXPECT_EQ(entry["failures"], 3);
  EXPECT_LT(entry["refined"]["rotation_deg"]["p90"], 0.5);
}

TEST_F(CompareTest, UseSelectsTheMatches) {
  const std::string matches =
      Simulate("in", {"--pairs=4", "--inter_share=0.5", "--num_matches=100"});
  const Args args = {"--matches=" + matches, "--solvers=4pt-axis"};
  const Json intra = Entry(args + Args{"--use=intra"});
  const Json inter = Entry(args + Args{"--use=inter"});
  EXPECT_FALSE(intra["refined"].contains("scale"));
  EXPECT_LT(inter["refined"]["scale"]["median"], 0.05);
  // Nothing left: an answer for each pair, and no motion at all.
  const std::string only_intra = Simulate("intra", {"--pairs=2"});
  const Outcome none =
      RunTool("compare", {"--matches=" + only_intra, "--solvers=4pt", "--use=inter", "--json=-"});
  EXPECT_EXIT_CODE(none, 1);
  EXPECT_EQ(ParseReport(none.out)["results"][0]["failures"], 2);
}

// With free scale it would collapse on intra-camera matches (test/refine); |t| is kept there, so
// that it is merely worse.
TEST_F(CompareTest, AlgebraicResidualIsForComparison) {
  const std::string matches = Simulate("in", {"--pairs=40", "--num_matches=100"});
  const Args args = {"--matches=" + matches, "--solvers=4pt-axis"};
  const Json sampson = Entry(args);
  const Json algebraic = Entry(args + Args{"--residual=algebraic"});
  EXPECT_EQ(algebraic["failures"], 0);
  EXPECT_EQ(algebraic["raw"], sampson["raw"]);
  EXPECT_GT(algebraic["refined"]["rotation_deg"]["rms"], sampson["refined"]["rotation_deg"]["rms"]);
}

TEST_F(CompareTest, SolversThatAreUnknownOrNamedTwiceAreUsageErrors) {
  for (const auto& [solvers, what] : std::vector<std::pair<std::string, std::string>>{
           {"4pt,5pt", "'5pt'"}, {"4PT", "'4PT'"}, {"4pt,4pt", "'4pt' is named twice"}}) {
    const Outcome run =
        RunTool("compare", {"--matches=/proc/nonexistent/of/rigel", "--solvers=" + solvers});
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, AllOf(HasSubstr(what), Not(HasSubstr("/nonexistent"))));
  }
  const Outcome run = RunTool("compare", {"--matches=x", "--solvers=?"});
  EXPECT_THAT(run.err, HasSubstr("4pt-axis-approx-polished"));
}

}  // namespace
}  // namespace rigel
