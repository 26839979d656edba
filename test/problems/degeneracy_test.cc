// The table of docs/degeneracies.md is measured here: RIGEL_UPDATE_DOCS=1 writes it anew.
#include "rigel/problems/degeneracy.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace rigel {
namespace {

constexpr char kBegin[] = "<!-- begin of the measured table -->\n";
constexpr char kEnd[] = "<!-- end of the measured table -->\n";
constexpr int kProblems = 100;

TEST(DegeneracyTest, TableOfTheDocumentationIsMeasured) {
  const std::string path = std::string(RIGEL_DOCS_DIR) + "/degeneracies.md";
  std::ifstream in(path);
  ASSERT_TRUE(in) << path;
  std::stringstream buffer;
  buffer << in.rdbuf();
  std::string text = buffer.str();
  const size_t begin = text.find(kBegin);
  const size_t end = text.find(kEnd);
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  const size_t start = begin + sizeof(kBegin) - 1;
  const std::string documented = text.substr(start, end - start);
  const std::string measured = "\n" + DegeneracyTable(kProblems) + "\n";
  if (std::getenv("RIGEL_UPDATE_DOCS") != nullptr) {
    text.replace(start, end - start, measured);
    std::ofstream(path) << text;
    return;
  }
  EXPECT_EQ(documented, measured) << "run with RIGEL_UPDATE_DOCS=1 to write the table anew";
}

TEST(DegeneracyTest, NoMotionIsNoSolution) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    const DegeneracyCell cell = MeasureDegeneracy(solver, Configuration::kNoMotion, 20);
    EXPECT_EQ(cell.solved, 0.0) << solver.name;
  }
}

// A motion whose |t| nothing determines must not come with a scale that is said to be known.
TEST(DegeneracyTest, UndeterminedScaleIsFlagged) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    // Ackermann motion of a camera off the rotation's axis does determine the scale.
    if (std::string(solver.name) == "2pt-ackermann") continue;
    for (const Configuration configuration :
         {Configuration::kPureTranslation, Configuration::kCentralRig, Configuration::kPanoramicRig,
          Configuration::kSingleCamera}) {
      const DegeneracyCell cell = MeasureDegeneracy(solver, configuration, 50);
      if (cell.solved < 0.05) continue;
      EXPECT_GE(cell.no_scale, 0.95 * cell.solved)
          << solver.name << ", " << ConfigurationName(configuration);
    }
  }
}

}  // namespace
}  // namespace rigel
