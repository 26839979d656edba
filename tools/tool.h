// What the rigel_* programs share: flags, exit codes, output.
//
// Exit codes: 0 done; 1 a file could not be read or written, nothing to read, no pair with a
// motion, or no truth where it is needed; 2 a wrong flag or value; 3 a bound that a flag set was
// missed. Results go to stdout, talk to stderr.
#ifndef RIGEL_TOOLS_TOOL_H_
#define RIGEL_TOOLS_TOOL_H_

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace rigel {

inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitBoundMissed = 3;

// The whole of main(): parses the flags, runs the program and returns its exit code. What would end
// the process otherwise ends in one line on stderr and kExitFailed: no memory left, an output to a
// closed pipe or over the limit of file sizes.
int RunProgram(int argc, char** argv, const std::string& usage, int (*run)());

// Parses the flags. `usage` is the text above the list of flags in --help. Ends the program itself
// on --help and --version (0) and on a flag that does not exist, a value that does not parse, an
// argument that is not a flag or a flag file that names another (2).
void ParseFlags(const std::string& usage, int* argc, char*** argv);

// Prints the message and where to find help; returns kExitUsage.
int UsageError(const std::string& message);

// The program's own flags with their values, in alphabetical order, without those named.
std::vector<std::pair<std::string, std::string>> FlagValues(
    const std::vector<std::string>& without);

// The names of the program's own flags that were given, in alphabetical order.
std::vector<std::string> GivenFlags();

// Sends what was written to std::cout on its way. False with a message on stderr if stdout is
// closed or full.
bool FlushStdout();

// Whether an output goes to stdout: "-", /dev/stdout or a link to it.
bool IsStdout(const std::string& path);

// Writes to a file, whole or not at all (rigel/problems/io/whole_file.h), or to stdout; nothing if
// `path` is empty. False with a message on stderr if that fails.
bool WriteOutput(const std::string& path, const std::string& text);

// Whether two outputs would be one file, which the second would overwrite. Stdout and devices are
// none.
bool SameOutputFile(const std::string& path1, const std::string& path2);

// A flag that names an output, without dashes, and its value.
using OutputFlag = std::pair<std::string, std::string>;

// Each output has a file of its own, and one at most stdout. False with a message if not.
bool OutputsDiffer(const std::vector<OutputFlag>& outputs, std::string* error);

// No output is one of these input files, by any spelling or link; "-" is stdin. False with a
// message if one is.
bool OutputsAreNoInputs(const std::vector<OutputFlag>& outputs,
                        const std::vector<std::string>& inputs, std::string* error);

// Reads a text file (rigel/problems/io/input_file.h) of at most 1 GiB without its byte order mark.
// False with a message on stderr if that fails.
bool ReadInput(const std::string& path, std::string* text);

// Splits at commas; empty parts are dropped.
std::vector<std::string> SplitCommas(const std::string& text);

// "what: k of n" on stderr, on a terminal only. Thread-safe.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  void Step();
  // What is going on besides, a few times a second at most: "what: k of n; text()".
  void Note(const std::function<std::string()>& text);

 private:
  void Show(const std::string& note);

  std::string what_;
  int total_;
  int done_ = 0;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point noted_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
};

}  // namespace rigel

#endif  // RIGEL_TOOLS_TOOL_H_
