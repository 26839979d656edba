// rigel_calibrate_prior: files with a wrong normal and a wrong mounting, and what it leaves of
// them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "rigel/core/angles.h"
#include "rigel/core/pose.h"
#include "rigel/core/rig_centre.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const Eigen::Matrix3d kMounting = ExpSO3({DegToRad(1.2), 0, DegToRad(1.6)});  // 2 degrees

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

class CalibratePriorTest : public ToolsTest {
 protected:
  std::vector<FramePair> Read(const std::string& directory) {
    std::vector<std::string> errors;
    std::vector<FramePair> pairs;
    for (const std::string& path : ListMatchFiles(directory, &errors)) {
      pairs.emplace_back();
      std::string error;
      EXPECT_TRUE(ReadMatchFile(path, &pairs.back(), &error)) << error;
    }
    EXPECT_THAT(errors, IsEmpty());
    return pairs;
  }

  // A turning drive whose normal and gravity are stated 2 degrees off; with a comment in each file.
  std::string Misaligned(const std::string& name) {
    const std::string directory =
        Simulate(name, {"--pairs=30", "--num_matches=100", "--inter_share=0.5", "--motion=planar",
                        "--rotation_deg=3"});
    for (FramePair& pair : Read(directory)) {
      pair.prior.normal = kMounting * *pair.prior.normal;
      pair.prior.gravity1 = kMounting.transpose() * *pair.prior.gravity1;
      pair.prior.gravity2 = kMounting.transpose() * *pair.prior.gravity2;
      std::string error;
      EXPECT_TRUE(WriteMatchFile(pair.name, pair, &error)) << error;
      WriteText(pair.name, "# a comment\n" + ReadText(pair.name));
    }
    return directory;
  }
};

TEST_F(CalibratePriorTest, FindsTwoDegreesWithinItsSigmaAndWritesThem) {
  const std::string matches = Misaligned("in");
  const Outcome run =
      RunTool("calibrate_prior", {"--matches=" + matches, "--lines=normal,axis,gravity",
                                  "--output=" + Path("out"), "--json=" + Path("json")});
  ASSERT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("wrote 30 match files to ")));
  EXPECT_THAT(run.out, AllOf(HasSubstr("motion plane, from 30 translations and 30 rotations"),
                             HasSubstr(" deg from the start\n"),
                             HasSubstr("mounting of the gravity's frame")));
  EXPECT_LE(Width(run.out), 100u);

  const Json report = ParseReport(ReadText(Path("json")));
  EXPECT_EQ(report["format"], "rigel-prior-calibration 1");
  EXPECT_FALSE(report["options"].contains("output"));
  const Json plane = report["plane"];
  EXPECT_EQ(plane["level"], "full");
  EXPECT_NEAR(plane["change_deg"].get<double>(), 2.0, 0.1);
  const std::vector<double> n = plane["normal"];
  const double sigma =
      std::hypot(plane["tilt_sd_deg"].get<double>(), plane["roll_sd_deg"].get<double>());
  EXPECT_LT(AngleDeg({n[0], n[1], n[2]}, Eigen::Vector3d::UnitY()), 3 * sigma);
  EXPECT_LT(sigma, 0.2);
  const Json gravity = report["gravity"];
  EXPECT_NE(gravity["level"], "none");
  EXPECT_NEAR(gravity["change_deg"].get<double>(), 2.0, 0.2);

  const std::vector<FramePair> before = Read(matches);
  const std::vector<FramePair> after = Read(Path("out"));
  ASSERT_EQ(after.size(), before.size());
  for (size_t k = 0; k < after.size(); ++k) {
    EXPECT_THAT(ReadText(after[k].name), HasSubstr("# a comment\n"));
    const MotionPrior& prior = after[k].prior;
    EXPECT_LT(AngleDeg(*prior.normal, Eigen::Vector3d::UnitY()), 3 * sigma);
    EXPECT_EQ(*prior.axis, *prior.normal);
    EXPECT_FALSE(prior.axis_sigma.has_value());
    EXPECT_TRUE(prior.normal_sigma.has_value());
    EXPECT_LT(AngleDeg(*prior.gravity1, Eigen::Vector3d::UnitY()),
              5 * gravity["tilt_sd_deg"].get<double>());
    EXPECT_GT(AngleDeg(*before[k].prior.gravity1, Eigen::Vector3d::UnitY()), 1.9);
    EXPECT_EQ(after[k].matches.size(), before[k].matches.size());
    EXPECT_EQ(after[k].truth->t, before[k].truth->t);
    EXPECT_EQ(after[k].noise_px, before[k].noise_px);
  }
  // What it is for: raw errors of the planar solver.
  const auto raw = [&](const std::string& directory) {
    const Outcome compare =
        RunTool("compare", {"--matches=" + directory, "--solvers=3pt", "--json=-"});
    return ParseReport(compare.out)["results"][0]["raw"]["translation_dir_deg"]["median"]
        .get<double>();
  };
  EXPECT_LT(raw(Path("out")), 0.7 * raw(matches));
}

