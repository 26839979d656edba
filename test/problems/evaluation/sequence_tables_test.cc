// The paper's tables: rows, marks of the best, the published figures, the width.
#include "rigel/problems/evaluation/sequence_tables.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/minimal/catalogue.h"
#include "rigel/problems/evaluation/paper_figures.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Statistics All(double value) { return {value, value, value, value}; }

SolverSummary Summary(const std::string& solver, const std::string& sequence, double raw,
                      double refined) {
  SolverSummary s;
  s.solver = solver;
  s.sequence = sequence;
  s.pairs = 7;
  s.raw_rotation_deg = All(raw);
  s.refined_rotation_deg = All(refined);
  s.ransac_ms = All(1.5);
  s.refine_ms = All(2.0);
  return s;
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The row of `sequence` in the table of that title, its blanks made one.
std::string Row(const std::string& text, const std::string& title, const std::string& sequence) {
  bool in_table = false;
  for (const std::string& line : Lines(text)) {
    if (line.find(title) == 0) in_table = true;
    if (!in_table || line.substr(0, sequence.size() + 1) != sequence + " ") continue;
    std::istringstream words(line);
    std::string row;
    for (std::string word; words >> word;) row += (row.empty() ? "" : " ") + word;
    return row;
  }
  return "no row";
}

TEST(SequenceTables, BestIsMarkedAndThePaperStandsBeside) {
  std::vector<SolverSummary> summaries;
  for (const char* sequence : {"all", "06", "x"}) {
    summaries.push_back(Summary("4pt-axis-approx", sequence, 0.08, 0.031));
    summaries.push_back(Summary("4pt", sequence, 0.07, 0.0310000001));
  }
  summaries[4].raw_rotation_deg.reset();
  const std::string text = SequenceTables(summaries);
  // Refined errors are shown as equal: none is better.
  EXPECT_EQ(Row(text, "rotation", "06"), "06 7 0.0800 0.0310 0.0249 0.0700* 0.0310");
  EXPECT_EQ(Row(text, "rotation", "x"), "x 7 - 0.0310 - 0.0700 0.0310");
  EXPECT_EQ(Row(text, "rotation", "all"), "all 7 0.0800 0.0310 - 0.0700* 0.0310");
  EXPECT_EQ(Row(text, "time", "all"), "all 7 1.50 3.50 477.20 1.50 3.50");
  EXPECT_THAT(text, AllOf(HasSubstr("of Li, Liu, Han, Lv"), Not(HasSubstr("direction"))));
}

TEST(SequenceTables, BestIsBoldOnATerminal) {
  EXPECT_EQ(BestInBold("06   0.0800  0.0700*\n07  2e4*  -\n\n*: the best\n"),
            "06   0.0800  \033[1m0.0700\033[0m*\n07  \033[1m2e4\033[0m*  -\n\n*: the best\n");
  EXPECT_EQ(BestInBold("-2.5*"), "\033[1m-2.5\033[0m*");
}

TEST(SequenceTables, ManySolversAreSplitAndNoneIsLost) {
  std::vector<SolverSummary> summaries;
  for (const SolverInfo& solver : SolverCatalogue()) {
    for (const std::string sequence : {"all", "00", "10", "a_name_of_more_than_twelve"}) {
      SolverSummary s = Summary(solver.name, sequence, 123.4567, 0.0001);
      s.raw_direction_deg = All(179.99999);
      summaries.push_back(s);
    }
  }
  const std::string text = SequenceTables(summaries);
  size_t rows = 0;
  for (const std::string& line : Lines(text)) {
    EXPECT_LE(line.size(), 100u) << line;
    EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
    rows += line.substr(0, 3) == "00 " ? 1 : 0;
  }
  EXPECT_GE(rows, 9u);
  // Names are broken at dashes over several lines; each ends with what is left of it.
  EXPECT_THAT(text, AllOf(HasSubstr("17pt-li"), HasSubstr("2pt-ackermann"), HasSubstr("polished")));
}

TEST(PaperFigures, AreThoseOfItsTables) {
  EXPECT_EQ(PaperFigure(PaperTable::kRuntimeMs, "6pt-stewenius", "all"), 23472.7);
  EXPECT_EQ(PaperFigure(PaperTable::kRotationDeg, "17pt-li", "00"), 0.0928);
  EXPECT_EQ(PaperFigure(PaperTable::kRotationDeg, "6pt-stewenius", "01"), 0.458);
  EXPECT_EQ(PaperFigure(PaperTable::kRotationDeg, "3pt-approx", "10"), 0.0326);
  EXPECT_EQ(PaperFigure(PaperTable::kDirectionDeg, "4pt-axis-approx", "06"), 0.5544);
  EXPECT_EQ(PaperFigure(PaperTable::kDirectionDeg, "4pt-liu", "07"), 1.016);
  EXPECT_EQ(PaperFigure(PaperTable::kDirectionDeg, "3pt-approx", "10"), 1.5479);
  for (const char* sequence : {"all", "11", "0", "006", "x6", ""}) {
    EXPECT_FALSE(PaperFigure(PaperTable::kRotationDeg, "4pt-lee", sequence)) << sequence;
  }
  EXPECT_FALSE(PaperFigure(PaperTable::kRotationDeg, "4pt", "06"));
  EXPECT_FALSE(PaperFigure(PaperTable::kRuntimeMs, "4pt-lee", "06"));
}

}  // namespace
}  // namespace rigel
