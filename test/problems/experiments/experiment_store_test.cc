#include "rigel/problems/experiments/experiment_store.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/problems/experiments/experiment_report.h"

namespace rigel {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string Read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class ExperimentStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "rigel_store_" + std::to_string(getpid()) + ".jsonl";
    std::string error;
    ExperimentOptions options;
    options.quick = true;
    ASSERT_TRUE(PlanExperiment(*FindExperiment("outliers"), options, &plan_, &error));
  }
  void TearDown() override { std::filesystem::remove(path_); }

  // Rows with numbers that tell them apart.
  std::vector<ExperimentRow> Rows(const ExperimentPoint& point) const {
    std::vector<ExperimentRow> rows;
    for (const std::string& solver : plan_.spec->solvers) {
      for (const char* loop : {kPaperLoop, kRigelLoop}) {
        SolverSummary summary;
        summary.solver = solver;
        summary.pairs = 3;
        summary.raw_rotation_deg = Statistics{*point.x / 3.0, 0.1, 0.2, 0.7};
        rows.push_back({point, loop, summary});
      }
    }
    return rows;
  }

  void Write(size_t num_points) {
    ExperimentStore store;
    std::string error;
    ASSERT_TRUE(store.Open(path_, plan_, false, &error)) << error;
    for (size_t k = 0; k < num_points; ++k) {
      ASSERT_TRUE(store.Add(plan_.points[k], Rows(plan_.points[k]), &error)) << error;
    }
  }

  std::string OpenError() {
    ExperimentStore store;
    std::string error;
    EXPECT_FALSE(store.Open(path_, plan_, true, &error));
    return error;
  }

  std::string path_;
  ExperimentPlan plan_;
};

TEST_F(ExperimentStoreTest, AnInterruptedRunGoesOnWhereItWas) {
  Write(plan_.points.size());
  const std::string whole = Read(path_);
  Write(2);
  ExperimentStore store;
  std::string error;
  ASSERT_TRUE(store.Open(path_, plan_, true, &error)) << error;
  for (size_t k = 0; k < plan_.points.size(); ++k) {
    EXPECT_EQ(store.Has(plan_.points[k]), k < 2);
    if (k < 2) continue;
    ASSERT_TRUE(store.Add(plan_.points[k], Rows(plan_.points[k]), &error)) << error;
  }
  EXPECT_EQ(Read(path_), whole);
}

TEST_F(ExperimentStoreTest, ALineCutShortIsRunAgain) {
  Write(3);
  const std::string whole = Read(path_);
  const size_t second = whole.find('\n', whole.find('\n') + 1) + 1;
  // Anywhere in the third line, its end but for the newline included.
  for (const size_t size : {second + 1, second + 40, whole.size() - 1}) {
    std::ofstream(path_, std::ios::binary) << whole.substr(0, size);
    ExperimentStore store;
    std::string error;
    ASSERT_TRUE(store.Open(path_, plan_, true, &error)) << error;
    EXPECT_TRUE(store.Has(plan_.points[0]));
    EXPECT_EQ(store.Has(plan_.points[2]), false) << size;
    for (const ExperimentPoint& point : {plan_.points[1], plan_.points[2]}) {
      if (store.Has(point)) continue;
      ASSERT_TRUE(store.Add(point, Rows(point), &error)) << error;
    }
    EXPECT_EQ(Read(path_), whole) << size;
  }
}

TEST_F(ExperimentStoreTest, RowsComeInTheOrderOfThePlan) {
  ExperimentStore store;
  std::string error;
  ASSERT_TRUE(store.Open(path_, plan_, false, &error)) << error;
  for (size_t k = plan_.points.size(); k-- > 0;) {
    ASSERT_TRUE(store.Add(plan_.points[k], Rows(plan_.points[k]), &error)) << error;
  }
  const std::vector<ExperimentRow> rows = store.RowsInOrder(plan_);
  EXPECT_TRUE(rows.front().point == plan_.points.front());
  EXPECT_TRUE(rows.back().point == plan_.points.back());
}

