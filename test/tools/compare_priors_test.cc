// rigel_compare: priors that are missing, wrong, or of no use to a solver.
#include "rigel/test/tools/compare_runs.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

TEST_F(CompareTest, PriorThatCannotBeWeighedIsToldOnceForAllSolvers) {
  const std::string matches = Simulate("in", {"--pairs=2", "--num_matches=40"});
  const Outcome run = RunTool("compare", {"--matches=" + matches, "--solvers=4pt,4pt-axis,17pt-li",
                                          "--use_prior_in_refine"});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err), ElementsAre(HasSubstr("in 2 of 2 pairs")));
}

TEST_F(CompareTest, PairWithoutThePriorOfItsSolverIsAFailureAndNoError) {
  const std::string matches = Simulate("in", {"--pairs=3", "--inter_share=0.5"});
  RemoveLine(matches + "/000001.matches", "axis");
  const Outcome run =
      RunTool("compare", {"--matches=" + matches, "--solvers=4pt-axis", "--json=-"});
  EXPECT_EXIT_CODE(run, 0);
  EXPECT_THAT(Lines(run.err),
              ElementsAre(AllOf(HasSubstr("000001.matches: 4pt-axis: the prior has no axis"),
                                HasSubstr("--prior=body"))));
  const Json entry = ParseReport(run.out)["results"][0];
  EXPECT_EQ(entry["pairs"], 3);
  EXPECT_EQ(entry["failures"], 1);
  EXPECT_EQ(entry["direction_pairs"], 2);
  EXPECT_TRUE(entry.contains("bound"));

  // Nobody has a normal, and so nobody a motion.
  const Outcome nobody = RunTool("compare", {"--matches=" + matches, "--solvers=3pt", "--json=-"});
  EXPECT_EXIT_CODE(nobody, 1);
  EXPECT_THAT(Lines(nobody.err),
              ElementsAre(AllOf(HasSubstr("000000.matches: 3pt: the prior has no normal"),
                                HasSubstr("(3 files alike)")),
                          "no pair has a motion"));
  EXPECT_THAT(RunTool("compare", {"--matches=" + matches, "--solvers=4pt,3pt"}).out,
              EndsWith("\n3pt: the prior has no normal in any pair; see --prior\n"));
  const Json all = ParseReport(nobody.out)["results"][0];
  EXPECT_THAT(Keys(all),
              UnorderedElementsAre("solver", "sequence", "pairs", "failures", "direction_pairs"));
  EXPECT_EQ(all["failures"], 3);

  // Solvers are chosen by what all pairs have.
  std::vector<std::string> solvers;
  const Json chosen = Compare({"--matches=" + matches});
  for (const Json& e : chosen["results"]) solvers.push_back(e["solver"]);
  EXPECT_THAT(solvers, Contains("4pt"));
  EXPECT_THAT(solvers, Not(Contains("4pt-axis")));
  EXPECT_THAT(solvers, Not(Contains("3pt")));
}

TEST_F(CompareTest, PriorFromBodyTruthAndWithNoise) {
  // A random axis: the body's Y is a bad prior, the truth a good one.
  const std::string matches =
      Simulate("in", {"--pairs=24", "--inter_share=0.5", "--rotation_axis=random",
                      "--rotation_deg=3", "--motion=random"});
  const auto raw_rotation = [&](const Args& more) {
    return Entry(Args{"--matches=" + matches, "--solvers=4pt", "--refine=none"} +
                 more)["raw"]["rotation_deg"]["median"]
        .get<double>();
  };
  const double file = raw_rotation({});
  EXPECT_LT(file, 0.3);
  EXPECT_LT(raw_rotation({"--prior=truth"}), 0.3);
  EXPECT_GT(raw_rotation({"--prior=body"}), 1.0);
  // An error of exactly that angle is inherited by the raw motion.
  for (const char* axis : {"pitch", "roll"}) {
    const Args noise = {"--prior_noise_deg=2", std::string("--prior_noise_axis=") + axis};
    EXPECT_NEAR(raw_rotation(noise), 2.0, 0.3) << axis;
  }
  EXPECT_GT(raw_rotation({"--prior_noise_deg=2", "--prior_noise_axis=random"}), 0.5);

  // Without any prior in the files.
  for (int k = 0; k < 24; ++k) {
    for (const char* line : {"gravity1", "gravity2", "axis"}) {
      RemoveLine(matches + "/0000" + (k < 10 ? "0" : "") + std::to_string(k) + ".matches", line);
    }
  }
  EXPECT_EQ(Entry({"--matches=" + matches, "--solvers=4pt-axis", "--prior=truth"})["failures"], 0);
  const Outcome none = RunTool(
      "compare", {"--matches=" + matches, "--solvers=4pt-axis", "--prior=file", "--json=-"});
  EXPECT_EXIT_CODE(none, 1);
  EXPECT_EQ(ParseReport(none.out)["results"][0]["failures"], 24);
}

