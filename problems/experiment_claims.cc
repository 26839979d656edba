#include "rigel/problems/experiment_claims.h"

#include <nlohmann/json.hpp>

#include "rigel/problems/claim_cases.h"
#include "rigel/problems/report_json.h"

namespace rigel {

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConfirmed:
      return "confirmed";
    case Verdict::kPartly:
      return "partly";
    case Verdict::kNotConfirmed:
      return "not confirmed";
    case Verdict::kTooFewPairs:
      return "too few pairs";
    case Verdict::kNotMeasured:
      return "not measured";
  }
  return "unknown";
}

std::vector<Claim> EvaluateClaims(const ExperimentResults& results) {
  std::vector<Claim> all = claims::SyntheticClaims(results);
  for (const auto& more : {claims::KittiClaims(results), claims::RefinementClaims(results)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

std::string ClaimsMarkdown(const std::string& about, const std::vector<Claim>& claims) {
  std::string text =
      "<!-- Written by rigel_experiment; do not edit. -->\n\n# Claims\n\n" + about + "\n\n";
  text +=
      "| of | experiment | claim | verdict | figures | where not, and why |\n"
      "| --- | --- | --- | --- | --- | --- |\n";
  for (const Claim& claim : claims) {
    text += "| " + claim.source + " | " + claim.experiment + " | " + claim.text + " | **" +
            VerdictName(claim.verdict) + "** | " + claim.figures + " | " + claim.why + " |\n";
  }
  return text;
}

std::string ClaimsJson(const std::vector<Claim>& claims) {
  nlohmann::ordered_json json = NewReport("rigel-claims 1");
  json["claims"] = nlohmann::ordered_json::array();
  for (const Claim& claim : claims) {
    json["claims"].push_back({{"of", claim.source},
                              {"experiment", claim.experiment},
                              {"claim", claim.text},
                              {"verdict", VerdictName(claim.verdict)},
                              {"figures", claim.figures},
                              {"where_not", claim.why}});
  }
  return JsonText(json, 1) + "\n";
}

}  // namespace rigel
