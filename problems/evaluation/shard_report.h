// Merges the reports of shards (format "rigel-report 1", docs/formats.md).
#ifndef RIGEL_PROBLEMS_EVALUATION_SHARD_REPORT_H_
#define RIGEL_PROBLEMS_EVALUATION_SHARD_REPORT_H_

#include <string>
#include <string_view>
#include <vector>

#include "rigel/problems/evaluation/comparison_report.h"

namespace rigel {

// Reads the report of a shard. `name` stands for its path in messages. False with a message, one
// line of printable text, if it is no report, or that of a run without a shard.
bool ParseShardReport(std::string_view text, const std::string& name, ComparisonReport* report,
                      std::string* error);

// The report that one run over all files would have made. `names` are the names of the reports for
// messages. Moves the results out of `shards`, which may be in any order. False with a message
// unless they are all shards of one input, each once and made with the same options, and some have
// pairs.
bool MergeShards(const std::vector<std::string>& names, std::vector<ComparisonReport>* shards,
                 ComparisonReport* whole, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_EVALUATION_SHARD_REPORT_H_
