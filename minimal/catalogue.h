// The catalogue of minimal solvers: what each is called, needs and can return.
#ifndef RIGEL_MINIMAL_CATALOGUE_H_
#define RIGEL_MINIMAL_CATALOGUE_H_

#include <string>
#include <string_view>
#include <vector>

#include "rigel/core/prior.h"
#include "rigel/minimal/solvers/prepared_matches.h"
#include "rigel/minimal/solvers/solutions.h"

namespace rigel {

// `sample` holds SolverInfo::sample_size indices into `matches`, whose alignment is of the kind
// SolverInfo::prior. Overwrites `solutions` and returns their number. No heap, no global state,
// safe across threads; non-finite input gives no solution or non-finite ones.
using SolveFunction = int (*)(const PreparedMatches& matches, const int* sample,
                              Solutions* solutions);

// Which matches a solver's sample may hold.
enum class SampleKind {
  // Any. A sample from one camera pair says nothing about scale, so where there are several pairs
  // the first two matches come from different ones.
  kSpread,
  // All of one camera, the same at both times.
  kOneCamera,
  // All but the last of one camera pair, the last from another where there is one.
  kOnePairPlusOne,
};

struct SolverInfo {
  const char* name;  // as flags and reports spell it
  int sample_size;
  PriorKind prior;
  int max_solutions;
  bool exact;  // finds the truth at any rotation angle but 180 degrees, noise-free
  SampleKind sampling;
  SolveFunction solve;
  const char* source;  // one line: publication and equations
  // Microseconds that a sample takes on one core of 2020, about; 1 for all fast solvers. Used by
  // RansacOptions::max_work_us.
  double nominal_us = 1.0;
};

// In the order in which tables list them.
const std::vector<SolverInfo>& SolverCatalogue();

// Null if there is no solver of that name.
const SolverInfo* FindSolver(std::string_view name);

// "4pt-approx, 4pt-axis-approx, ...", for messages.
std::string SolverNames();

// "known vertical", "known axis", "planar", "none".
const char* PriorKindName(PriorKind kind);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_CATALOGUE_H_
