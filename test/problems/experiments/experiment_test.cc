#include "rigel/problems/experiments/experiment.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/metrics.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/problems/experiments/experiment_report.h"

namespace rigel {
namespace {

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

ExperimentPlan Plan(const std::string& name, int pairs = 4) {
  ExperimentOptions options;
  options.quick = true;
  options.pairs = pairs;
  ExperimentPlan plan;
  std::string error;
  EXPECT_TRUE(PlanExperiment(*FindExperiment(name), options, &plan, &error)) << error;
  return plan;
}

FramePair Make(const ExperimentPlan& plan, const ExperimentPoint& point, int index) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeExperimentPair(plan, point, index, &pair, &error)) << error;
  return pair;
}

TEST(Experiment, TheCatalogueIsSound) {
  std::set<std::string> names;
  for (const ExperimentSpec& spec : ExperimentCatalogue()) {
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_EQ(FindExperiment(spec.name), &spec);
    EXPECT_FALSE(spec.motions.empty());
    for (const std::string& solver : spec.solvers) {
      const SolverInfo* info = FindSolver(solver);
      ASSERT_NE(info, nullptr) << solver;
      EXPECT_TRUE(spec.planar || info->prior != PriorKind::kPlanar ||
                  spec.variable == ExperimentVariable::kNone)
          << spec.name << ": there is no plane for " << solver;
    }
    for (const auto& values : {spec.values, spec.quick_values}) {
      EXPECT_TRUE(std::is_sorted(values.begin(), values.end())) << spec.name;
    }
  }
  EXPECT_EQ(FindExperiment("no-such"), nullptr);
}

TEST(Experiment, PriorsAreOffByExactlyTheAngleAboutTheAxis) {
  for (const char* name : {"pitch-noise", "roll-noise"}) {
    const ExperimentPlan plan = Plan(name);
    const Eigen::Vector3d about =
        name == std::string("pitch-noise") ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
    std::set<double> signs;
    for (int k = 0; k < 12; ++k) {
      const FramePair exact = Make(plan, {"random", "", 0.0}, k);
      const FramePair off = Make(plan, {"random", "", 0.3}, k);
      EXPECT_NEAR(AngleDeg(*exact.prior.gravity2, exact.truth->R * *exact.prior.gravity1), 0, 1e-9);
      EXPECT_TRUE(*off.prior.gravity1 == *exact.prior.gravity1);
      // The turn about the axis that takes one to the other is of 0.3 degrees, of either sign.
      const auto turned = [&](const Eigen::Vector3d& v, double deg) -> Eigen::Vector3d {
        return ExpSO3(DegToRad(deg) * about) * v;
      };
      const double sign =
          AngleDeg(turned(*exact.prior.gravity2, 0.3), *off.prior.gravity2) < 1e-9 ? 1.0 : -1.0;
      signs.insert(sign);
      EXPECT_NEAR(AngleDeg(turned(*exact.prior.gravity2, 0.3 * sign), *off.prior.gravity2), 0,
                  1e-9);
      EXPECT_NEAR(AngleDeg(turned(*exact.prior.axis, 0.3 * sign), *off.prior.axis), 0, 1e-9)
          << "the axis is off by the same turn";
    }
    EXPECT_EQ(signs.size(), 2u) << "both signs occur";
  }
}

TEST(Experiment, NonPlanarMotionTellsTheAxisFromTheVertical) {
  const ExperimentPlan plan = Plan("image-noise");
  for (int k = 0; k < 5; ++k) {
    const FramePair pair = Make(plan, {"forward", "", 0.5}, k);
    EXPECT_NEAR(RadToDeg(LogSO3(pair.truth->R).norm()), 1.0, 1e-9);
    EXPECT_GT(AngleDeg(*pair.prior.axis, Eigen::Vector3d::UnitY()), 1.0);
    EXPECT_TRUE(pair.truth->t == Eigen::Vector3d::UnitZ());
    EXPECT_EQ(pair.noise_px, 0.5);
    for (const Match& match : pair.matches) EXPECT_TRUE(match.IsIntra());
  }
}

