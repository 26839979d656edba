// The verdicts, on results made up so that each holds or does not.
#include "rigel/problems/experiment_claims.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Median raw error, the same in rotation and direction.
using RawError = std::function<double(const ExperimentPoint&, const std::string& solver)>;

std::vector<ExperimentRow> MakeRows(const std::string& experiment, const RawError& raw,
                                    double refined_over_raw = 0.3) {
  const ExperimentSpec& spec = *FindExperiment(experiment);
  std::vector<ExperimentPoint> points;
  for (const std::string& motion : spec.motions) {
    for (const double x : spec.values) points.push_back({motion, "", x});
    if (spec.values.empty()) {
      for (const char* sequence : {"00", "01"}) points.push_back({motion, sequence, std::nullopt});
    }
  }
  std::vector<ExperimentRow> rows;
  for (const ExperimentPoint& point : points) {
    for (const std::string& solver : spec.solvers) {
      for (const char* loop : {kPaperLoop, kRigelLoop}) {
        const double error = raw(point, solver);
        SolverSummary s;
        s.solver = solver;
        s.pairs = 10;
        s.raw_rotation_deg = s.raw_direction_deg = Statistics{error, error, error, error};
        const double r = refined_over_raw * error;
        s.refined_rotation_deg = s.refined_direction_deg = Statistics{r, r, r, r};
        s.bound_rotation_deg = s.bound_direction_deg = s.refined_rotation_deg;
        s.iterations = Statistics{1000, 1000, 1000, 1000};
        s.ransac_ms = Statistics{error, error, error, error};
        rows.push_back({point, loop, s});
      }
    }
  }
  return rows;
}

// The claim whose text has `part`, of the experiment.
Claim Find(const ExperimentResults& results, const std::string& experiment,
           const std::string& part) {
  for (const Claim& claim : EvaluateClaims(results)) {
    if (claim.experiment == experiment && claim.text.find(part) != std::string::npos) return claim;
  }
  ADD_FAILURE() << "no claim of " << experiment << " with " << part;
  return {};
}

bool IsSixDof(const std::string& solver) {
  return solver == "17pt-li" || solver.rfind("6pt", 0) == 0;
}

TEST(ExperimentClaims, WithoutResultsNothingIsMeasured) {
  const std::vector<Claim> claims = EvaluateClaims({});
  EXPECT_GT(claims.size(), 30u);
  for (const Claim& claim : claims) {
    EXPECT_EQ(claim.verdict, Verdict::kNotMeasured) << claim.text;
    EXPECT_EQ(claim.figures + claim.why, "") << claim.text;
    EXPECT_NE(FindExperiment(claim.experiment), nullptr) << claim.experiment;
  }
}

TEST(ExperimentClaims, FourPointAgainstSixDof) {
  ExperimentResults results;
  results["image-noise"] = MakeRows("image-noise", [](const auto&, const std::string& solver) {
    return IsSixDof(solver) ? 0.2 : 0.1;
  });
  Claim claim = Find(results, "image-noise", "4-point solvers beat");
  EXPECT_EQ(claim.verdict, Verdict::kConfirmed);
  EXPECT_THAT(claim.figures, HasSubstr("forward, 0.5 px: 4-point 0.100, 6-DoF 0.200 deg"));
  EXPECT_EQ(claim.why, "");

  // One of the four is worse, sideways only: in 10 of 30 cases.
  results["image-noise"] = MakeRows("image-noise", [](const ExperimentPoint& point,
                                                      const std::string& solver) {
    return IsSixDof(solver) ? 0.2 : solver == "4pt-liu" && point.motion == "sideways" ? 0.3 : 0.1;
  });
  claim = Find(results, "image-noise", "4-point solvers beat");
  EXPECT_EQ(claim.verdict, Verdict::kNotConfirmed);
  EXPECT_THAT(claim.why, AllOf(HasSubstr("holds in 20 of 30 cases"), HasSubstr("sideways at 0.1"),
                               HasSubstr("worst 4-point 0.300, best 6-DoF 0.200")));

  // At one noise level of one motion: in most cases.
  results["image-noise"] =
      MakeRows("image-noise", [](const ExperimentPoint& point, const std::string& solver) {
        const bool worse = point == ExperimentPoint{"random", "", 1.0};
        return IsSixDof(solver) ? 0.2 : worse ? 0.3 : 0.1;
      });
  EXPECT_EQ(Find(results, "image-noise", "4-point solvers beat").verdict, Verdict::kPartly);
}

TEST(ExperimentClaims, AxisIsBestButSideways) {
  const auto best_but = [](const std::string& exception) {
    ExperimentResults results;
    results["image-noise"] =
        MakeRows("image-noise", [&](const ExperimentPoint& point, const std::string& solver) {
          const bool axis = solver == "4pt-axis-approx";
          return axis ? (point.motion == exception ? 0.2 : 0.05) : 0.1;
        });
    return Find(results, "image-noise", "4pt-axis-approx is the best").verdict;
  };
  EXPECT_EQ(best_but("sideways"), Verdict::kConfirmed);
  EXPECT_EQ(best_but("forward"), Verdict::kNotConfirmed);
}

