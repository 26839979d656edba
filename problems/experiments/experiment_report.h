// Results of experiments: a table for people, JSON ("rigel-experiment 1") and CSV for programs.
// Formats: docs/formats.md.
#ifndef RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_REPORT_H_
#define RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_REPORT_H_

#include <string>
#include <vector>

#include "rigel/problems/experiments/experiment.h"

namespace rigel {

// Median raw errors of all solvers in the paper's loop, one row a point, beside the refined one (of
// the solver in the middle) and the bound: rotation, direction and, for inter-share, scale. For the
// motions of drives the refined errors of all solvers, too.
// 100 columns at most.
std::string ExperimentTable(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows);

std::string ExperimentJson(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows);

// One line a point, solver and loop.
std::string ExperimentCsv(const ExperimentPlan& plan, const std::vector<ExperimentRow>& rows);

// Identifies runs whose points can be joined: 16 hexadecimal digits, the same for the same options,
// solvers, points and recorded motions.
std::string RunId(const ExperimentPlan& plan);

// The results of a finished point as one line of text, and back. False with a message if the text
// has another format. Version 0.1 wrote no run: it is then empty.
std::string PointLine(const ExperimentPoint& point, const std::vector<ExperimentRow>& rows,
                      const std::string& run);
bool ParsePointLine(const std::string& line, ExperimentPoint* point,
                    std::vector<ExperimentRow>* rows, std::string* run, std::string* error);

// One line of text that identifies the run: its options, and its RunId(), empty as above.
std::string PlanLine(const ExperimentPlan& plan, const std::string& run);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENTS_EXPERIMENT_REPORT_H_