TEST(Experiment, ImageNoiseScalesTheSameNoise) {
  const ExperimentPlan plan = Plan("image-noise");
  const FramePair none = Make(plan, {"random", "", 0.0}, 3);
  const FramePair half = Make(plan, {"random", "", 0.5}, 3);
  const FramePair full = Make(plan, {"random", "", 1.0}, 3);
  EXPECT_FALSE(none.noise_px.has_value());
  double sum2 = 0.0;
  for (size_t k = 0; k < none.matches.size(); ++k) {
    const Eigen::Vector2d d = full.matches[k].pixel2 - none.matches[k].pixel2;
    EXPECT_LT((2.0 * (half.matches[k].pixel2 - none.matches[k].pixel2) - d).norm(), 1e-9);
    sum2 += d.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(sum2 / (2.0 * none.matches.size())), 1.0, 0.15);
}

TEST(Experiment, PlanarMotionStaysInThePlaneAndVibrationLeavesIt) {
  for (const char* name : {"planar-image-noise", "planar-vibration"}) {
    const ExperimentPlan plan = Plan(name);
    for (const char* motion : {"forward", "random", "sideways"}) {
      const FramePair pair = Make(plan, {motion, "", 0.0}, 2);
      EXPECT_EQ(pair.truth->t.y(), 0.0) << name << " " << motion;
      EXPECT_NEAR(AngleDeg(LogSO3(pair.truth->R), Eigen::Vector3d::UnitY()), 0.0, 1e-9);
      EXPECT_TRUE(*pair.prior.normal == Eigen::Vector3d::UnitY());
    }
  }
  const ExperimentPlan plan = Plan("planar-vibration");
  double sum2 = 0.0;
  constexpr int kPairs = 400;
  for (int k = 0; k < kPairs; ++k) {
    const FramePair flat = Make(plan, {"random", "", 0.0}, k);
    const FramePair one = Make(plan, {"random", "", 1.0}, k);
    const FramePair two = Make(plan, {"random", "", 2.0}, k);
    EXPECT_NEAR(2.0 * one.truth->t.y(), two.truth->t.y(), 1e-12);
    EXPECT_EQ(one.truth->t.x(), flat.truth->t.x());
    EXPECT_EQ(one.truth->t.z(), flat.truth->t.z());
    EXPECT_TRUE(*one.prior.normal == Eigen::Vector3d::UnitY()) << "the prior does not know of it";
    sum2 += one.truth->t.y() * one.truth->t.y();
  }
  EXPECT_NEAR(std::sqrt(sum2 / kPairs), 0.01, 0.001) << "1 percent of |t| = 1 m";
}

TEST(Experiment, TheOtherVariablesDoWhatTheySay) {
  EXPECT_NEAR(
      RadToDeg(LogSO3(Make(Plan("rotation-angle"), {"random", "", 10.0}, 1).truth->R).norm()), 10.0,
      1e-9);
  EXPECT_EQ(Make(Plan("match-count"), {"random", "", 50.0}, 1).matches.size(), 50u);
  const FramePair inter = Make(Plan("inter-share"), {"random", "", 25.0}, 1);
  EXPECT_EQ(std::count_if(inter.matches.begin(), inter.matches.end(),
                          [](const Match& m) { return !m.IsIntra(); }),
            50);
  const ExperimentPlan outliers = Plan("outliers");
  const FramePair clean = Make(outliers, {"random", "", 0.0}, 1);
  const FramePair mixed = Make(outliers, {"random", "", 40.0}, 1);
  int moved = 0;
  for (size_t k = 0; k < clean.matches.size(); ++k) {
    moved += clean.matches[k].pixel2 != mixed.matches[k].pixel2;
  }
  EXPECT_EQ(moved, 80);
}

TEST(Experiment, ThePaperLoopIsPlainRansac) {
  const EstimateOptions paper = ExperimentEstimate("4pt", kPaperLoop, 0.5);
  EXPECT_EQ(paper.ransac.score, ScoreKind::kInlierCount);
  EXPECT_FALSE(paper.ransac.local_optimization);
  EXPECT_FALSE(paper.ransac.prosac);
  EXPECT_EQ(paper.ransac.num_finalists, 0);
  EXPECT_EQ(paper.ransac.threshold_px, 1.5);
  const EstimateOptions rigel = ExperimentEstimate("4pt", kRigelLoop, 1.0);
  EXPECT_EQ(rigel.ransac.score, EstimateOptions().ransac.score);
  EXPECT_EQ(rigel.ransac.max_iterations, EstimateOptions().ransac.max_iterations);
  EXPECT_EQ(rigel.ransac.threshold_px, 3.0);
  EXPECT_EQ(ExperimentEstimate("4pt", kRigelLoop, 0.0).ransac.threshold_px, 0.5);
}

