// Runs rigel_plot.py, which lies beside the programs, with python3.
#ifndef RIGEL_TOOLS_PLOT_SCRIPT_H_
#define RIGEL_TOOLS_PLOT_SCRIPT_H_

#include <string>
#include <vector>

namespace rigel {

enum class PlotOutcome {
  kDone,
  kUnavailable,  // no python3, no matplotlib, no script
  kFailed,       // the script said why on stderr
};

// `error` is one line that says what is wrong, unless kDone.
PlotOutcome RunPlotScript(const std::vector<std::string>& arguments, std::string* error);

// The same as a command for a shell.
std::string PlotCommand(const std::vector<std::string>& arguments);

}  // namespace rigel

#endif  // RIGEL_TOOLS_PLOT_SCRIPT_H_
