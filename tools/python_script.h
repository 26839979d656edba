// Runs the scripts that lie beside the programs, rigel_plot.py and rigel_claims.py, with python3.
#ifndef RIGEL_TOOLS_PYTHON_SCRIPT_H_
#define RIGEL_TOOLS_PYTHON_SCRIPT_H_

#include <string>
#include <vector>

namespace rigel {

enum class ScriptOutcome {
  kDone,
  kUnavailable,  // no python3, none of a module that the script needs, no script
  kFailed,       // the script said why on stderr
};

// `error` is one line that says what is wrong, unless kDone. Flush stdout before.
ScriptOutcome RunScript(const std::string& name, const std::vector<std::string>& arguments,
                        std::string* error);

// The same as a command for a shell.
std::string ScriptCommand(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace rigel

#endif  // RIGEL_TOOLS_PYTHON_SCRIPT_H_