TEST(ExperimentClaims, AboutEqualIsWithinAQuarter) {
  const auto verdict = [](double ratio) {
    ExperimentResults results;
    results["pitch-noise"] = MakeRows("pitch-noise", [&](const auto&, const std::string& solver) {
      return solver == "4pt-approx" ? 0.1 * ratio : 0.1;
    });
    return Find(results, "pitch-noise", "4pt-approx resists").verdict;
  };
  EXPECT_EQ(verdict(1.2), Verdict::kConfirmed);
  EXPECT_EQ(verdict(1.3), Verdict::kNotConfirmed);
  EXPECT_EQ(verdict(0.7), Verdict::kNotConfirmed);
}

TEST(ExperimentClaims, CrossingsAreInterpolated) {
  const auto crossing_at = [](double crossing) {
    ExperimentResults results;
    results["roll-noise"] =
        MakeRows("roll-noise", [&](const ExperimentPoint& point, const std::string& solver) {
          return IsSixDof(solver) ? 0.1 + crossing : 0.1 + *point.x;
        });
    return Find(results, "roll-noise", "become worse");
  };
  const Claim inside = crossing_at(0.33);
  EXPECT_EQ(inside.verdict, Verdict::kConfirmed);
  EXPECT_THAT(inside.figures, HasSubstr("sideways: 4pt-lee 0.33, 4pt-liu 0.33"));
  EXPECT_EQ(crossing_at(0.05).verdict, Verdict::kNotConfirmed);
  const Claim none = crossing_at(2.0);
  EXPECT_EQ(none.verdict, Verdict::kNotConfirmed);
  EXPECT_THAT(none.figures, HasSubstr("none to 1"));
}

TEST(ExperimentClaims, RefinedCurvesAreFlatOrNot) {
  const auto growing = [](double per_deg) {
    ExperimentResults results;
    results["pitch-noise"] =
        MakeRows("pitch-noise", [&](const ExperimentPoint& point, const std::string&) {
          return 0.1 * (1.0 + per_deg * *point.x);
        });
    return Find(results, "pitch-noise", "refined errors stay the same").verdict;
  };
  EXPECT_EQ(growing(0.05), Verdict::kConfirmed);
  EXPECT_EQ(growing(0.2), Verdict::kNotConfirmed);
}

TEST(ExperimentClaims, HalfOfRawAndTheBound) {
  const auto error = [](const auto&, const std::string&) { return 0.1; };
  ExperimentResults results;
  results["image-noise"] = MakeRows("image-noise", error, 0.4);
  EXPECT_EQ(Find(results, "image-noise", "at most half").verdict, Verdict::kConfirmed);
  EXPECT_EQ(Find(results, "image-noise", "Cramer-Rao").verdict, Verdict::kConfirmed);
  results["image-noise"] = MakeRows("image-noise", error, 0.6);
  EXPECT_EQ(Find(results, "image-noise", "at most half").verdict, Verdict::kNotConfirmed);
  for (ExperimentRow& row : results["image-noise"]) row.summary.bound_rotation_deg->rms *= 0.8;
  EXPECT_EQ(Find(results, "image-noise", "Cramer-Rao").verdict, Verdict::kNotConfirmed);
}

TEST(ExperimentClaims, KittiRankings) {
  ExperimentResults results;
  results["kitti-motions"] = MakeRows("kitti-motions", [](const auto&, const std::string& solver) {
    return solver == "4pt-axis-approx" ? 0.1 : IsSixDof(solver) ? 0.5 : 0.2;
  });
  const auto verdict = [&](const char* part) {
    return Find(results, "kitti-motions", part).verdict;
  };
  EXPECT_EQ(verdict("beat the 6-DoF ones"), Verdict::kConfirmed);
  EXPECT_EQ(verdict("4pt-lee is slightly best"), Verdict::kNotConfirmed);
  EXPECT_EQ(verdict("marginally best in direction"), Verdict::kConfirmed);
  EXPECT_EQ(verdict("fastest"), Verdict::kConfirmed);
  EXPECT_EQ(verdict("17pt-li, with one solution"), Verdict::kNotConfirmed);
  EXPECT_EQ(verdict("limit of iterations"), Verdict::kConfirmed);
}

TEST(ExperimentClaims, ARowPerClaim) {
  const std::vector<Claim> claims = EvaluateClaims({});
  const std::string markdown = ClaimsMarkdown("About.", claims);
  EXPECT_EQ(static_cast<size_t>(std::count(markdown.begin(), markdown.end(), '\n')),
            claims.size() + 8)
      << "a comment, a title, the paragraph and the head of the table";
  EXPECT_THAT(ClaimsJson(claims), HasSubstr("\"format\": \"rigel-claims 1\""));
}

}  // namespace
}  // namespace rigel
