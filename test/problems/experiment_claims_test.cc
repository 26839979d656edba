// The verdicts, on results made up so that each holds or does not.
#include "rigel/problems/experiment_claims.h"

#include <cmath>
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
        s.pairs = 100;
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

// Twice the bound's distance: confirmed, refused, or not told with few pairs.
TEST(ExperimentClaims, TheLimitKnowsTheNumberOfPairs) {
  const auto claim = [](double ratio, int pairs, const char* part) {
    ExperimentResults results;
    results["image-noise"] =
        MakeRows("image-noise", [](const auto&, const std::string&) { return 0.1; });
    for (ExperimentRow& row : results["image-noise"]) {
      row.summary.pairs = pairs;
      row.summary.refined_rotation_deg->rms = ratio * row.summary.bound_rotation_deg->rms;
    }
    return Find(results, "image-noise", part);
  };
  const char* const bound = "Cramer-Rao";
  // Three motions of 100 pairs and more: 1.1. Of 30: 1.183.
  EXPECT_EQ(claim(1.09, 500, bound).verdict, Verdict::kConfirmed);
  EXPECT_NE(claim(1.11, 500, bound).verdict, Verdict::kConfirmed);
  EXPECT_NE(claim(1.15, 60, bound).verdict, Verdict::kConfirmed);
  EXPECT_EQ(claim(1.15, 30, bound).verdict, Verdict::kConfirmed);
  EXPECT_NE(claim(1.20, 30, bound).verdict, Verdict::kConfirmed);
  EXPECT_THAT(claim(1.15, 30, bound).figures, HasSubstr("limit 1.18"));
  for (const double ratio : {1.0, 2.0}) {
    EXPECT_EQ(claim(ratio, 5, bound).verdict, Verdict::kTooFewPairs);
  }
  EXPECT_EQ(claim(1.0, 35, "at most half").verdict, Verdict::kTooFewPairs);
  EXPECT_EQ(claim(1.0, 36, "at most half").verdict, Verdict::kConfirmed);
}

TEST(ExperimentClaims, MostCasesAreMoreThanHalf) {
  const auto verdict = [](double to) {
    ExperimentResults results;
    results["planar-vibration"] =
        MakeRows("planar-vibration", [&](const ExperimentPoint& point, const std::string& solver) {
          return solver == "3pt-approx" ? (*point.x <= to ? 0.1 : 0.3) : 0.2;
        });
    return Find(results, "planar-vibration", "than 2pt-choi in most cases").verdict;
  };
  EXPECT_EQ(verdict(1.01), Verdict::kConfirmed) << "six of eleven";
  EXPECT_EQ(verdict(0.81), Verdict::kNotConfirmed) << "five of eleven";
}

TEST(ExperimentClaims, FlatIsFlatBetweenTheEnds) {
  ExperimentResults results;
  results["pitch-noise"] = MakeRows("pitch-noise", [](const ExperimentPoint& p, const auto&) {
    return *p.x > 0.3 && *p.x < 0.9 ? 0.2 : 0.1;
  });
  EXPECT_EQ(Find(results, "pitch-noise", "refined errors stay the same").verdict,
            Verdict::kNotConfirmed);
}

TEST(ExperimentClaims, TimesOfThePaper) {
  const auto times = [](double factor) {
    ExperimentResults results;
    for (const char* name : {"image-noise", "kitti-motions"}) {
      results[name] = MakeRows(name, [&](const auto&, const std::string& solver) {
        return solver == "4pt-liu"           ? 1.0
               : solver == "4pt-axis-approx" ? 1.5
               : solver == "4pt-approx"      ? 1.7 * factor
               : solver == "4pt-lee"         ? 2.9
               : solver == "3pt-approx"      ? 2.0
                                             : 6.0 / factor;
      });
    }
    return results;
  };
  for (const char* part : {"far faster", "the fastest 4-point solver", "about 1.7 times"}) {
    EXPECT_EQ(Find(times(1.0), "image-noise", part).verdict, Verdict::kConfirmed) << part;
    EXPECT_NE(Find(times(2.0), "image-noise", part).verdict, Verdict::kConfirmed) << part;
  }
  EXPECT_EQ(Find(times(1.0), "kitti-motions", "slightly slower").verdict, Verdict::kConfirmed);
  EXPECT_NE(Find(times(2.0), "kitti-motions", "slightly slower").verdict, Verdict::kConfirmed);
}

TEST(ExperimentClaims, UnaffectedAndSlowlyGrowing) {
  const auto results = [](double six_growth, double three_growth) {
    ExperimentResults all;
    for (const char* name : {"pitch-noise", "roll-noise", "planar-vibration"}) {
      all[name] = MakeRows(name, [&](const ExperimentPoint& p, const std::string& solver) {
        return IsSixDof(solver) ? 0.1 * (1 + six_growth * *p.x) : 0.1 * (1 + *p.x);
      });
    }
    all["planar-image-noise"] =
        MakeRows("planar-image-noise", [&](const ExperimentPoint& p, const std::string& solver) {
          return 0.1 * (1 + *p.x * (solver == "3pt-approx" ? three_growth : 1.0));
        });
    return all;
  };
  for (const char* name : {"pitch-noise", "roll-noise", "planar-vibration"}) {
    EXPECT_EQ(Find(results(0, 0), name, "unaffected").verdict, Verdict::kConfirmed) << name;
    EXPECT_NE(Find(results(1, 0), name, "unaffected").verdict, Verdict::kConfirmed) << name;
  }
  EXPECT_EQ(Find(results(0, 0), "pitch-noise", "solvers grow").verdict, Verdict::kConfirmed);
  EXPECT_EQ(Find(results(0, 0.5), "planar-image-noise", "more slowly").verdict,
            Verdict::kConfirmed);
  EXPECT_EQ(Find(results(0, 2.0), "planar-image-noise", "more slowly").verdict,
            Verdict::kNotConfirmed);
}

// Of errors without any order, and of their opposites: what fails has a why with a reason.
TEST(ExperimentClaims, WhatIsNotConfirmedHasAReason) {
  int failed = 0;
  for (const double sign : {1.0, -1.0}) {
    ExperimentResults results;
    for (const ExperimentSpec& spec : ExperimentCatalogue()) {
      int count = 0;
      results[spec.name] = MakeRows(
          spec.name,
          [&](const auto&, const std::string&) {
            return std::exp(sign * (count++ * 7919 % 13) / 4.0);
          },
          0.9);
    }
    for (const Claim& claim : EvaluateClaims(results)) {
      if (claim.verdict == Verdict::kConfirmed) continue;
      ++failed;
      EXPECT_THAT(claim.why, HasSubstr(". ")) << claim.text;
    }
  }
  EXPECT_GT(failed, 40);
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