std::vector<ExperimentRow> WithoutTimes(std::vector<ExperimentRow> rows) {
  for (ExperimentRow& row : rows) {
    row.summary.ransac_ms.reset();
    row.summary.refine_ms.reset();
  }
  return rows;
}

std::vector<ExperimentRow> RunPoint(const ExperimentPlan& plan, const ExperimentPoint& point,
                                    const std::vector<ExperimentRow>& earlier = {}) {
  std::vector<ExperimentRow> rows;
  std::string error;
  EXPECT_TRUE(RunExperimentPoint(plan, point, earlier, {}, &rows, &error)) << error;
  return WithoutTimes(rows);
}

TEST(Experiment, ResultsDoNotDependOnThreads) {
  ExperimentPlan plan = Plan("planar-image-noise", 6);
  const ExperimentPoint point{"random", "", 0.4};
  const std::string one = PointLine(point, RunPoint(plan, point), "");
  plan.options.num_threads = 4;
  EXPECT_EQ(PointLine(point, RunPoint(plan, point), ""), one);
}

// Taking over the rows of a solver without prior must change nothing.
TEST(Experiment, SolversWithoutPriorDoNotSeeItsError) {
  const ExperimentPlan plan = Plan("roll-noise", 3);
  const ExperimentPoint exact{"forward", "", 0.0}, off{"forward", "", 1.0};
  const std::vector<ExperimentRow> first = RunPoint(plan, exact);
  EXPECT_EQ(PointLine(off, RunPoint(plan, off, first), ""),
            PointLine(off, RunPoint(plan, off), ""));
  for (const ExperimentRow& row : first) {
    EXPECT_EQ(row.summary.pairs, 3);
    EXPECT_EQ(row.summary.failures, 0) << row.summary.solver;
  }
}

TEST(Experiment, RefinedIsBetterThanRawAndFlatUnderPriorNoise) {
  const ExperimentPlan plan = Plan("pitch-noise", 12);
  const auto find = [&](const std::vector<ExperimentRow>& rows) {
    for (const ExperimentRow& row : rows) {
      if (row.summary.solver == "4pt-approx" && row.loop == kRigelLoop) return row.summary;
    }
    ADD_FAILURE();
    return SolverSummary();
  };
  const SolverSummary exact = find(RunPoint(plan, {"random", "", 0.0}));
  const SolverSummary off = find(RunPoint(plan, {"random", "", 1.0}));
  EXPECT_LT(exact.refined_direction_deg->median, 0.6 * exact.raw_direction_deg->median);
  EXPECT_GT(off.raw_rotation_deg->median, 0.7);
  EXPECT_NEAR(off.refined_rotation_deg->median, exact.refined_rotation_deg->median, 0.01);
}

TEST(ExperimentReport, PointsComeBackToTheLastBit) {
  const ExperimentPlan plan = Plan("inter-share", 3);
  const ExperimentPoint point{"random", "", 25.0};
  std::vector<ExperimentRow> rows;
  std::string error;
  ASSERT_TRUE(RunExperimentPoint(plan, point, {}, {}, &rows, &error)) << error;
  const std::string line = PointLine(point, rows, "00ff");
  ExperimentPoint parsed_point;
  std::vector<ExperimentRow> parsed;
  std::string run;
  ASSERT_TRUE(ParsePointLine(line, &parsed_point, &parsed, &run, &error)) << error;
  EXPECT_TRUE(parsed_point == point);
  EXPECT_EQ(run, "00ff");
  EXPECT_EQ(PointLine(parsed_point, parsed, run), line);
  EXPECT_EQ(ExperimentJson(plan, parsed), ExperimentJson(plan, rows));
  EXPECT_EQ(ExperimentCsv(plan, parsed), ExperimentCsv(plan, rows));
  EXPECT_TRUE(parsed.front().summary.raw_scale.has_value());
  for (const char* wrong : {"", "{}", "[1]", "{\"motion\": 3, \"rows\": []}", "{\"motion\""}) {
    EXPECT_FALSE(ParsePointLine(wrong, &parsed_point, &parsed, &run, &error)) << wrong;
    EXPECT_FALSE(error.empty());
  }
}

}  // namespace
}  // namespace rigel
