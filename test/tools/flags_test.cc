// What all programs have in common: --help, --version, wrong flags, unwritable output.
#include <filesystem>
#include <map>

#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// DESIGN.md, section 10, and --loss.
const Args kEstimationFlags = {"calibration_sigma_deg",
                               "calibration_sigma_m",
                               "confidence",
                               "down",
                               "typical_length",
                               "fix_translation_norm",
                               "forward",
                               "loss",
                               "matches",
                               "max_iterations",
                               "no_times",
                               "prior",
                               "prior_noise_axis",
                               "prior_noise_deg",
                               "prior_sigma_deg",
                               "refine",
                               "residual",
                               "seed",
                               "shard",
                               "threads",
                               "threshold_px",
                               "time_limit_ms",
                               "use",
                               "use_prior_in_refine"};

const Args kSensorFlags = {
    "attitude",         "attitude_sigma_deg", "attitude_time_offset_s",  "gyro",
    "gyro_bias_deg",    "gyro_noise_deg",     "gyro_time_offset_s",      "imu_from_body",
    "odometry",         "odometry_sigma",     "odometry_sigma_fraction", "odometry_time_offset_s",
    "sensor_max_gap_s", "world_down"};

std::map<std::string, Args> FlagsOfTools() {
  return {
      {"benchmark",
       {"json", "matches", "num_cameras", "pairs", "prior", "random_axis", "ransac", "refine",
        "rotation_deg", "seed", "solvers", "trials"}},
      {"compare",
       kEstimationFlags + Args{"baseline", "by", "csv", "fail_above", "json", "max_failures",
                               "merge", "per_pair", "solvers", "tolerance"}},
      {"calibrate_prior", kEstimationFlags + Args{"in_place", "json", "lines", "output", "solver"}},
      {"convert", kSensorFlags + Args{"matches", "output"}},
      {"estimate", kEstimationFlags + Args{"csv", "drift", "g2o", "json", "kitti_trajectory",
                                           "solver", "truth_trajectory", "tum_trajectory"}},
      {"match", kSensorFlags + Args{"camera_pairs", "euroc_root",   "features",
                                    "first",        "frames",       "images",
                                    "kitti_root",   "landmarks",    "last",
                                    "masks",        "max_features", "output",
                                    "ratio",        "resume",       "rig",
                                    "sequence",     "stride",       "sync_tolerance_ms",
                                    "threads",      "time_unit_s",  "tracks"}},
      {"rig",
       {"calibration", "cameras", "colmap_cameras", "down", "format", "forward", "ground_m",
        "index", "name", "output", "size"}},
      {"simulate",
       {"calibration_sigma_deg",
        "calibration_sigma_m",
        "camera_noise_px",
        "camera_times",
        "distance_m",
        "every",
        "ground_m",
        "inter_share",
        "interval_s",
        "match_scores",
        "motion",
        "moving_share",
        "noise_model",
        "noise_px",
        "num_cameras",
        "num_matches",
        "outlier_share",
        "output",
        "pairs",
        "poses",
        "rig",
        "ring",
        "rotation_axis",
        "rotation_deg",
        "scene",
        "seed",
        "state_calibration_sigma",
        "threads"}}};
}

// A run that would succeed but for what is added to it and that the files are not there, nor can be
// made: who looks at files before the flags fails with 1 instead of 2.
Args Minimal(const std::string& tool) {
  if (tool == "benchmark") return {"--solvers=4pt", "--trials=2"};
  if (tool == "convert") {
    return {"--matches=/proc/nonexistent/of/rigel", "--output=/proc/nonexistent/of/rigel",
            "--odometry=/proc/nonexistent/of/rigel"};
  }
  if (tool == "match") {
    return {"--euroc_root=/proc/nonexistent/of/rigel", "--output=/proc/nonexistent/of/rigel"};
  }
  if (tool == "rig") return {"--calibration=/proc/nonexistent/of/rigel"};
  if (tool == "simulate") return {"--output=/proc/nonexistent/of/rigel", "--pairs=1"};
  return {"--matches=/proc/nonexistent/of/rigel"};
}

void ExpectUsageError(const std::string& tool, const Args& wrong, const std::string& what) {
  const Outcome run = RunTool(tool, Minimal(tool) + wrong);
  EXPECT_EXIT_CODE(run, 2);
  EXPECT_THAT(run.err, HasSubstr(what)) << run.command;
  EXPECT_THAT(run.err, Not(HasSubstr("/nonexistent"))) << "a file was looked at: " << run.command;
  EXPECT_THAT(run.out, IsEmpty()) << run.command;
}