TEST_F(ExperimentStoreTest, SaysWhatIsWrongAndWhere) {
  Write(2);
  const std::string good = Read(path_);
  const auto with = [&](const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return OpenError();
  };
  EXPECT_THAT(with(good + "rubbish\n"), HasSubstr(path_ + ":4: no finished point"));
  // In the store's own words, with the line of the file.
  std::string overflow = good;
  overflow.replace(overflow.find("\"x\":20"), 6, "\"x\":1e999");
  EXPECT_THAT(with(overflow), AllOf(HasSubstr(path_ + ":3: no finished point: number overflow"),
                                    Not(HasSubstr("json.exception"))));
  EXPECT_THAT(with(good + "{\"x\": ]}\n"),
              AllOf(HasSubstr(":4: no finished point: parse error at column 7: "),
                    Not(HasSubstr("json.exception"))));
  EXPECT_THAT(with(good + good.substr(good.find('\n') + 1)), HasSubstr(":4: no finished point: "
                                                                       "the point is there twice"));
  EXPECT_THAT(with("{}\n"), HasSubstr(":1: of another run"));
  std::string other = good;
  other.replace(other.find("\"pairs\":30"), 10, "\"pairs\":31");
  EXPECT_THAT(with(other), HasSubstr(":1: of another run"));
  std::string no_point = good;
  no_point.replace(no_point.find("\"x\":20"), 6, "\"x\":21");
  EXPECT_THAT(with(no_point), HasSubstr(":3: no finished point: there is no such point"));

  ExperimentStore store;
  std::string error;
  EXPECT_FALSE(store.Open("/no/such/directory/x", plan_, false, &error));
  EXPECT_THAT(error, HasSubstr("/no/such/directory/x"));
  std::filesystem::resize_file(path_, uintmax_t{1} << 33);
  EXPECT_THAT(OpenError(), HasSubstr(": expected a file of at most 1 GiB"));
}

TEST_F(ExperimentStoreTest, WithoutResumeItBeginsAnew) {
  Write(2);
  Write(0);
  EXPECT_EQ(Read(path_), PlanLine(plan_, RunId(plan_)));
}

TEST_F(ExperimentStoreTest, EachPointSaysOfWhichRunItIs) {
  Write(2);
  const std::string id = "\"run\":\"" + RunId(plan_) + "\"";
  std::istringstream lines(Read(path_));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_THAT(line, HasSubstr(id));
  EXPECT_EQ(count, 3);
  // A point that another run has put there.
  std::string text = Read(path_);
  text.replace(text.rfind(RunId(plan_)), 16, "0123456789abcdef");
  std::ofstream(path_, std::ios::binary) << text;
  EXPECT_THAT(OpenError(), HasSubstr(":3: no finished point: it is of another run"));

  ExperimentPlan other = plan_;
  EXPECT_EQ(RunId(other), RunId(plan_));
  other.options.seed = 2;
  EXPECT_NE(RunId(other), RunId(plan_));
  other = plan_;
  other.driven.push_back({"00", Pose(), Pose()});
  EXPECT_NE(RunId(other), RunId(plan_));
}

TEST_F(ExperimentStoreTest, ARunOfVersion01IsContinued) {
  std::ofstream(path_, std::ios::binary)
      << PlanLine(plan_, "") << PointLine(plan_.points[0], Rows(plan_.points[0]), "");
  ExperimentStore store;
  std::string error;
  ASSERT_TRUE(store.Open(path_, plan_, true, &error)) << error;
  EXPECT_TRUE(store.Has(plan_.points[0]));
  ASSERT_TRUE(store.Add(plan_.points[1], Rows(plan_.points[1]), &error)) << error;
  ASSERT_TRUE(store.Open(path_, plan_, true, &error)) << error;
  EXPECT_TRUE(store.Has(plan_.points[1]));
}

}  // namespace
}  // namespace rigel
