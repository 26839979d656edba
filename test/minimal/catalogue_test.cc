#include "rigel/minimal/catalogue.h"

#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {
namespace {

TEST(Catalogue, HasTheSolversOfThePaper) {
  struct Expected {
    const char* name;
    int sample_size;
    PriorKind prior;
    bool exact;
  };
  const Expected family[] = {
      {"4pt-approx", 4, PriorKind::kVertical, false},
      {"4pt-axis-approx", 4, PriorKind::kAxis, false},
      {"3pt-approx", 3, PriorKind::kPlanar, false},
      {"4pt-approx-polished", 4, PriorKind::kVertical, false},
      {"4pt-axis-approx-polished", 4, PriorKind::kAxis, false},
      {"3pt-approx-polished", 3, PriorKind::kPlanar, false},
      {"4pt", 4, PriorKind::kVertical, true},
      {"4pt-axis", 4, PriorKind::kAxis, true},
      {"3pt", 3, PriorKind::kPlanar, true},
  };
  for (const Expected& expected : family) {
    const SolverInfo* info = FindSolver(expected.name);
    ASSERT_NE(info, nullptr) << expected.name;
    EXPECT_EQ(info->sample_size, expected.sample_size) << expected.name;
    EXPECT_EQ(info->prior, expected.prior) << expected.name;
    EXPECT_EQ(info->exact, expected.exact) << expected.name;
    EXPECT_EQ(info->sampling, SampleKind::kSpread) << expected.name;
  }
}

TEST(Catalogue, HasTheBaselines) {
  for (const char* name : {"17pt-li", "6pt-stewenius", "6pt-ventura", "4pt-lee", "4pt-liu",
                           "4pt-sweeney", "5pt+1", "2pt-choi", "2pt-ackermann"}) {
    EXPECT_NE(FindSolver(name), nullptr) << name;
  }
  // What their samples must be; others would find nothing.
  EXPECT_EQ(FindSolver("5pt+1")->sampling, SampleKind::kOnePairPlusOne);
  EXPECT_EQ(FindSolver("2pt-choi")->sampling, SampleKind::kOneCamera);
}

TEST(Catalogue, NamesAreUniqueAndFindThemselves) {
  std::set<std::string> names;
  for (const SolverInfo& info : SolverCatalogue()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_EQ(FindSolver(info.name), &info) << info.name;
  }
  EXPECT_EQ(FindSolver(""), nullptr);
  EXPECT_EQ(FindSolver("4pt-"), nullptr);
  EXPECT_EQ(FindSolver("4PT"), nullptr);
}

TEST(Catalogue, EntriesAreComplete) {
  for (const SolverInfo& info : SolverCatalogue()) {
    EXPECT_NE(info.solve, nullptr) << info.name;
    EXPECT_GE(info.sample_size, 1) << info.name;
    // Samples live in arrays of 64 indices.
    EXPECT_LE(info.sample_size, 64) << info.name;
    EXPECT_GE(info.max_solutions, 1) << info.name;
    EXPECT_LE(info.max_solutions, kMaxSolutions) << info.name;
    EXPECT_FALSE(std::string(info.source).empty()) << info.name;
  }
}

TEST(Catalogue, SolverNamesListsAllInOrder) {
  std::string expected;
  for (const SolverInfo& info : SolverCatalogue()) {
    expected += (expected.empty() ? "" : ", ") + std::string(info.name);
  }
  EXPECT_EQ(SolverNames(), expected);
  EXPECT_THAT(SolverNames(), ::testing::StartsWith("4pt-approx, 4pt-axis-approx, 3pt-approx"));
}

TEST(Catalogue, PriorKindsHaveNames) {
  EXPECT_STREQ(PriorKindName(PriorKind::kNone), "none");
  EXPECT_STREQ(PriorKindName(PriorKind::kVertical), "known vertical");
  EXPECT_STREQ(PriorKindName(PriorKind::kAxis), "known axis");
  EXPECT_STREQ(PriorKindName(PriorKind::kPlanar), "planar");
}

TEST(Solutions, KeepsToItsCapacity) {
  Solutions solutions;
  EXPECT_TRUE(solutions.empty());
  for (int k = 0; k < kMaxSolutions + 10; ++k) solutions.Append().t.x() = k;
  EXPECT_EQ(solutions.size(), kMaxSolutions);
  EXPECT_EQ(solutions[0].t.x(), 0.0);
  EXPECT_EQ(solutions[kMaxSolutions - 1].t.x(), kMaxSolutions + 9) << "the last slot, again";
  EXPECT_EQ(solutions.end() - solutions.begin(), kMaxSolutions);
  solutions.clear();
  EXPECT_TRUE(solutions.empty());
}

}  // namespace
}  // namespace rigel
