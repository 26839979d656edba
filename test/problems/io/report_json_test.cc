#include "rigel/problems/io/report_json.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/evaluation/estimate_report.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ReportJson, WhatIsNotFiniteIsLeftOut) {
  Json json = {{"a", 1.5}, {"b", kNan}, {"c", {1.0, kInf}}, {"d", {{"e", -kInf}, {"f", 2}}}};
  json["g"] = Json::array({Json::array({1.0, 2.0}), Json::array({kNan, 4.0})});
  json["h"] = "nan";
  json["i"] = Json::array();
  EXPECT_EQ(JsonText(json, -1), R"({"a":1.5,"d":{"f":2},"h":"nan","i":[]})");
  EXPECT_EQ(JsonText(json["a"], -1), "1.5");
  EXPECT_EQ(JsonText(Json({{"text", "\xff"}}), -1), "{\"text\":\"\xef\xbf\xbd\"}");
}

// Whoever fills a report himself may have anything in it.
TEST(ReportJson, AnEstimateOfNumbersThatAreNoneHasNoNull) {
  EstimateReport report;
  FramePair pair;
  pair.name = "a.matches";
  pair.time1 = kNan;
  pair.time2 = 1.0;
  MotionEstimate estimate;
  estimate.status = EstimateStatus::kSuccess;
  estimate.pose.t.x() = kInf;
  estimate.raw.R(0, 0) = kNan;
  estimate.ransac_ms = kNan;
  estimate.refine.termination = Termination::kConverged;
  estimate.refine.median_residual_px = kNan;
  estimate.refine.noise_px = kInf;
  estimate.refine.rotation_sigma = kNan;
  estimate.refine.covariance = Matrix6d::Constant(kNan);
  report.pairs.push_back(pair);
  report.estimates.push_back(estimate);
  report.matches.push_back({10, false});
  const std::string text = EstimateJson(report, /*times=*/true);
  EXPECT_THAT(text, Not(HasSubstr("null")));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  const Json entry = Json::parse(text)["pairs"][0];
  EXPECT_EQ(entry["matches"], 10);
  for (const char* key : {"time", "covariance", "noise_px", "median_residual_px"}) {
    EXPECT_FALSE(entry.contains(key)) << key;
  }
  EXPECT_FALSE(entry["refined"].contains("t"));
}

}  // namespace
}  // namespace rigel