// A body with x forward, y left and z up.
TEST_F(CalibratePriorTest, ZUpBodyFindsItsNormalAndAWrongDownIsBlamed) {
  const std::string matches = Misaligned("in");
  MakeZUpWithoutPriors(matches);
  const Outcome found = RunTool("calibrate_prior", {"--matches=" + matches, "--json=-"});
  ASSERT_EXIT_CODE(found, 0);
  EXPECT_THAT(Lines(found.err), ElementsAre("--down=-z: taken from the cameras of the rig"));
  const Json plane = ParseReport(found.out)["plane"];
  EXPECT_EQ(plane["level"], "full");
  const std::vector<double> n = plane["normal"];
  EXPECT_LT(AngleDeg({n[0], n[1], n[2]}, {0, 0, -1}), 0.2);

  const Outcome up = RunTool("calibrate_prior", {"--matches=" + matches, "--down=z", "--json=-"});
  ASSERT_EXIT_CODE(up, 0);
  EXPECT_THAT(up.err, IsEmpty());
  EXPECT_GT(ParseReport(up.out)["plane"]["normal"][2].get<double>(), 0.99);

  const Outcome wrong =
      RunTool("calibrate_prior", {"--matches=" + matches, "--down=+y", "--output=" + Path("out")});
  EXPECT_EXIT_CODE(wrong, 1);
  std::string said;  // wherever its lines break
  for (const std::string& line : Lines(wrong.out))
    said += line.substr(std::min(line.find_first_not_of(' '), line.size())) + " ";
  EXPECT_THAT(said, AllOf(HasSubstr("not determined: the motions lie in a plane, but across"),
                          HasSubstr(" degrees from the start +y, farther"), HasSubstr("(--down)")));
  EXPECT_LE(Width(wrong.out), 100u);
  EXPECT_THAT(Lines(wrong.err), ElementsAre(HasSubstr("nothing is written")));
  EXPECT_FALSE(std::filesystem::exists(Path("out")));
}

TEST_F(CalibratePriorTest, PairsWithoutAMotionAreToldOnce) {
  const std::string matches = Simulate("in", {"--pairs=12", "--num_matches=60"});
  for (FramePair& pair : Read(matches)) {
    pair.prior = MotionPrior();
    std::string error;
    EXPECT_TRUE(WriteMatchFile(pair.name, pair, &error)) << error;
  }
  const Outcome run = RunTool("calibrate_prior", {"--matches=" + matches, "--solver=4pt"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err),
              ElementsAre(AllOf(HasSubstr("000000.matches: 4pt: the prior has no gravity1"),
                                HasSubstr("(12 files alike)")),
                          HasSubstr("--down=+y"), "no pair has a motion"));
}

