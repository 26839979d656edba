// rigel_plot.py: figures of experiments, reports, benchmarks and trajectories, and what it refuses.
#include <algorithm>
#include <filesystem>
#include <utility>

#include "rigel/problems/experiments/experiment.h"
#include "rigel/test/tools/experiment_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

class PlotTest : public ExperimentTest {
 protected:
  // True, with a message, if there is no matplotlib to draw with.
  bool Skip() {
    WritePoses(Path("probe.txt"));
    const Outcome run =
        RunTool("plot.py", {"--estimate=" + Path("probe.txt"), "--output=" + Path("probe")});
    return run.exit_code == 4;
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

// Four cameras around a car, x forward and z up, as body_from_camera or the inverse.
std::string RingJson(bool inverted) {
  const struct {
    const char *name, *pose, *inverse;
  } cameras[] = {
      {"front", R"("q": [0.5, -0.5, 0.5, -0.5], "s": [2, 0, 1.5])",
       R"("q": [0.5, 0.5, -0.5, 0.5], "s": [0, 1.5, -2])"},
      {"back", R"("q": [0.5, -0.5, -0.5, 0.5], "s": [0, 0, 1.5])",
       R"("q": [0.5, 0.5, 0.5, -0.5], "s": [0, 1.5, 0])"},
      {"left", R"("q": [0.7071067811865476, -0.7071067811865476, 0, 0], "s": [1, 0.5, 1.5])",
       R"("q": [0.7071067811865476, 0.7071067811865476, 0, 0], "s": [-1, 1.5, -0.5])"}};
  std::string text;
  for (const auto& camera : cameras) {
    text += std::string(text.empty() ? "" : ", ") + R"({"name": ")" + camera.name +
            R"(", "model": "opencv_fisheye", "width": 640, "height": 480,
               "parameters": [200, 200, 319.5, 239.5, 0.01, 0, 0, 0], )" +
            (inverted ? camera.inverse : camera.pose) + "}";
  }
  return R"({"format": "rigel-rig 1", "name": "car", "ground_m": 0.3, "cameras": [)" + text + "]}";
}

TEST_F(PlotTest, DrawsRigs) {
  SKIP_WITHOUT_MATPLOTLIB();
  WriteText(Path("rig.json"), RingJson(false));
  WriteText(Path("inverted.json"), RingJson(true));
  WriteText(Path("older.json"), R"({"cameras": [{"name": "a", "model": "brown k1 k2 p1 p2 k3",
    "fx": 7, "fy": 8, "cx": 3, "cy": 4, "distortion": [0.1, 0, 0, 0, 0], "width": 6, "height": 8,
    "q": [1, 0, 0, 0], "s": [5e5, 0, 0]}]})");
  ASSERT_EXIT_CODE(RunTool("plot.py", {Path("rig.json"), Path("inverted.json"), Path("older.json"),
                                       "--output=" + Path("f")}),
                   0);
  for (const char* name : {"rig", "inverted", "older"}) ExpectFigure(Path("f/") + name);
  EXPECT_THAT(ReadText(Path("f/rig.svg")),
              AllOf(HasSubstr("car: 3 cameras"), HasSubstr(">front<"), HasSubstr(">left<"),
                    HasSubstr("right, -y [m]"), HasSubstr("forward, +x [m]"), HasSubstr("down, -z"),
                    HasSubstr("ground"), Not(HasSubstr("warning"))));
  EXPECT_THAT(ReadText(Path("f/inverted.svg")), HasSubstr("warning: poses look inverted"));
  EXPECT_THAT(ReadText(Path("f/older.svg")), HasSubstr("the body's origin is 5e+05 m away"));
  WriteText(Path("rig.json"), R"({"format": "rigel-rig 1", "cameras": [{"q": 1}]})");
  const Outcome run = RunTool("plot.py", {Path("rig.json"), "--output=" + Path("f")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("rig.json: not of its format 'rigel-rig 1'"));
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
