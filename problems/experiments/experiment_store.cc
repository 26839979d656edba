#include "rigel/problems/experiments/experiment_store.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "rigel/problems/experiments/experiment_report.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/json_text.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/whole_file.h"

namespace rigel {
namespace {

bool Append(const std::string& path, const std::string& text, std::string* error) {
  std::FILE* file = std::fopen(path.c_str(), "ab");
  bool ok = file != nullptr;
  if (ok) ok = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if (file != nullptr) ok = std::fclose(file) == 0 && ok;
  if (!ok) {
    *error = Printable(path) + ": cannot be written: " + SystemMessage(errno);
  }
  return ok;
}

}  // namespace

bool ExperimentStore::Open(const std::string& path, const ExperimentPlan& plan, bool resume,
                           std::string* error) {
  path_ = path;
  run_ = RunId(plan);
  points_.clear();
  rows_.clear();
  std::error_code code;
  const bool there = std::filesystem::exists(path, code);
  if (code) {
    *error = Printable(path) + ": cannot be read: " + code.message();
    return false;
  }
  if (resume && there &&
      (!std::filesystem::is_regular_file(path, code) ||
       std::filesystem::file_size(path, code) > kMaxJsonBytes)) {
    *error = Printable(path) + ": expected a file of at most 1 GiB";
    return false;
  }
  if (!resume || !there) return WriteWholeFile(path, PlanLine(plan, run_), error);
  InputBytes bytes;
  if (!ReadBytes(path, &bytes, error, kMaxJsonBytes)) return false;
  const std::string text(bytes.text());
  const size_t end = text.rfind('\n');
  const std::string whole = end == std::string::npos ? "" : text.substr(0, end + 1);
  if (whole.empty()) return WriteWholeFile(path, PlanLine(plan, run_), error);
  if (!Read(plan, whole, error)) return false;
  return whole.size() == text.size() || WriteWholeFile(path, whole, error);
}

bool ExperimentStore::Read(const ExperimentPlan& plan, const std::string& text,
                           std::string* error) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::string wanted = PlanLine(plan, run_);
  if (line + "\n" == PlanLine(plan, "")) {
    run_.clear();  // of version 0.1
  } else if (line + "\n" != wanted) {
    *error = Printable(path_) +
             ":1: of another run; resume it with its own flags or name another directory\n" +
             "  there: " + Printable(line.substr(0, 400)) +
             "\n  here:  " + wanted.substr(0, wanted.size() - 1);
    return false;
  }
  for (int number = 2; std::getline(lines, line); ++number) {
    ExperimentPoint point;
    std::vector<ExperimentRow> rows;
    std::string run, what;
    if (ParsePointLine(line, &point, &rows, &run, &what)) {
      if (run != run_) {
        what = "it is of another run";
      } else if (std::find(plan.points.begin(), plan.points.end(), point) == plan.points.end()) {
        what = "there is no such point in " + std::string(plan.spec->name);
      } else if (Has(point)) {
        what = "the point is there twice";
      } else if (rows.size() != 2 * plan.spec->solvers.size()) {
        what = std::to_string(rows.size()) + " rows, expected " +
               std::to_string(2 * plan.spec->solvers.size());
      }
    }
    if (!what.empty()) {
      *error = Printable(path_) + ":" + std::to_string(number) + ": no finished point: " + what +
               "; without this line the point is run again";
      return false;
    }
    points_.push_back(point);
    rows_.insert(rows_.end(), rows.begin(), rows.end());
  }
  return true;
}

bool ExperimentStore::Has(const ExperimentPoint& point) const {
  return std::find(points_.begin(), points_.end(), point) != points_.end();
}

bool ExperimentStore::Add(const ExperimentPoint& point, const std::vector<ExperimentRow>& rows,
                          std::string* error) {
  if (!Append(path_, PointLine(point, rows, run_), error)) return false;
  points_.push_back(point);
  rows_.insert(rows_.end(), rows.begin(), rows.end());
  return true;
}

std::vector<ExperimentRow> ExperimentStore::RowsInOrder(const ExperimentPlan& plan) const {
  std::vector<ExperimentRow> ordered;
  for (const ExperimentPoint& point : plan.points) {
    for (const ExperimentRow& row : rows_) {
      if (row.point == point) ordered.push_back(row);
    }
  }
  return ordered;
}

}  // namespace rigel