TEST_F(CalibratePriorTest, InPlaceLeavesWholeFilesAndNothingElse) {
  const std::string matches = Misaligned("in");
  const std::string before = ReadText(matches + "/000000.matches");
  ASSERT_EXIT_CODE(RunTool("calibrate_prior", {"--matches=" + matches, "--in_place"}), 0);
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(matches)) {
    EXPECT_EQ(entry.path().extension(), ".matches");
    ++files;
  }
  EXPECT_EQ(files, 30u);
  // But for the normal and its sigma, line by line the same.
  std::vector<std::string> kept;
  for (const std::string& line : Lines(ReadText(matches + "/000000.matches"))) {
    if (line.find("normal") != 0 && line.find("# rigel_calibrate_prior normal turned by ") != 0) {
      kept.push_back(line);
    }
  }
  std::vector<std::string> expected;
  for (const std::string& line : Lines(before)) {
    if (line.find("normal") != 0) expected.push_back(line);
  }
  EXPECT_EQ(kept, expected);
  // Without a request to write nothing is.
  const std::string now = ReadText(matches + "/000000.matches");
  EXPECT_EXIT_CODE(RunTool("calibrate_prior", {"--matches=" + matches}), 0);
  EXPECT_EQ(ReadText(matches + "/000000.matches"), now);
}

TEST_F(CalibratePriorTest, NothingIsWrittenThatIsNotObservable) {
  const std::string few = Simulate("few", {"--pairs=5", "--inter_share=0.5"});
  const Outcome said = RunTool("calibrate_prior", {"--matches=" + few});
  EXPECT_EXIT_CODE(said, 0);  // an answer
  EXPECT_THAT(said.out, HasSubstr("not determined: too few motions"));
  EXPECT_THAT(Lines(said.err), ElementsAre("--down=+y: taken from the cameras of the rig"));
  const std::string before = ReadText(few + "/000000.matches");
  const Outcome run = RunTool("calibrate_prior", {"--matches=" + few, "--in_place", "--json=-"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("--down=+y"), HasSubstr("nothing is written")));
  EXPECT_EQ(ParseReport(run.out)["plane"]["level"], "none");
  EXPECT_EQ(ReadText(few + "/000000.matches"), before);
}

TEST_F(CalibratePriorTest, TargetsThatWouldDestroyAreRefused) {
  const std::string a = Misaligned("a");
  const Outcome itself = RunTool("calibrate_prior", {"--matches=" + a, "--output=" + a});
  EXPECT_EXIT_CODE(itself, 1);
  EXPECT_THAT(Lines(itself.err), ElementsAre(HasSubstr("--output would overwrite it")));
  const std::string b = Simulate("b", {"--pairs=1", "--num_matches=60"});
  const Outcome twice =
      RunTool("calibrate_prior", {"--matches=" + a + "," + b, "--output=" + Path("out")});
  EXPECT_EXIT_CODE(twice, 1);
  EXPECT_THAT(Lines(twice.err), ElementsAre(HasSubstr("another file has the same name")));
  const Outcome report = RunTool("calibrate_prior", {"--matches=" + a, "--output=" + Path("out"),
                                                     "--json=" + Path("out/000003.matches")});
  EXPECT_EXIT_CODE(report, 2);
  EXPECT_THAT(report.err, HasSubstr("a match file goes to this file"));
  WriteText(Path("file"), "no directory\n");
  const Outcome file = RunTool("calibrate_prior", {"--matches=" + a, "--output=" + Path("file")});
  EXPECT_EXIT_CODE(file, 1);
  EXPECT_THAT(Lines(file.err), ElementsAre(HasSubstr("cannot be made")));
}

TEST_F(CalibratePriorTest, BrokenFilesAreToldAndTheOthersUsed) {
  const std::string matches = Misaligned("in");
  WriteText(matches + "/000003.matches", "format rigmatch 1\nnormal 0 0\n");
  const Outcome run =
      RunTool("calibrate_prior", {"--matches=" + matches, "--output=" + Path("out")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("000003.matches:2: 3 columns, expected 4"),
                             HasSubstr("wrote 29 match files")));
  EXPECT_THAT(Read(Path("out")), SizeIs(29));
}