Args Tools() {
  Args tools = {"benchmark", "calibrate_prior", "compare", "convert", "estimate", "simulate"};
#ifdef RIGEL_HAS_RIG
  tools.push_back("rig");
#endif
#ifdef RIGEL_HAS_MATCH
  tools.push_back("match");
#endif
  return tools;
}

class EachTool : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Tools, EachTool, testing::ValuesIn(Tools()),
                         [](const auto& tool) { return tool.param; });

TEST_P(EachTool, HelpExplainsItsOwnFlagsAndNoOthers) {
  for (const char* spelling : {"--help", "-help", "-h"}) {
    const Outcome run = RunTool(GetParam(), {spelling});
    EXPECT_EXIT_CODE(run, 0);
    EXPECT_THAT(run.err, IsEmpty());
    EXPECT_THAT(run.out, StartsWith("rigel_" + GetParam() + ": "));
    EXPECT_LE(Width(run.out), 100u);
    const bool has_bounds = GetParam() == "compare";
    EXPECT_THAT(run.out, EndsWith(has_bounds ? "3 a bound that a flag set was missed.\n"
                                             : "Exit code: 0 done, 1 failed, 2 wrong flag.\n"));

    const std::vector<std::string> lines = Lines(run.out);
    Args listed;
    for (size_t k = 0; k < lines.size(); ++k) {
      if (lines[k].substr(0, 4) != "  --") continue;
      const std::string name = lines[k].substr(4, lines[k].find_first_of("= ", 4) - 4);
      listed.push_back(name);
      const std::string explanation = k + 1 < lines.size() ? lines[k + 1] : "";
      EXPECT_THAT(explanation, AllOf(StartsWith("      "), testing::SizeIs(testing::Gt(16u))))
          << "--" << name << " is not explained";
    }
    EXPECT_THAT(listed, testing::UnorderedElementsAreArray(FlagsOfTools()[GetParam()]));
  }
}

TEST_P(EachTool, HelpWinsOverWrongFlags) {
  EXPECT_EXIT_CODE(RunTool(GetParam(), {"--seed=2", "--help"}), 0);
}

TEST_P(EachTool, VersionIsOneLine) {
  const Outcome run = RunTool(GetParam(), {"--version"});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_EQ(run.out, "rigel_" + GetParam() + " " RIGEL_EXPECTED_VERSION "\n");
}

TEST_P(EachTool, UnknownFlagIsAUsageError) {
  ExpectUsageError(GetParam(), {"--no_such_flag=1"}, "no_such_flag");
  ExpectUsageError(GetParam(), {"-x"}, "x");
}

TEST_P(EachTool, ValueThatDoesNotParseIsAUsageError) {
  ExpectUsageError(GetParam(), {"--seed=abc"}, "seed");
  ExpectUsageError(GetParam(), {"--seed=1.5"}, "seed");
  ExpectUsageError(GetParam(), {"--seed="}, "seed");
  ExpectUsageError(GetParam(), {"--seed"}, "seed");  // no value follows
}

TEST_P(EachTool, PositionalArgumentIsAUsageError) {
  ExpectUsageError(GetParam(), {"stray"}, "'stray'");
  ExpectUsageError(GetParam(), {"--", "stray"}, "'stray'");
}

TEST_P(EachTool, UsageErrorPointsToHelp) {
  const Outcome run = RunTool(GetParam(), {"stray"});
  EXPECT_THAT(run.err, HasSubstr("rigel_" + GetParam() + " --help"));
}

