// The tables of the paper over measured results: runtime in RANSAC, median rotation and median
// translation direction error, one row a sequence, one column a solver.
#ifndef RIGEL_PROBLEMS_EVALUATION_SEQUENCE_TABLES_H_
#define RIGEL_PROBLEMS_EVALUATION_SEQUENCE_TABLES_H_

#include <string>
#include <vector>

#include "rigel/problems/evaluation/comparison.h"

namespace rigel {

// Each column has the raw and the refined figure (of the runtime: of RANSAC, and with the
// refinement) and, where it knows the solver and the sequence, the paper's. An asterisk marks the
// best raw and the best refined figure of a row, as they are shown, unless all are equal. Tables of
// many solvers are split so that none has more than 100 columns.
std::string SequenceTables(const std::vector<SolverSummary>& summaries);

// The same text for a terminal: figures with an asterisk in bold, nothing else changed.
std::string BestInBold(const std::string& tables);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_SEQUENCE_TABLES_H_
