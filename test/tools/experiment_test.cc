// rigel_experiment: results, resumed runs, claims and what fails a run.
#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "rigel/problems/experiments/experiment.h"
#include "rigel/test/tools/experiment_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

const char* const kFiles[] = {"outliers.json", "outliers.csv", "outliers.txt",
                              "claims.md",     "claims.json",  "outliers.points.jsonl"};

TEST_F(ExperimentTest, ListsAndRefusesNames) {
  const Outcome list = RunTool("experiment", {"--list"});
  EXPECT_EXIT_CODE(list, 0);
  for (const char* name :
       {"image-noise", "pitch-noise", "roll-noise", "planar-image-noise", "planar-vibration",
        "rotation-angle", "outliers", "match-count", "inter-share", "kitti-motions"}) {
    EXPECT_THAT(list.out, HasSubstr(name));
  }
  EXPECT_LE(Width(list.out), 100u);

  const std::string out = "--output=" + Path("none");
  const std::vector<std::pair<Args, const char*>> wrong = {
      {{out}, "--name is missing"},
      {{"--name=all"}, "--output is missing"},
      {{"--name=nonsense", out}, "'nonsense'; expected all or some of image-noise, pitch-noise"},
      {{"--name=outliers,outliers", out}, "named twice"},
      {{"--name=kitti-motions", out}, "needs --poses"},
      {{"--name=outliers", out, "--pairs=-1"}, "--pairs"},
      {{"--name=outliers", out, "--threads=-1"}, "--threads"},
      {{"--name=outliers", out, "--resume", "--overwrite"}, "contradict"},
      {{"--name=kitti-motions", out, "--poses=a", "--kitti_root=b"}, "give one of them"}};
  for (const auto& [args, message] : wrong) {
    const Outcome run = RunTool("experiment", args);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, HasSubstr(message));
  }
  EXPECT_FALSE(fs::exists(Path("none")));
}

TEST_F(ExperimentTest, WritesItsResults) {
  const Outcome run = Experiment(kSmall + Args{"--output=" + Path("a")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_LE(Width(run.out), 100u) << run.out;
  EXPECT_THAT(run.out, AllOf(HasSubstr("outliers: "), HasSubstr("4pt-axis"), HasSubstr("bound")));
  const Json report = ParseReport(ReadText(Path("a/outliers.json")));
  EXPECT_EQ(report["format"], "rigel-experiment 1");
  EXPECT_EQ(report["experiment"], "outliers");
  EXPECT_EQ(report["options"]["pairs"], 2);
  EXPECT_EQ(report["x"]["name"], "outlier_percent");
  // 5 points, 6 solvers, 2 loops.
  EXPECT_EQ(report["results"].size(), 60u);
  for (const Json& row : report["results"]) {
    EXPECT_EQ(row["pairs"], 2);
    EXPECT_TRUE(row["loop"] == "paper" || row["loop"] == "rigel");
    EXPECT_FALSE(row.contains("time_ms"));
    if (row["failures"] == 0) {
      for (const char* stage : {"raw", "refined"}) {
        EXPECT_THAT(Keys(row[stage]["rotation_deg"]),
                    testing::UnorderedElementsAre("median", "mean", "rms", "p90"));
      }
    }
  }
  const std::vector<std::string> csv = Lines(ReadText(Path("a/outliers.csv")));
  EXPECT_EQ(csv.size(), 61u);
  const auto commas = std::count(csv[0].begin(), csv[0].end(), ',');
  for (const std::string& line : csv) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), commas) << line;
  }
}

TEST_F(ExperimentTest, AnyNumberOfThreadsAndAnInterruptionChangeNoByte) {
  const Args args = kSmall + Args{"--output=" + Path("whole"), "--threads=1"};
  ASSERT_EXIT_CODE(Experiment(args), 0);
  const std::string points = ReadText(Path("whole/outliers.points.jsonl"));
  const size_t third = points.find('\n', points.find('\n', points.find('\n') + 1) + 1);
  // Ended within the third point; after all of them, before the report; before any.
  for (const size_t size : {third + 100, points.size(), size_t{0}}) {
    const std::string directory = Path("part" + std::to_string(size));
    fs::create_directories(directory);
    WriteText(directory + "/outliers.points.jsonl", points.substr(0, size));
    const Outcome run =
        Experiment(kSmall + Args{"--output=" + directory, "--threads=3", "--resume"});
    ASSERT_EXIT_CODE(run, 0);
    for (const char* file : kFiles) {
      EXPECT_EQ(ReadText(directory + "/" + file), ReadText(Path("whole/") + file)) << file;
    }
  }
}