TEST(Flags, ValueOutOfRangeIsAUsageErrorBeforeAnyFileIsRead) {
  for (const char* tool : {"calibrate_prior", "estimate", "compare"}) {
    const std::pair<const char*, const char*> wrong[] = {
        {"--use=both", "all, intra or inter"},
        {"--prior=imu", "file, body or truth"},
        {"--prior_noise_axis=yaw", "pitch, roll or random"},
        {"--down=down", "--down=down: expected +x, -x, +y, -y, +z, -z or three numbers"},
        {"--forward=1,0", "--forward=1,0: expected +x"},
        {"--forward=0,0,nan", "--forward=0,0,nan: expected +x"},
        {"--prior_noise_deg=nan", "prior_noise_deg"},
        {"--prior_noise_deg=181", "prior_noise_deg=181: expected -180 to 180"},
        {"--prior_noise_deg=1e308", "prior_noise_deg=1e+308: expected"},
        {"--prior_sigma_deg=-1", "prior_sigma_deg"},
        {"--prior_sigma_deg=inf", "prior_sigma_deg"},
        {"--refine=most", "none, full, prior, depths, prior-depths or bundle"},
        {"--residual=pixels", "sampson, angular or algebraic"},
        {"--loss=l1", "none, huber, cauchy, tukey or truncated"},
        {"--threshold_px=0", "auto or a positive number"},
        {"--threshold_px=nan", "auto or a positive number"},
        {"--threshold_px=1.5px", "auto or a positive number"},
        {"--confidence=1", "confidence must lie in (0, 1)"},
        {"--confidence=0", "confidence must lie in (0, 1)"},
        {"--max_iterations=0", "max_iterations must be at least 1"},
        {"--time_limit_ms=-1", "time_limit_ms=-1: expected a number from 0"},
        {"--time_limit_ms=nan", "time_limit_ms=nan: expected a number from 0"},
        {"--threads=0", "1 to 1024"},
        {"--threads=2000", "1 to 1024"},
        {"--seed=-1", "seed"},
        {"--shard=4/4", "--shard=4/4: expected i/n with i from 0 to n - 1"},
        {"--shard=-1/2", "--shard=-1/2: expected"},
        {"--shard=a/b", "--shard=a/b: expected"},
        {"--shard=1/0", "--shard=1/0: expected"},
        {"--shard=1", "--shard=1: expected"},
    };
    for (const auto& [flag, what] : wrong) ExpectUsageError(tool, {flag}, what);
    // What another flag leaves without effect.
    ExpectUsageError(tool, {"--refine=bundle", "--residual=angular"}, "reprojection errors");
    for (const char* flag :
         {"--fix_translation_norm", "--use_prior_in_refine", "--typical_length=2"}) {
      ExpectUsageError(tool, {"--refine=none", flag},
                       "have no effect without a refinement (--refine=none)");
    }
    const Outcome run = RunTool(tool, {});
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, HasSubstr("--matches is missing"));
  }
}

TEST(Flags, UnknownSolverIsAUsageErrorThatListsTheSolvers) {
  ExpectUsageError("estimate", {"--solver=5pt"}, "--solver=5pt");
  ExpectUsageError("estimate", {"--solver=5pt"}, "4pt-axis-approx-polished");
  ExpectUsageError("estimate", {"--solver="}, "4pt-axis");
}

TEST(Flags, ListOfNoSolverIsAUsageErrorAndNotAllOfThem) {
  ExpectUsageError("compare", {"--solvers=,"}, "--solvers=,: names no solver");
  ExpectUsageError("benchmark", {"--solvers=,,"}, "--solvers=,,: names no solver");
}

TEST(Flags, ExactPriorOfASolverWithoutOneIsAUsageErrorInTermsOfTheFlags) {
  for (const char* form : {"--refine=prior", "--refine=prior-depths"}) {
    const std::string what = form + std::string(": 17pt-li has no prior to hold exact");
    ExpectUsageError("estimate", {"--solver=17pt-li", form}, what);
    ExpectUsageError("compare", {"--solvers=4pt,17pt-li", form}, what);
  }
}

TEST(Flags, PoseGraphWithoutARefinementIsAUsageError) {
  ExpectUsageError("estimate", {"--refine=none", "--g2o=-"}, "--g2o: without a refinement");
}

TEST(Flags, MergingTakesNoFlagsOfAnEstimateAndNoEmptyList) {
  const auto expect = [](const Args& args, const std::string& what) {
    const Outcome run = RunTool("compare", args);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, AllOf(HasSubstr(what), Not(HasSubstr("/nonexistent"))));
  };
  const std::string merge = "--merge=/proc/nonexistent/of/rigel";
  for (const char* flag : {"--matches=x", "--solvers=4pt", "--by=sequence", "--seed=1",
                           "--shard=0/2", "--threads=1"}) {
    const std::string name = std::string(flag).substr(0, std::string(flag).find('='));
    expect({merge, flag}, "--merge: " + name + " has no effect");
  }
  expect({"--merge=,"}, "--merge=,: names no report");
  expect({merge, "--json=-", "--csv=-"}, "--csv=-");
}

TEST(Flags, PosesHaveTheirOwnMotionsAndFramesNeedPoses) {
  const Args poses = {"--poses=/proc/nonexistent/of/rigel"};
  for (const char* flag :
       {"--pairs=50", "--motion=forward", "--rotation_deg=1", "--rotation_axis=y"}) {
    const Outcome run = RunTool("simulate", Args{"--output=/proc/x", flag} + poses);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, AllOf(HasSubstr("the motions are those of --poses"),
                               Not(HasSubstr("/nonexistent"))));
  }
  ExpectUsageError("simulate", {"--every=2"},
                   "--every: there are no recorded motions without --poses");
  ExpectUsageError("simulate", {"--every=0"}, "--every: expected at least 1");
  ExpectUsageError("simulate", {"--threads=0"}, "--threads=0: expected 1 to 1024");
}

