// rigel_experiment and rigel_plot.py: results, resumed runs, figures and what fails a run.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <utility>

#include "rigel/problems/experiments/experiment.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

// Beside its results each run gives figures, where matplotlib is.
const Args kSmall = {"--name=outliers", "--quick", "--pairs=2", "--no_times"};
const char* const kFiles[] = {"outliers.json", "outliers.csv", "outliers.txt",
                              "claims.md",     "claims.json",  "outliers.points.jsonl"};

class ExperimentTest : public ToolsTest {
 protected:
  Outcome Experiment(const Args& args) { return RunTool("experiment", args + Args{"--nofigures"}); }

  // A matplotlib that cannot be imported hides the real one.
  void HideMatplotlib() {
    fs::create_directories(Path("hide/matplotlib"));
    WriteText(Path("hide/matplotlib/__init__.py"), "raise ImportError('hidden')\n");
    setenv("PYTHONPATH", Path("hide").c_str(), 1);
  }
  void TearDown() override {
    unsetenv("PYTHONPATH");
    ToolsTest::TearDown();
  }
};

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
  EXPECT_THAT(ReadText(Path("a/claims.md")), Not(HasSubstr("kitti-motions:")));
  WriteText(Path("a/outliers.json"), "[]");
  const Outcome run =
      Experiment({"--name=rotation-angle", "--quick", "--pairs=3", "--no_times", out});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, HasSubstr("outliers.json: not among the claims"));
  const std::string claims = ReadText(Path("a/claims.md"));
  EXPECT_THAT(
      claims,
      AllOf(HasSubstr("| inter-share |"), HasSubstr("| rotation-angle |"),
            HasSubstr("inter-share: 2 pairs a point, the coarse grid of --quick, seed 1"),
            HasSubstr("rotation-angle: 3 pairs a point"), Not(HasSubstr("kitti-motions:"))));
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

// Ten frames straight ahead, 1 m each.
void WritePoses(const std::string& path) {
  std::string text;
  for (int k = 0; k < 10; ++k) text += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
  WriteText(path, text);
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
    EXPECT_TRUE(row.contains("bound"));
    EXPECT_TRUE(row.contains("time_ms"));
  }
  EXPECT_THAT(drives, testing::ElementsAre("03", "04"));
  EXPECT_THAT(ReadText(Path("a/claims.md")), HasSubstr("kitti-motions: every 4th motion, seed 1"));
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

class PlotTest : public ExperimentTest {
 protected:
  // True, with a message, if there is no matplotlib to draw with.
  bool Skip() {
    WritePoses(Path("probe.txt"));
    const Outcome run =
        RunTool("plot.py", {"--estimate=" + Path("probe.txt"), "--output=" + Path("probe")});
    return run.exit_code == 3;
  }

  // Both files are there and are what they say.
  void ExpectFigure(const std::string& path) {
    EXPECT_EQ(ReadText(path + ".png").substr(1, 3), "PNG") << path;
    EXPECT_THAT(ReadText(path + ".svg"), HasSubstr("<svg")) << path;
  }
};

#define SKIP_WITHOUT_MATPLOTLIB() \
  if (Skip()) GTEST_SKIP() << "python3 has no matplotlib: figures are not tested"