TEST_F(CompareTest, RefinementMayLeaveAWrongPriorOrHoldItExact) {
  const std::string matches = Simulate("in", {"--pairs=8", "--inter_share=0.5"});
  const auto refined = [&](const Args& more) {
    return Entry(Args{"--matches=" + matches, "--solvers=4pt", "--prior_noise_deg=1"} +
                 more)["refined"]["rotation_deg"]["median"]
        .get<double>();
  };
  EXPECT_LT(refined({}), 0.2);
  EXPECT_LT(refined({"--refine=depths"}), 0.5);
  EXPECT_GT(refined({"--refine=prior"}), 0.9);
  EXPECT_GT(refined({"--refine=prior-depths"}), 0.9);
  // A stated sigma of a thousandth of the error pulls the motion back to the prior.
  EXPECT_GT(refined({"--use_prior_in_refine", "--prior_sigma_deg=0.001"}), 0.9);
  EXPECT_LT(refined({"--prior_sigma_deg=0.001"}), 0.2);  // stated, not asked for
}

TEST_F(CompareTest, FormThatNeedsAPriorIsRefusedForASolverWithoutOne) {
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=60"});
  const Outcome run = RunTool(
      "compare", {"--matches=/proc/nonexistent/of/rigel", "--solvers=4pt,5pt+1", "--refine=prior"});
  EXPECT_EXIT_CODE(run, 2);
  EXPECT_THAT(run.err, AllOf(HasSubstr("5pt+1"), Not(HasSubstr("/nonexistent"))));
  // Without names, those that can.
  const Json report = Compare({"--matches=" + matches, "--refine=prior"});
  EXPECT_FALSE(report["results"].empty());
  for (const Json& entry : report["results"]) {
    EXPECT_NE(entry["solver"], "5pt+1");
  }
}

TEST_F(CompareTest, NoSolverFitsFilesWithoutPriors) {
  // Solvers without a prior always fit; the family's do not.
  const std::string matches = Simulate("in", {"--pairs=1", "--num_matches=60"});
  for (const char* line : {"gravity1", "gravity2", "axis"}) {
    RemoveLine(matches + "/000000.matches", line);
  }
  const Outcome run = RunTool("compare", {"--matches=" + matches, "--refine=prior"});
  EXPECT_EXIT_CODE(run, 1);
  EXPECT_THAT(run.err, HasSubstr("try --prior=body"));
}

// By name: what auto would doubt is told, and is in the report of the pairs.
TEST_F(CompareTest, AWrongPriorOfANamedSolverIsTold) {
  const std::string matches =
      Simulate("in", {"--pairs=4", "--rotation_deg=12", "--num_matches=400"});
  const Outcome right = RunTool("compare", {"--matches=" + matches, "--solvers=4pt"});
  EXPECT_THAT(right.err, Not(HasSubstr("doubtful")));
  const Outcome run = RunTool(
      "compare", {"--matches=" + matches, "--solvers=4pt,auto", "--prior=truth",
                  "--prior_noise_deg=8", "--prior_noise_axis=random", "--per_pair", "--json=-"});
  EXPECT_THAT(Lines(run.err), testing::Contains(testing::AllOf(HasSubstr("doubtful: 4pt: "),
                                                               HasSubstr("check the prior"))));
  const Json report = ParseReport(run.out);
  int doubtful = 0;
  for (const Json& pair : report["pair_results"]) {
    const Json& result = pair["solvers"]["4pt"];
    if (!result.contains("doubtful")) continue;
    ++doubtful;
    EXPECT_NE(result["reason"], "");
  }
  EXPECT_GT(doubtful, 0);
}

}  // namespace
}  // namespace rigel
