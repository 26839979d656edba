// The options with which a report was made.
#ifndef RIGEL_PROBLEMS_IO_REPORT_OPTIONS_H_
#define RIGEL_PROBLEMS_IO_REPORT_OPTIONS_H_

#include <string>
#include <utility>
#include <vector>

namespace rigel {

// Names and values, in the order given.
using ReportOptions = std::vector<std::pair<std::string, std::string>>;

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_REPORT_OPTIONS_H_