TEST_F(PlotTest, DrawsAnExperimentAndOnePageWithAllOfIt) {
  SKIP_WITHOUT_MATPLOTLIB();
  const std::string page = Path("page.html");
  const Outcome run = RunTool("experiment", {"--name=outliers,image-noise", "--quick", "--pairs=1",
                                             "--output=" + Path("a"), "--html=" + page});
  ASSERT_EXIT_CODE(run, 0);
  for (const char* name :
       {"outliers", "outliers-rigel", "image-noise", "image-noise-rigel", "image-noise-runtime"}) {
    ExpectFigure(Path("a/figures/") + name);
  }
  const std::string svg = ReadText(Path("a/figures/image-noise.svg"));
  for (const char* text : {"forward motion", "random motion", "sideways motion", "refined", "raw",
                           "rotation error [deg]", "translation direction error [deg]",
                           "4pt-axis-approx", "17pt-li", "bound"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  const std::string html = ReadText(page);
  EXPECT_THAT(html, AllOf(HasSubstr("data:image/svg+xml;base64,"), HasSubstr("Claims"),
                          HasSubstr("outliers: "), HasSubstr("confirmed")));
  for (const char* outside : {"http:", "https:", "file:", "src=\"/", "<link", "<script"}) {
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  }
}

TEST_F(PlotTest, TheSameResultsGiveTheSameFigures) {
  SKIP_WITHOUT_MATPLOTLIB();
  ASSERT_EXIT_CODE(Experiment(kSmall + Args{"--output=" + Path("a")}), 0);
  for (const char* directory : {"f", "g"}) {
    ASSERT_EXIT_CODE(RunTool("plot.py", {Path("a"), "--output=" + Path(directory)}), 0);
  }
  EXPECT_EQ(ReadText(Path("f/outliers.svg")), ReadText(Path("g/outliers.svg")));
  EXPECT_EQ(ReadText(Path("f/outliers.png")), ReadText(Path("g/outliers.png")));
}

TEST_F(PlotTest, NeedsNoHome) {
  SKIP_WITHOUT_MATPLOTLIB();
  WritePoses(Path("poses.txt"));
  const std::string plot = std::string(RIGEL_PROGRAMS) + "/rigel_plot.py";
  const std::string command = "env -u MPLCONFIGDIR -u XDG_CONFIG_HOME HOME=" + Path("no_home") +
                              " " + plot + " --estimate=" + Path("poses.txt") +
                              " --output=" + Path("figures") + " 2>" + Path("talk");
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_THAT(ReadText(Path("talk")), Not(HasSubstr("Matplotlib")));
  ExpectFigure(Path("figures/trajectory"));
}

TEST_F(PlotTest, DrawsReportsBenchmarksAndTrajectories) {
  SKIP_WITHOUT_MATPLOTLIB();
  const std::string matches = Simulate("m", {"--pairs=3"});
  const Args compare = {"--matches=" + matches, "--solvers=4pt,6pt-ventura"};
  ASSERT_EXIT_CODE(RunTool("compare", compare + Args{"--per_pair", "--json=" + Path("pairs.json")}),
                   0);
  ASSERT_EXIT_CODE(RunTool("compare", compare + Args{"--json=" + Path("medians.json")}), 0);
  ASSERT_EXIT_CODE(
      RunTool("benchmark", {"--solvers=4pt,3pt", "--trials=10", "--json=" + Path("bench.json")}),
      0);
  WritePoses(Path("truth.txt"));
  WriteText(Path("estimate.txt"), "# time x y z qx qy qz qw\n0 0 0 0 0 0 0 1\n1 0 0 9 0 0 0 1\n");
  const Outcome run =
      RunTool("plot.py", {Path("pairs.json"), Path("medians.json"), Path("bench.json"),
                          "--truth=" + Path("truth.txt"), "--estimate=" + Path("estimate.txt"),
                          "--output=" + Path("f")});
  ASSERT_EXIT_CODE(run, 0);
  for (const char* name : {"pairs-cumulative", "medians-rotation_deg",
                           "medians-translation_dir_deg", "bench-runtime", "trajectory"}) {
    ExpectFigure(Path("f/") + name);
  }
}

TEST_F(PlotTest, SaysWhatItCannotDraw) {
  SKIP_WITHOUT_MATPLOTLIB();
  WriteText(Path("broken.json"), "{");
  WriteText(Path("other.json"), "{\"format\": \"something 1\"}");
  WriteText(Path("half.json"), "{\"format\": \"rigel-experiment 1\", \"experiment\": \"x\"}");
  WriteText(Path("short.txt"), "1 2 3\n");
  WriteText(Path("nan.txt"), "1 0 0 nan 0 1 0 0 0 0 1 0\n");
  fs::create_directories(Path("empty"));
  const std::string output = "--output=" + Path("f");
  for (const Args& args :
       {Args{Path("broken.json")}, Args{Path("other.json")}, Args{Path("half.json")},
        Args{Path("missing.json")}, Args{Path("empty")}}) {
    const Outcome run = RunTool("plot.py", args + Args{output});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(run.err, AllOf(HasSubstr(args[0]), Not(HasSubstr("Traceback"))));
  }
  for (const char* name : {"short.txt", "nan.txt"}) {
    const Outcome run = RunTool("plot.py", {"--estimate=" + Path(name), output});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(run.err, HasSubstr(Path(name) + ":1: "));
    // The page may not take the place of what it shows.
    const Outcome page =
        RunTool("plot.py", {"--estimate=" + Path(name), "--html=" + Path(name), output});
    EXPECT_EXIT_CODE(page, 1);
    EXPECT_THAT(page.err, HasSubstr("would overwrite the input " + Path(name)));
  }
  EXPECT_EXIT_CODE(RunTool("plot.py", {output}), 2);
  EXPECT_EXIT_CODE(RunTool("plot.py", {"--help"}), 0);
}

// A straight drive ahead that climbs a little: least extent is across, yet y is the vertical.
TEST_F(PlotTest, FromAboveLooksAlongTheVertical) {
  SKIP_WITHOUT_MATPLOTLIB();
  std::string kitti, tum;
  for (int k = 0; k < 10; ++k) {
    const std::string y = std::to_string(-0.1 * k), z = std::to_string(k);
    kitti += "1 0 0 0 0 1 0 " + y + " 0 0 1 " + z + "\n";
    tum += z + " 0 " + y + " " + z + " 0 0 0 1\n";
  }
  WriteText(Path("kitti.txt"), kitti);
  WriteText(Path("tum.txt"), tum);
  // To the right and up.
  const auto axes = [&](const Args& args) {
    EXPECT_EXIT_CODE(RunTool("plot.py", args + Args{"--output=" + Path("f")}), 0);
    const std::string svg = ReadText(Path("f/trajectory.svg"));
    std::string found;
    for (const char* place : {">to the right, ", ">forward, "}) {
      const size_t at = svg.find(place);
      EXPECT_NE(at, std::string::npos);
      const size_t begin = at + std::string(place).size();
      found += (found.empty() ? "" : " ") + svg.substr(begin, svg.find(" [m]<", begin) - begin);
    }
    return found;
  };
  EXPECT_EQ(axes({"--estimate=" + Path("tum.txt")}), "+x +z");
  const std::string estimate = "--estimate=" + Path("kitti.txt");
  EXPECT_EQ(axes({estimate}), "+x +z");
  EXPECT_EQ(axes({estimate, "--vertical=z"}), "+x +y");
  EXPECT_EQ(axes({estimate, "--down=0,0,-2"}), "-y +x");
  EXPECT_EQ(axes({estimate, "--forward=-z"}), "-x -z");
  for (const Args& wrong : {Args{"--down=1,2"}, Args{"--vertical=y", "--down=y"}}) {
    EXPECT_EXIT_CODE(RunTool("plot.py", Args{"--estimate=" + Path("tum.txt")} + wrong), 2);
  }
  const Outcome along = RunTool("plot.py", {"--estimate=" + Path("tum.txt"), "--down=z",
                                            "--forward=-z", "--output=" + Path("f")});
  EXPECT_EXIT_CODE(along, 1);
  EXPECT_THAT(along.err, HasSubstr("within 30 degrees"));

  // A body with x forward and z up, by its drive; what a TUM file of rigel_estimate says wins.
  std::string x_forward;
  for (int k = 0; k < 5; ++k) {
    x_forward += "1 0 0 " + std::to_string(k) + " 0 1 0 0 0 0 1 0\n";
  }
  WriteText(Path("x.txt"), x_forward);
  EXPECT_EQ(axes({"--truth=" + Path("x.txt")}), "-y +x");
  WriteText(Path("said.txt"), "# body: down -x, forward +z\n" + tum);
  EXPECT_EQ(axes({"--estimate=" + Path("said.txt")}), "+y +z");
  // A camera's drive in a world with z up: the camera's y is down there.
  WriteText(Path("world.txt"), "1 0 0 0 0 0 1 0 0 -1 0 0\n1 0 0 0 0 0 1 1 0 -1 0 0\n");
  EXPECT_EQ(axes({"--estimate=" + Path("world.txt")}), "+x +y");
}

// An experiment with one point, as JSON.
std::string MadeUp(const std::string& name, const std::vector<std::string>& solvers,
                   const std::string& more) {
  std::string rows;
  for (const std::string& solver : solvers) {
    const std::string stats = "{\"rotation_deg\": {\"median\": 1}}";
    rows += std::string(rows.empty() ? "" : ", ") +
            "{\"motion\": \"random\", \"x\": 1, \"loop\": \"paper\", \"sequence\": \"00\", "
            "\"solver\": \"" +
            solver + "\", \"raw\": " + stats + ", \"refined\": " + stats + more + "}";
  }
  return "{\"format\": \"rigel-experiment 1\", \"experiment\": \"" + name +
         "\", \"x\": {\"label\": \"x\"}, \"results\": [" + rows + "]}";
}

TEST_F(PlotTest, ABoundIsNamedWhereThereIsOneAndDrawnAsAMedian) {
  SKIP_WITHOUT_MATPLOTLIB();
  const std::string bound = ", \"bound\": {\"rotation_deg\": {\"median\": 1}}";
  std::string drives = MadeUp("c", {"4pt"}, "");
  drives.replace(drives.find("\"x\": {"), 3, "\"y\"");  // a row a drive
  WriteText(Path("a.json"), MadeUp("a", {"4pt"}, bound));
  WriteText(Path("b.json"), MadeUp("b", {"4pt"}, ""));
  WriteText(Path("c.json"), drives);
  ASSERT_EXIT_CODE(
      RunTool("plot.py", {Path("a.json"), Path("b.json"), Path("c.json"), "--output=" + Path("f")}),
      0);
  EXPECT_THAT(ReadText(Path("f/a.svg")), HasSubstr("bound (as a median)"));
  EXPECT_THAT(ReadText(Path("f/b.svg")), Not(HasSubstr("bound")));
  EXPECT_THAT(ReadText(Path("f/c.svg")), Not(HasSubstr("bound")));
}

TEST_F(PlotTest, ASolverLooksTheSameInAllFigures) {
  SKIP_WITHOUT_MATPLOTLIB();
  WriteText(Path("a.json"), MadeUp("a", {"4pt-axis"}, ""));
  WriteText(Path("b.json"), MadeUp("b", {"17pt-li", "6pt-stewenius", "4pt-axis"}, ""));
  WriteText(Path("c.json"), MadeUp("c", {"9pt-new"}, ""));
  WriteText(Path("d.json"), MadeUp("d", {"17pt-li", "3pt", "9pt-new"}, ""));
  ASSERT_EXIT_CODE(RunTool("plot.py", {Path("a.json"), Path("b.json"), Path("c.json"),
                                       Path("d.json"), "--output=" + Path("f")}),
                   0);
  // The colours of a figure of one solver are among those of a figure of more.
  for (const auto& [one, more] : {std::pair{"f/a.svg", "f/b.svg"}, {"f/c.svg", "f/d.svg"}}) {
    const std::string svg = ReadText(Path(one)), other = ReadText(Path(more));
    int colors = 0;
    for (size_t at = svg.find("stroke: #"); at != std::string::npos;
         at = svg.find("stroke: #", at + 1)) {
      ++colors;
      EXPECT_THAT(other, HasSubstr(svg.substr(at, 15))) << one;
    }
    EXPECT_GT(colors, 0);
  }
}

TEST_F(PlotTest, SaysInOneLineWhatItCannotDraw) {
  SKIP_WITHOUT_MATPLOTLIB();
  const std::vector<std::pair<std::string, const char*>> wrong = {
      {"{\"format\": \"rigel-claims 1\"}", "not of its format"},
      {"{\"format\": \"rigel-claims 1\", \"claims\": [{}]}", "not of its format"},
      {"{\"format\": \"rigel-report 1\", \"results\": [], \"pair_results\": [{}]}", "no results"},
      {"{\"format\": \"rigel-benchmark 1\", \"solvers\": []}", "no results"},
      {"{\"format\": \"rigel-benchmark 1\", \"solvers\": 3}", "not of its format"},
      {"{\"format\": [1]}", "no figure"},
      {MadeUp("x", {}, ""), "no results"},
      {MadeUp("../x", {"4pt"}, ""), "no name of an experiment"},
      {MadeUp("a/b", {"4pt"}, ""), "no name of an experiment"},
      {std::string(100000, '['), "nested too deeply"}};
  for (const auto& [text, message] : wrong) {
    WriteText(Path("wrong.json"), text);
    const Outcome run = RunTool("plot.py", {Path("wrong.json"), "--output=" + Path("f/g")});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(run.err, AllOf(HasSubstr(Path("wrong.json")), HasSubstr(message)));
    EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
  }
  EXPECT_FALSE(fs::exists(Path("f/x.png")));
}

TEST_F(PlotTest, LeavesOutForeignFilesOfADirectory) {
  SKIP_WITHOUT_MATPLOTLIB();
  fs::create_directories(Path("d"));
  WriteText(Path("d/a.json"), MadeUp("a", {"4pt"}, ""));
  WriteText(Path("d/foreign.json"), "{\"format\": \"else\"}");
  WriteText(Path("d/list.json"), "[1]");
  const Outcome run = RunTool("plot.py", {Path("d"), "--output=" + Path("f")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, AllOf(HasSubstr("left out: " + Path("d/foreign.json")),
                             HasSubstr("left out: " + Path("d/list.json"))));
  ExpectFigure(Path("f/a"));
}

TEST_F(PlotTest, WithoutMatplotlibItSaysSo) {
  HideMatplotlib();
  const Outcome run = RunTool("plot.py", {"x.json"});
  EXPECT_EXIT_CODE(run, 4);
  EXPECT_THAT(run.err, HasSubstr("apt install python3-matplotlib"));
  EXPECT_EXIT_CODE(RunTool("plot.py", {"--help"}), 0);
}

}  // namespace
}  // namespace rigel