// As a run leaves it that was killed between two files.
TEST_F(CalibratePriorTest, PartlyCalibratedFilesAreRefused) {
  const std::string matches = Misaligned("in");
  const std::string untouched = ReadText(matches + "/000007.matches");
  const Args in_place = {"--matches=" + matches, "--in_place", "--lines=normal,axis,gravity"};
  ASSERT_EXIT_CODE(RunTool("calibrate_prior", in_place), 0);
  // All of them once more: gravity is where it belongs and is turned by nothing worth the name.
  const Outcome again = RunTool("calibrate_prior", in_place + Args{"--json=-"});
  EXPECT_EXIT_CODE(again, 0);
  EXPECT_LT(ParseReport(again.out)["gravity"]["change_deg"].get<double>(), 0.2);
  const std::vector<std::string> lines = Lines(ReadText(matches + "/000006.matches"));
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                          [](const std::string& line) { return line[0] == '#'; }),
            4);

  WriteText(matches + "/000007.matches", untouched);
  const std::string before = ReadText(matches + "/000006.matches");
  for (const char* line : {"normal", "axis", "gravity"}) {
    for (const std::string& target : {std::string("--in_place"), "--output=" + Path("out")}) {
      const Outcome run = RunTool("calibrate_prior",
                                  {"--matches=" + matches, target, std::string("--lines=") + line});
      EXPECT_EXIT_CODE(run, 1);
      EXPECT_THAT(Lines(run.err),
                  ElementsAre(AllOf(HasSubstr("29 of 30 files are calibrated already"),
                                    HasSubstr("begin again with the files as they were"))));
      EXPECT_THAT(run.out, IsEmpty());
    }
  }
  EXPECT_EQ(ReadText(matches + "/000006.matches"), before);
  EXPECT_EQ(ReadText(matches + "/000007.matches"), untouched);
  EXPECT_FALSE(std::filesystem::exists(Path("out")));

  // Of two calibrations, as an interrupted second one leaves them.
  WriteText(matches + "/000007.matches",
            "# rigel_calibrate_prior gravity turned by 3.5 deg\n" + untouched);
  const Outcome two =
      RunTool("calibrate_prior", {"--matches=" + matches, "--in_place", "--lines=gravity"});
  EXPECT_EXIT_CODE(two, 1);
  EXPECT_THAT(Lines(two.err), ElementsAre(HasSubstr("calibrated by 2 different runs")));
}

// Killed while the files took their places: all were written, some under their temporary names.
TEST_F(CalibratePriorTest, WhatAKilledRunHadWrittenIsFinished) {
  namespace fs = std::filesystem;
  const std::string matches = Misaligned("in");
  fs::copy(matches, Path("before"));
  const Args args = {"--matches=" + matches, "--in_place", "--lines=normal,gravity"};
  ASSERT_EXIT_CODE(RunTool("calibrate_prior", args), 0);
  fs::copy(matches, Path("whole"));
  for (const char* name : {"/000007.matches", "/000021.matches", "/000029.matches"}) {
    fs::rename(matches + name, matches + name + ".rigel-tmp0");
    fs::copy(Path("before") + name, matches + name);
  }
  const Outcome run = RunTool("calibrate_prior", args);
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err),
              ElementsAre("finished an interrupted run: replaced 3 of 30 files",
                          "nothing is written: all 30 files are calibrated so already"));
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(matches)) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(ReadText(entry.path().string()), ReadText(Path("whole/") + name)) << name;
    ++files;
  }
  EXPECT_EQ(files, 30u);

  // Killed before any was in its place: they are as if that run had never been.
  WriteText(Path("before/000003.matches.rigel-tmp0"), ReadText(matches + "/000003.matches"));
  const Args again = {"--matches=" + Path("before"), "--in_place", "--lines=normal,gravity"};
  EXPECT_EXIT_CODE(RunTool("calibrate_prior", again), 0);
  EXPECT_FALSE(fs::exists(Path("before/000003.matches.rigel-tmp0")));
  EXPECT_EQ(ReadText(Path("before/000003.matches")), ReadText(matches + "/000003.matches"));
}

TEST_F(CalibratePriorTest, InPlaceOfABrokenFileWritesNone) {
  const std::string matches = Misaligned("in");
  WriteText(matches + "/000003.matches", "format rigmatch 1\nnormal 0 0\n");
  WriteText(matches + "/000029.matches", "");
  const std::string before = ReadText(matches + "/000000.matches");
  const Outcome run = RunTool("calibrate_prior", {"--matches=" + matches, "--in_place"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err),
              ElementsAre(HasSubstr("000003.matches:2: 3 columns"), HasSubstr("000029.matches"),
                          HasSubstr("nothing is written: --in_place needs all of the files, 2 of "
                                    "30 cannot be used")));
  EXPECT_EQ(ReadText(matches + "/000000.matches"), before);
}

