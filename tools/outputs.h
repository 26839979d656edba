// Where results go: files that are written whole, and stdout. No output destroys an input or
// another output.
#ifndef RIGEL_TOOLS_OUTPUTS_H_
#define RIGEL_TOOLS_OUTPUTS_H_

#include <string>
#include <utility>
#include <vector>

namespace rigel {

// A flag that names an output, without dashes, and its value.
using OutputFlag = std::pair<std::string, std::string>;

// Whether an output goes to stdout: "-", /dev/stdout or a link to it.
bool IsStdout(const std::string& path);

// Sends what was written to std::cout on its way. False with a message on stderr if stdout is
// closed or full.
bool FlushStdout();

// Prints a table for people. Nothing if one of the outputs is stdout: that is then for programs.
// False with a message on stderr if stdout is closed or full.
bool PrintTable(const std::string& table, const std::vector<OutputFlag>& outputs);

// Writes to a file, whole or not at all (rigel/problems/io/whole_file.h), or to stdout; nothing if
// `path` is empty. False with a message on stderr if that fails.
bool WriteOutput(const std::string& path, const std::string& text);

// Whether two outputs would be one file, which the second would overwrite. Stdout and devices are
// none.
bool SameOutputFile(const std::string& path1, const std::string& path2);

// Each output has a file of its own, and one at most stdout. False with a message if not.
bool OutputsDiffer(const std::vector<OutputFlag>& outputs, std::string* error);

// No output is one of these input files or a flag file, by any spelling or link; "-" is stdin.
// False with a message if one is.
bool OutputsAreNoInputs(const std::vector<OutputFlag>& outputs,
                        const std::vector<std::string>& inputs, std::string* error);

}  // namespace rigel

#endif  // RIGEL_TOOLS_OUTPUTS_H_
