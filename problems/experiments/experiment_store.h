// Stores the finished points of an experiment in a file, so that an interrupted run can be resumed.
//
// The first line of JSON identifies the run. Each further line has a finished point and the id of
// the run. An incomplete last line of an interrupted run is dropped.
#ifndef RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_STORE_H_
#define RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_STORE_H_

#include <string>
#include <vector>

#include "rigel/problems/experiments/experiment.h"

namespace rigel {

class ExperimentStore {
 public:
  // Starts a new file or, with `resume`, reads the file if it exists. False with a message that
  // names the file if it cannot be read or written, belongs to a run with other options, or has
  // another format.
  bool Open(const std::string& path, const ExperimentPlan& plan, bool resume, std::string* error);

  bool Has(const ExperimentPoint& point) const;
  const std::vector<ExperimentRow>& rows() const { return rows_; }  // in the order of the file

  bool Add(const ExperimentPoint& point, const std::vector<ExperimentRow>& rows,
           std::string* error);

  // The rows in the order of plan.points.
  std::vector<ExperimentRow> RowsInOrder(const ExperimentPlan& plan) const;

 private:
  bool Read(const ExperimentPlan& plan, const std::string& text, std::string* error);

  std::string path_;
  std::string run_;  // RunId(), empty in a file of version 0.1
  std::vector<ExperimentPoint> points_;
  std::vector<ExperimentRow> rows_;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_STORE_H_