TEST_F(ExperimentTest, ClaimsAreOfAllResultsInTheDirectory) {
  const std::string out = "--output=" + Path("a");
  ASSERT_EXIT_CODE(Experiment({"--name=inter-share", "--quick", "--pairs=2", "--no_times", out}),
                   0);
  EXPECT_THAT(ReadText(Path("a/claims.md")), Not(HasSubstr("kitti-motions")));
  WriteText(Path("a/outliers.json"), "[]");
  const Outcome run =
      Experiment({"--name=rotation-angle", "--quick", "--pairs=3", "--no_times", out});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("outliers.json: not among the claims"));
  const std::string claims = ReadText(Path("a/claims.md"));
  EXPECT_THAT(
      claims,
      AllOf(HasSubstr("| inter-share |"), HasSubstr("| rotation-angle |"),
            HasSubstr("`inter-share`: 2 pairs a point, the coarse grid of --quick, seed 1"),
            HasSubstr("`rotation-angle`: 3 pairs a point"), Not(HasSubstr("kitti-motions"))));
  EXPECT_THAT(ReadText(Path("a/claims.json")), HasSubstr("inter-share"));
  // Read from the file it says what it said before.
  ASSERT_EXIT_CODE(
      Experiment({"--name=inter-share", "--quick", "--pairs=2", "--no_times", out, "--resume"}), 0);
  EXPECT_EQ(ReadText(Path("a/claims.md")), claims);
}

// What the list of claims takes for granted of the experiments.
TEST_F(ExperimentTest, TheClaimsAreOfTheCatalogue) {
  const Json list = Json::parse(ReadText(std::string(RIGEL_PROGRAMS) + "/rigel_claims.json"));
  EXPECT_EQ(list["experiments"].size(), ExperimentCatalogue().size());
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    ASSERT_TRUE(list["experiments"].contains(spec.name)) << spec.name;
    EXPECT_EQ(list["experiments"][spec.name].is_null(), spec.values.empty()) << spec.name;
  }
  for (const Json& claim : list["claims"]) {
    const std::string name = claim.value("experiment", "pitch-noise");
    const ExperimentSpec& spec = *FindExperiment(name);
    const auto expect_solvers = [&](Json names) {
      if (names.is_object()) names = names.begin().value();
      if (names.is_number() || names == "all") return;
      if (names.is_string() && list["groups"].contains(names)) names = list["groups"][names];
      if (names.is_string()) names = Json::array({names});
      for (const Json& solver : names) {
        EXPECT_THAT(spec.solvers, testing::Contains(solver.get<std::string>())) << claim["claim"];
      }
    };
    const auto expect_x = [&](double x) {
      EXPECT_THAT(spec.values, testing::Contains(x)) << claim["claim"];
      EXPECT_THAT(spec.quick_values, testing::Contains(x)) << claim["claim"];
    };
    for (const char* part : {"cases", "figures", "where_not"}) {
      if (!claim.contains(part)) continue;
      for (const Json& entry : claim[part]) {
        for (const char* key : {"a", "b"}) {
          if (entry.contains(key)) expect_solvers(entry[key]);
          if (entry.contains(key) && entry[key].contains("same_at")) {
            expect_x(entry[key]["same_at"].get<double>());
          }
        }
        if (entry.contains("show")) {
          for (const Json& shown : entry["show"]) expect_solvers(shown);
        }
        if (entry.contains("x") && entry["x"].contains("equal")) {
          expect_x(entry["x"]["equal"].get<double>());
        }
        if (entry.contains("since")) expect_x(entry["since"].get<double>());
        if (entry.contains("quantities") && entry["quantities"][0] == "iterations") {
          EXPECT_EQ(entry["is"]["at_least"],
                    ExperimentEstimate("17pt-li", kPaperLoop, 0.5).ransac.max_iterations);
        }
      }
    }
  }
}

TEST_F(ExperimentTest, WithoutPythonTheResultsStay) {
  const std::string path = getenv("PATH");
  setenv("PATH", Path("nothing").c_str(), 1);
  const Outcome run = Experiment(kSmall + Args{"--output=" + Path("a")});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("no claims: python3 cannot be run"),
                             HasSubstr("rigel_claims.py -- " + Path("a"))));
  EXPECT_TRUE(fs::exists(Path("a/outliers.json")));
  EXPECT_FALSE(fs::exists(Path("a/claims.json")));
  EXPECT_EXIT_CODE(RunTool("claims.py", {"--", Path("a")}), 0);
  EXPECT_TRUE(fs::exists(Path("a/claims.json")));
}

