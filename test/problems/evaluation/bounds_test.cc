// Bounds on a report's statistics: what is refused, what is missed and what is not.
#include "rigel/problems/evaluation/bounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/evaluation/comparison_report.h"

namespace rigel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

SolverSummary Entry(const std::string& solver, const std::string& sequence = "all") {
  SolverSummary s;
  s.solver = solver;
  s.sequence = sequence;
  s.pairs = 20;
  s.failures = 1;
  s.direction_pairs = 19;
  s.raw_rotation_deg = Statistics{0.08, 0.1, 0.12, 0.2};
  s.refined_rotation_deg = Statistics{0.02, 0.03, 0.04, 0.05};
  s.refined_direction_deg = Statistics{0.2, 0.3, 0.4, 0.5};
  return s;
}

std::vector<std::string> Missed(const std::string& fail_above,
                                const std::vector<SolverSummary>& entries) {
  ReportBounds bounds;
  std::string error;
  EXPECT_TRUE(ParseStatisticBounds(fail_above, &bounds.statistics, &error)) << error;
  return MissedBounds(bounds, entries);
}

std::vector<std::string> MissedBaseline(const SolverSummary& before, const SolverSummary& now,
                                        double tolerance) {
  ReportBounds bounds;
  bounds.baseline = {before};
  bounds.tolerance = tolerance;
  return MissedBounds(bounds, {now});
}

TEST(StatisticBounds, AnyNumberOfAnEntryCanBeBounded) {
  std::vector<StatisticBound> bounds;
  std::string error;
  ASSERT_TRUE(
      ParseStatisticBounds("refined.rotation_deg.median:0.03,5pt+1/time_ms.ransac.p90:1e1,"
                           "failures:0,nees.ratio:2",
                           &bounds, &error))
      << error;
  ASSERT_THAT(bounds, SizeIs(4));
  EXPECT_EQ(bounds[0].solver, "");
  EXPECT_EQ(bounds[0].statistic, "refined.rotation_deg.median");
  EXPECT_EQ(bounds[0].limit, 0.03);
  EXPECT_EQ(bounds[1].solver, "5pt+1");
  EXPECT_EQ(bounds[1].statistic, "time_ms.ransac.p90");
  EXPECT_EQ(bounds[1].limit, 10.0);
}

TEST(StatisticBounds, WhatIsNoBoundIsToldWithWhatWasExpected) {
  const std::pair<const char*, const char*> wrong[] = {
      {"refined.rotation_deg.median", "expected STATISTIC:LIMIT"},
      {"refined.rotation_deg.median:", "expected STATISTIC:LIMIT"},
      {"refined.rotation_deg.median:nan", "expected STATISTIC:LIMIT"},
      {"refined.rotation_deg.median:0.03deg", "expected STATISTIC:LIMIT"},
      {":1", "no such statistic"},
      {"refined.rotation_deg:1", "no such statistic"},
      {"refined.rotation_deg.max:1", "no such statistic"},
      {"solver:1", "no such statistic"},
      {"4pt-axes/failures:1", "there is no solver '4pt-axes'"},
      {"failures:1,\x1b[31m:1", "\\x1b"},
      {",", "no bound in ','"},
  };
  for (const auto& [text, what] : wrong) {
    std::vector<StatisticBound> bounds(1);
    std::string error;
    EXPECT_FALSE(ParseStatisticBounds(text, &bounds, &error)) << text;
    EXPECT_THAT(error, HasSubstr(what)) << text;
    EXPECT_THAT(bounds, SizeIs(1)) << "changed by " << text;
  }
}

TEST(StatisticBounds, AboveIsMissedAndEqualIsNot) {
  const std::vector<SolverSummary> entries = {Entry("4pt"), Entry("3pt"), Entry("4pt", "06")};
  EXPECT_THAT(Missed("refined.rotation_deg.median:0.02,failures:1", entries), IsEmpty());
  EXPECT_THAT(Missed("refined.rotation_deg.median:0.0199", entries),
              ElementsAre("--fail_above: 4pt: refined.rotation_deg.median is 0.02, above 0.0199",
                          "--fail_above: 3pt: refined.rotation_deg.median is 0.02, above 0.0199"));
  EXPECT_THAT(Missed("3pt/failures:0", entries),
              ElementsAre("--fail_above: 3pt: failures is 1, above 0"));
}

TEST(StatisticBounds, WhatIsMissingIsMissed) {
  EXPECT_THAT(Missed("refined.scale.median:5", {Entry("4pt")}),
              ElementsAre("--fail_above: 4pt: refined.scale.median is missing, the bound is 5"));
  EXPECT_THAT(Missed("3pt/failures:5", {Entry("4pt")}),
              ElementsAre(HasSubstr("3pt: failures is missing, the report does not have")));
}

