// What the rigel_* programs share: main(), flags and exit codes.
//
// Results go to stdout, talk to stderr.
#ifndef RIGEL_TOOLS_TOOL_H_
#define RIGEL_TOOLS_TOOL_H_

#include <string>
#include <utility>
#include <vector>

namespace rigel {

inline constexpr int kExitDone = 0;
// A file could not be read or written, there is nothing to read, no pair has a motion, or there is
// no truth where it is needed.
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;  // a wrong flag or value
inline constexpr int kExitBoundMissed = 3;

// The whole of main(): parses the flags, runs the program and returns its exit code. What would end
// the process otherwise ends in one line on stderr and kExitFailed: no memory left, an output to a
// closed pipe or over the limit of file sizes.
int RunProgram(int argc, char** argv, const std::string& usage, int (*run)());

// Parses the flags. `usage` is the text above the list of flags in --help. Ends the program itself
// with 0 on --help and --version. Ends it with 2 on a flag that does not exist, a value that does
// not parse, an argument that is not a flag, or a flag file that names another.
void ParseFlags(const std::string& usage, int* argc, char*** argv);

std::string ProgramName();

// Prints the message and where to find help; returns kExitUsage.
int UsageError(const std::string& message);

// Prints the message; returns kExitFailed.
int Failure(const std::string& message);

// kExitDone or kExitFailed.
int ExitCode(bool ok);

// The program's own flags with their values, in alphabetical order, without those named.
std::vector<std::pair<std::string, std::string>> FlagValues(
    const std::vector<std::string>& without);

// The names of the program's own flags that were given, in alphabetical order.
std::vector<std::string> GivenFlags();

bool IsGiven(const std::string& flag);

// The first of these flags that was given; empty if none was.
std::string FirstGiven(const std::vector<std::string>& flags);

// False, with the message.
bool Refuse(const std::string& message, std::string* error);

// The same: another value of the flag was expected.
bool WrongValue(const std::string& flag, const std::string& value, const std::string& expected,
                std::string* error);

// Whether --threads is from `least` on and no more than a machine has. False with a message if not.
bool CheckThreads(int threads, int least, std::string* error);

// Splits at commas; empty parts are dropped.
std::vector<std::string> SplitCommas(const std::string& text);

}  // namespace rigel

#endif  // RIGEL_TOOLS_TOOL_H_
