// What the paper claims of its solvers and what Rigel adds, each held against results.
#ifndef RIGEL_PROBLEMS_EXPERIMENT_CLAIMS_H_
#define RIGEL_PROBLEMS_EXPERIMENT_CLAIMS_H_

#include <map>
#include <string>
#include <vector>

#include "rigel/problems/experiment.h"

namespace rigel {

// Rows by the name of their experiment.
using ExperimentResults = std::map<std::string, std::vector<ExperimentRow>>;

enum class Verdict {
  kConfirmed,
  kPartly,  // in most of the cases
  kNotConfirmed,
  kTooFewPairs,  // chance alone could decide
  kNotMeasured,  // the experiment, or a solver or point of it, is not among the results
};

const char* VerdictName(Verdict verdict);

struct Claim {
  std::string source;      // "paper" or "Rigel"
  std::string experiment;  // whose results decide
  std::string text;
  Verdict verdict = Verdict::kNotMeasured;
  std::string figures;  // measured
  std::string why;      // where it does not hold and what explains it; empty if confirmed
};

// All claims, measured or not, in a fixed order. The paper's are of the raw motions in its loop.
std::vector<Claim> EvaluateClaims(const ExperimentResults& results);

// Markdown, with `about`, a paragraph on the run, above the table; JSON ("rigel-claims 1").
std::string ClaimsMarkdown(const std::string& about, const std::vector<Claim>& claims);
std::string ClaimsJson(const std::vector<Claim>& claims);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EXPERIMENT_CLAIMS_H_