TEST(Flags, UnwritableOutputFileFails) {
  // Solvers are named, so that nothing takes long.
  for (const char* flag : {"--json=/proc/nonexistent/x", "--json=/dev/full", "--json=/"}) {
    const Outcome run = RunTool("benchmark", {"--solvers=4pt", "--trials=2", flag});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(run.err, HasSubstr(std::string(flag).substr(7)));
    EXPECT_THAT(run.err, HasSubstr("cannot be"));
  }
}

class Outputs : public ToolsTest {};

TEST_F(Outputs, UnwritableFileFailsAndTheTableIsThereAllTheSame) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=30"});
  for (const char* tool : {"estimate", "compare"}) {
    for (const char* file : {"/proc/nonexistent/x", "/dev/full", "/"}) {
      for (const char* flag : {"--json=", "--csv="}) {
        const Outcome run = RunTool(tool, {"--matches=" + matches, std::string(flag) + file});
        EXPECT_EXIT_CODE(run, 1);
        EXPECT_THAT(run.err, HasSubstr(file + std::string(": cannot be")));
        EXPECT_THAT(run.out, HasSubstr("-----"));
      }
    }
  }
  for (const char* file : {"/proc/nonexistent/x", "/dev/full"}) {
    const Outcome run =
        RunTool("calibrate_prior", {"--matches=" + matches, std::string("--json=") + file});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(run.err, HasSubstr(file + std::string(": cannot be")));
    EXPECT_THAT(run.out, HasSubstr("motion plane"));
  }
  const Outcome run = RunTool("estimate", {"--matches=" + matches, "--g2o=/dev/full"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("/dev/full: cannot be"));
  EXPECT_THAT(run.out, HasSubstr("-----"));
}

TEST_F(Outputs, UnwritableStdoutFails) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=30"});
  const std::string inter = Simulate("inter", {"--pairs=1", "--inter_share=0.5"});
  const std::pair<const char*, Args> runs[] = {
      {"estimate", {"--matches=" + matches}},
      {"estimate", {"--matches=" + matches, "--json=-"}},
      {"estimate", {"--matches=" + matches, "--csv=-"}},
      {"estimate", {"--matches=" + matches, "--g2o=-"}},
      {"estimate", {"--matches=" + inter, "--kitti_trajectory=-"}},
      {"calibrate_prior", {"--matches=" + matches}},
      {"calibrate_prior", {"--matches=" + matches, "--json=-"}},
      {"compare", {"--matches=" + matches, "--solvers=4pt"}},
      {"compare", {"--matches=" + matches, "--solvers=4pt", "--json=-"}},
      {"benchmark", {"--solvers=4pt", "--trials=2"}},
      {"benchmark", {"--solvers=4pt", "--trials=2", "--json=-"}},
      {"estimate", {"--help"}},
      {"simulate", {"--version"}},
  };
  for (const auto& [tool, args] : runs) {
    for (const Stdout to : {Stdout::kFullDevice, Stdout::kClosed, Stdout::kBrokenPipe}) {
      const Outcome run = RunTool(tool, args, to);
      EXPECT_EXIT_CODE(run, 1);
      EXPECT_THAT(run.err, HasSubstr("stdout: cannot be written"))
          << run.command << " " << static_cast<int>(to);
    }
  }
}

TEST_F(Outputs, ClosedStdoutDoesNotEndUpInTheFileOfTheReport) {
  // The first file that is opened gets the number of the closed stdout.
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=30"});
  const Outcome run =
      RunTool("estimate", {"--matches=" + matches, "--json=" + Path("x.json")}, Stdout::kClosed);
  EXPECT_EXIT_CODE(run, 1);
  ParseReport(ReadText(Path("x.json")));
}

TEST_F(Outputs, OnlyOneReportFitsOnStdout) {
  for (const char* tool : {"estimate", "compare"}) {
    ExpectUsageError(tool, {"--json=-", "--csv=-"}, "--csv=-");
  }
  ExpectUsageError("estimate", {"--json=-", "--g2o=-"}, "--g2o=-: --json goes to stdout already");
  ExpectUsageError("compare", {"--json=-", "--csv=-"}, "--csv=-: --json goes to stdout already");
  ExpectUsageError("compare", {"--json=f", "--csv=./f"}, "--csv=./f: --json writes to");
  ExpectUsageError("estimate", {"--csv=-", "--g2o=-"}, "--g2o=-: --csv goes to stdout already");
}

}  // namespace
}  // namespace rigel