TEST(MaxFailures, AreOfEachSolver) {
  ReportBounds bounds;
  bounds.max_failures = 0;
  EXPECT_THAT(MissedBounds(bounds, {Entry("4pt"), Entry("4pt", "06")}),
              ElementsAre("--max_failures: 4pt: failures is 1, above 0"));
  bounds.max_failures = 1;
  EXPECT_THAT(MissedBounds(bounds, {Entry("4pt")}), IsEmpty());
}

TEST(Baseline, IsKeptByItselfAndWithinTheTolerance) {
  const SolverSummary before = Entry("4pt");
  EXPECT_THAT(MissedBaseline(before, before, 0.0), IsEmpty());
  SolverSummary now = before;
  now.refined_rotation_deg->rms *= 1.04;
  now.raw_rotation_deg->rms *= 3.0;  // the refined one counts
  now.inlier_ratio = Statistics{};
  EXPECT_THAT(MissedBaseline(before, now, 0.05), IsEmpty());
  EXPECT_THAT(MissedBaseline(before, now, 0.03),
              ElementsAre("--baseline: 4pt: refined.rotation_deg.rms is 0.0416, above 0.0412; it "
                          "was 0.04"));
}

TEST(Baseline, LessThanItHadIsMissed) {
  const SolverSummary before = Entry("4pt", "06");
  SolverSummary now = before;
  now.pairs = 19;
  now.failures = 2;
  now.direction_pairs = 17;
  now.refined_direction_deg.reset();
  EXPECT_THAT(
      MissedBaseline(before, now, 0.05),
      ElementsAre("--baseline: 4pt, sequence 06: pairs is 19, it was 20",
                  "--baseline: 4pt, sequence 06: failures is 2, above 1.05; it was 1",
                  HasSubstr("refined.translation_dir_deg.median is missing, it was 0.2"),
                  HasSubstr("translation_dir_deg.mean is missing"),
                  HasSubstr("translation_dir_deg.rms is missing"),
                  HasSubstr("translation_dir_deg.p90 is missing"),
                  "--baseline: 4pt, sequence 06: direction_pairs is 17, below 18.05; it was 19"));
  EXPECT_THAT(MissedBaseline(before, Entry("3pt", "06"), 0.05),
              ElementsAre("--baseline: 4pt, sequence 06: is missing, it was there"));
}

TEST(Baseline, WithoutARefinementTheRawErrorsCount) {
  SolverSummary before = Entry("4pt");
  before.refined_rotation_deg.reset();
  before.refined_direction_deg.reset();
  SolverSummary now = before;
  now.raw_rotation_deg->median = 0.1;
  EXPECT_THAT(MissedBaseline(before, now, 0.05),
              ElementsAre(HasSubstr("raw.rotation_deg.median is 0.1, above 0.084; it was 0.08")));
}

TEST(Baseline, RoundingOfNoiseFreeFilesIsNoError) {
  SolverSummary before = Entry("4pt");
  before.refined_rotation_deg = Statistics{1e-13, 1e-13, 1e-13, 1e-13};
  SolverSummary now = before;
  now.refined_rotation_deg = Statistics{5e-13, 5e-13, 5e-13, 5e-13};
  EXPECT_THAT(MissedBaseline(before, now, 0.05), IsEmpty());
}

TEST(Baseline, IsReadFromAReport) {
  ComparisonReport report;
  report.solvers = {{"4pt", {}}};
  std::vector<SolverSummary> baseline;
  std::string error;
  ASSERT_TRUE(ParseBaseline(ComparisonJson(report, {Entry("4pt"), Entry("4pt", "06")}, false),
                            "r.json", &baseline, &error))
      << error;
  ASSERT_THAT(baseline, SizeIs(2));
  EXPECT_EQ(baseline[1].sequence, "06");
  EXPECT_EQ(baseline[1].refined_rotation_deg->p90, 0.05);

  const std::pair<std::string, const char*> wrong[] = {
      {"", "r.json: not a report of rigel_compare: "},
      {"{\"format\": \"rigel-estimate 1\"}", "its format is not 'rigel-report 1'"},
      {"{\"format\": \"rigel-report 1\", \"results\": []}", "it has no results"},
      {"{\"format\": \"rigel-report 1\", \"results\": [3]}", "r.json: "},
      {"{\"format\": \"rigel-report 1\", \"results\": [{\"solver\": \"4pt\", \"sequence\": "
       "\"all\", \"pairs\": 1e300}]}",
       "expected an integer"},
      {std::string(100000, '['), "nested"},
      {"{\"format\": \"rigel-report 1\", \"results\": [{\"solver\": \"4pt\", \"sequence\": "
       "\"all\", \"pairs\": 1, \"failures\": 0, \"direction_pairs\": 1, \"refined\": [[[]]]}]}",
       "refined is not an object"},
  };
  for (const auto& [text, what] : wrong) {
    EXPECT_FALSE(ParseBaseline(text, "r.json", &baseline, &error)) << text;
    EXPECT_THAT(error, HasSubstr(what));
    EXPECT_THAT(error, testing::Not(HasSubstr("\n")));
  }
}

}  // namespace
}  // namespace rigel