TEST_F(ExperimentTest, AnUnwritablePageIsFoundBeforeTheRun) {
  const std::string page = Path("missing/page.html");
  const Outcome run =
      RunTool("experiment", kSmall + Args{"--output=" + Path("a"), "--html=" + page});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr(page));
  EXPECT_FALSE(fs::exists(Path("a/outliers.points.jsonl")));
}

TEST_F(ExperimentTest, KeepsWhatIsThere) {
  const Args args = kSmall + Args{"--output=" + Path("a")};
  ASSERT_EXIT_CODE(Experiment(args), 0);
  const std::string points = ReadText(Path("a/outliers.points.jsonl"));

  Outcome run = Experiment(args);
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr(Path("a/outliers.points.jsonl")), HasSubstr("--resume")));
  run = Experiment(args + Args{"--resume", "--seed=2"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("of another run"));
  EXPECT_EQ(ReadText(Path("a/outliers.points.jsonl")), points);

  std::string broken = points;
  broken[broken.find("\"rows\"") + 2] = '!';
  WriteText(Path("a/outliers.points.jsonl"), broken);
  run = Experiment(args + Args{"--resume"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr(Path("a/outliers.points.jsonl") + ":2: no finished point"));

  EXPECT_EXIT_CODE(Experiment(args + Args{"--overwrite"}), 0);
  EXPECT_EQ(ReadText(Path("a/outliers.points.jsonl")), points);
}

TEST_F(ExperimentTest, SaysWhatCannotBeWrittenOrRead) {
  WriteText(Path("file"), "");
  Outcome run = Experiment(kSmall + Args{"--output=" + Path("file/below")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr(Path("file/below")));

  fs::create_directories(Path("b/outliers.points.jsonl"));
  run = Experiment(kSmall + Args{"--output=" + Path("b"), "--resume"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("outliers.points.jsonl"));

  run = Experiment({"--name=kitti-motions", "--quick", "--output=" + Path("c"),
                    "--kitti_root=" + Path("missing")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr(Path("missing/poses")));
}

TEST_F(ExperimentTest, KittiMotionsHasARowADrive) {
  fs::create_directories(Path("kitti/poses"));
  WritePoses(Path("kitti/poses/03.txt"));
  WritePoses(Path("kitti/poses/04.txt"));
  const Outcome run = Experiment({"--name=kitti-motions", "--quick", "--every=4",
                                  "--output=" + Path("a"), "--kitti_root=" + Path("kitti")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_LE(Width(run.out), 100u) << run.out;
  const Json report = ParseReport(ReadText(Path("a/kitti-motions.json")));
  EXPECT_FALSE(report.contains("x"));
  std::set<std::string> drives;
  for (const Json& row : report["results"]) {
    drives.insert(row["sequence"].get<std::string>());
    EXPECT_EQ(row["pairs"], 3) << "motions 0, 4 and 8 of nine";
    EXPECT_FALSE(row.contains("x"));
    EXPECT_TRUE(row.contains("refined"));
    EXPECT_TRUE(row.contains("time_ms"));
  }
  EXPECT_THAT(drives, testing::ElementsAre("03", "04"));
  EXPECT_THAT(ReadText(Path("a/claims.md")),
              HasSubstr("`kitti-motions`: every 4th motion, seed 1"));
  EXPECT_THAT(ReadText(Path("a/claims.md")), HasSubstr("4pt-axis-approx is the fastest"));
  EXPECT_THAT(ReadText(Path("a/claims.md")), Not(HasSubstr("not measured")));
}

TEST_F(ExperimentTest, WithoutMatplotlibTheResultsStay) {
  HideMatplotlib();
  const Outcome run = RunTool("experiment", kSmall + Args{"--output=" + Path("a")});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, AllOf(HasSubstr("matplotlib"), HasSubstr("rigel_plot.py")));
  EXPECT_TRUE(fs::exists(Path("a/outliers.json")));
  const Outcome page =
      RunTool("experiment", kSmall + Args{"--output=" + Path("c"), "--html=" + Path("page.html")});
  EXPECT_EXIT_CODE(page, 1);
  EXPECT_TRUE(fs::exists(Path("c/outliers.json")));
}

}  // namespace
}  // namespace rigel