TEST_F(CalibratePriorTest, OutputWithOtherMatchFilesIsRefused) {
  const std::string matches = Misaligned("in");
  // Its own work it does again.
  for (int k = 0; k < 2; ++k) {
    ASSERT_EXIT_CODE(
        RunTool("calibrate_prior", {"--matches=" + matches, "--output=" + Path("out")}), 0);
  }
  // Another's file, of a name of its own or not.
  const std::string originals = Simulate("originals", {"--pairs=1", "--num_matches=60"});
  for (const char* name : {"000004.matches", "other.matches"}) {
    const std::string out = Path(std::string("out_of_") + name);
    std::filesystem::create_directory(out);
    std::filesystem::copy(originals + "/000000.matches", out + "/" + name);
    const std::string before = ReadText(out + "/" + name);
    const Outcome run = RunTool("calibrate_prior", {"--matches=" + matches, "--output=" + out});
    EXPECT_EXIT_CODE(run, 1);
    EXPECT_THAT(
        Lines(run.err),
        ElementsAre(AllOf(HasSubstr(std::string("holds ") + name + ", not written by this run"),
                          HasSubstr("empty the directory or name another"))));
    EXPECT_EQ(ReadText(out + "/" + name), before);
  }
}

TEST_F(CalibratePriorTest, CamerasOfTwoVehiclesAreRefused) {
  const std::string matches = Misaligned("in");
  FramePair pair = Read(matches).back();
  pair.rig.cameras[1].intrinsics.parameters[0] += 1;
  std::string error;
  ASSERT_TRUE(WriteMatchFile(pair.name, pair, &error)) << error;
  const Outcome run =
      RunTool("calibrate_prior", {"--matches=" + matches, "--output=" + Path("out")});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(Lines(run.err),
              ElementsAre(AllOf(HasSubstr("of one vehicle: cameras differ between"),
                                HasSubstr("000000.matches and "), HasSubstr("000029.matches"))));
  EXPECT_FALSE(std::filesystem::exists(Path("out")));
}

TEST_F(CalibratePriorTest, WrongFlagsAreUsageErrors) {
  for (const Args& args : std::vector<Args>{{"--lines="},
                                            {"--lines=normal,plane"},
                                            {"--solver=5pt"},
                                            {"--refine=none"},
                                            {"--lines=gravity", "--prior=body"},
                                            {"--in_place", "--output=x"},
                                            {"--shard=0/2"}}) {
    const Outcome run =
        RunTool("calibrate_prior", Args{"--matches=/proc/nonexistent/of/rigel"} + args);
    EXPECT_EXIT_CODE(run, 2);
    EXPECT_THAT(run.err, Not(HasSubstr("/nonexistent")));
  }
  EXPECT_EXIT_CODE(RunTool("calibrate_prior", {}), 2);
  const Outcome help = RunTool("calibrate_prior", {"--help"});
  EXPECT_EXIT_CODE(help, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("--lines=normal"), HasSubstr("--in_place")));
  EXPECT_LE(Width(help.out), 100u);
}

// A plane that a point moves in is that of all its body: a lever of 30 m must not blur it.
TEST_F(CalibratePriorTest, TheBodysOriginMayBeAnywhere) {
  const std::string matches = Misaligned("in");
  const auto calibrated = [&] {
    const Outcome run = RunTool("calibrate_prior", {"--matches=" + matches, "--json=-"});
    EXPECT_EXIT_CODE(run, 0);
    return ParseReport(run.out)["plane"];
  };
  const Json near = calibrated();
  const Eigen::Vector3d origin(10.0, 5.0, -30.0);
  for (FramePair& pair : Read(matches)) {
    pair.rig = WithOrigin(pair.rig, origin);
    if (pair.truth) pair.truth = MotionOfPoint(*pair.truth, origin);
    std::string error;
    ASSERT_TRUE(WriteMatchFile(pair.name, pair, &error)) << error;
  }
  const Json far = calibrated();
  EXPECT_EQ(far["level"], near["level"]);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(far["normal"][k].get<double>(), near["normal"][k].get<double>(), 1e-6);
  }
}

}  // namespace
}  // namespace rigel
