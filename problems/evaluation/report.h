// Reports of rigel_compare and rigel_estimate.
#ifndef RIGEL_PROBLEMS_EVALUATION_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_REPORT_H_

#include "rigel/problems/evaluation/comparison_report.h"
#include "rigel/problems/evaluation/drift_report.h"
#include "rigel/problems/evaluation/estimate_report.h"

#endif  // RIGEL_PROBLEMS_EVALUATION_REPORT_H_
