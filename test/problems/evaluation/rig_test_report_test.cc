// What is told of a rig that is off, and that nothing is told of a right one.
#include "rigel/problems/evaluation/rig_test_report.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The score of two cameras for a pitch (degrees) that is known to 0.001 degrees.
RigScore ScoreOfPitch(double pitch_deg) {
  RigScore score;
  score.num_pairs = 1;
  score.information = Eigen::Matrix3d::Identity() / std::pow(DegToRad(0.001), 2);
  score.variance = score.information;
  score.gradient = -score.information.col(0) * DegToRad(pitch_deg);
  score.by_calibration.resize(3, 0);
  return score;
}

EstimateReport ReportOf(const std::vector<double>& pitch_deg) {
  EstimateReport report;
  for (const double pitch : pitch_deg) {
    report.pairs.emplace_back();
    report.matches.emplace_back();
    report.estimates.emplace_back();
    report.estimates.back().refine.rig_score = ScoreOfPitch(pitch);
  }
  return report;
}

TEST(RigTestReport, ATurnIsTold) {
  const RigTest test = TestRigOfRun(ReportOf({-0.049, -0.051, -0.050, -0.050}));
  EXPECT_EQ(test.num_pairs, 4);
  const std::string line = RigTestLine(test);
  EXPECT_THAT(line, HasSubstr("camera 1: pitch -0.050 +- 0.0"));
  EXPECT_THAT(line, HasSubstr(" deg in 4 pairs (p < 1e-9)"));
  EXPECT_THAT(line, Not(HasSubstr("yaw")));
  const nlohmann::ordered_json json = RigTestJson(test);
  EXPECT_EQ(json["pairs"], 4);
  EXPECT_EQ(json["degrees_of_freedom"], 3);
  EXPECT_LT(json["p"].get<double>(), 1e-9);
  EXPECT_LT(json["p_with_calibration"].get<double>(), 1e-9);
  ASSERT_EQ(json["cameras"].size(), 1u);
  EXPECT_EQ(json["cameras"][0]["camera"], 1);
  EXPECT_NEAR(json["cameras"][0]["turn_deg"]["pitch"].get<double>(), -0.05, 1e-9);
  EXPECT_GT(json["cameras"][0]["turn_sd_deg"]["roll"].get<double>(), 0.0);
}

// However sure it is: no calibration is free of such a turn.
TEST(RigTestReport, ATurnThatEveryCalibrationHasIsNotTold) {
  const RigTest test = TestRigOfRun(ReportOf(std::vector<double>(100, 0.001)));
  EXPECT_LT(test.p, 1e-9);
  EXPECT_EQ(RigTestLine(test), "");
  EXPECT_EQ(RigTestLine(RigTest()), "");
}

TEST(RigTestReport, PairsOfAnotherRigAreLeftOut) {
  EstimateReport report = ReportOf({0.0, 0.3, 0.0});
  report.matches[1].rig = 7;
  const RigTest test = TestRigOfRun(report);
  EXPECT_EQ(test.num_pairs, 2);
  EXPECT_EQ(RigTestLine(test), "");
  // Without a minimum there is no score.
  report.estimates[0].refine.rig_score = RigScore();
  report.estimates[2].refine.rig_score = RigScore();
  EXPECT_EQ(TestRigOfRun(report).num_pairs, 1);
}

TEST(RigTestReport, RigsHaveNumbers) {
  Rig rig;
  rig.cameras.resize(2);
  Rig other = rig;
  EXPECT_EQ(RigNumber(rig), RigNumber(other));
  other.cameras[1].s.x() = 1e-9;
  EXPECT_NE(RigNumber(rig), RigNumber(other));
}

}  // namespace
}  // namespace rigel
