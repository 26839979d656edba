#include "rigel/tools/tool.h"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <gflags/gflags.h>
#include <glog/logging.h>

#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/version.h"
#include "rigel/tools/flag_files.h"
#include "rigel/tools/outputs.h"

// gflags leaves the process through this pointer, with code 1; it is not in a public header.
namespace google {
extern void (*gflags_exitfunc)(int);
}

namespace rigel {
namespace {

void PointToHelp() { std::cerr << "Try '" << ProgramName() << " --help'.\n"; }

[[noreturn]] void ExitUsage(int) {
  PointToHelp();
  std::exit(kExitUsage);
}

// gflags writes 0.9999 as 0.99990000000000001.
std::string PlainValue(const gflags::CommandLineFlagInfo& flag, const std::string& value) {
  if (flag.type != "double") return value;
  const std::string plain = CsvNumber(std::strtod(value.c_str(), nullptr));
  return plain.empty() ? value : plain;  // empty: not finite
}

// Flags of gflags, glog and other libraries are not the program's: those that a file of this folder
// defines are, whether the compiler was given its path from the root or, by a compiler cache, from
// the build directory.
std::vector<gflags::CommandLineFlagInfo> OwnFlags() {
  std::vector<gflags::CommandLineFlagInfo> all;
  gflags::GetAllFlags(&all);
  std::vector<gflags::CommandLineFlagInfo> own;
  for (const auto& flag : all) {
    const std::filesystem::path folder = std::filesystem::path(flag.filename).parent_path();
    if (folder.filename() == RIGEL_TOOLS_FOLDER) own.push_back(flag);
  }
  std::sort(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return own;
}

// "--name=default", or whether a switch is on.
std::string FlagWithDefault(const gflags::CommandLineFlagInfo& flag) {
  const std::string name = "--" + flag.name;
  if (flag.type == "bool") {
    return name +
           (flag.default_value == "true" ? "  (on; --no" + flag.name + " is off)" : "  (off)");
  }
  return name + "=" + (flag.default_value.empty() ? "\"\"" : PlainValue(flag, flag.default_value));
}

void PrintWrapped(const std::string& text) {
  constexpr size_t kColumns = 92;  // of a line of text, which an indent of 6 fills up to 98
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > kColumns) {
      std::cout << "      " << line << "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  std::cout << "      " << line << "\n";
}

void PrintHelp(const std::string& usage) {
  std::cout << usage << "\nFlags:\n";
  bool has_bounds = false;
  for (const auto& flag : OwnFlags()) {
    std::cout << "  " << FlagWithDefault(flag) << "\n";
    PrintWrapped(flag.description);
    has_bounds = has_bounds || flag.name == "fail_above";
  }
  std::cout << "\nExit code: 0 done, 1 failed, 2 wrong flag"
            << (has_bounds ? ", 3 a bound that a flag set was missed.\n" : ".\n");
}

// Without this, glibc gives the memory of a pair of frames back to the system after each pair and
// asks for it again: 17 page faults for each motion that is estimated (strace -c -e brk). 20 000
// matches take 22 MB in all.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kLargeBlock = 16 << 20;  // bytes: a larger one is still given back at once
  constexpr int kKeptMemory = 32 << 20;  // bytes: more than 20 000 matches need
  mallopt(M_MMAP_THRESHOLD, kLargeBlock);
  mallopt(M_TRIM_THRESHOLD, kKeptMemory);
#endif
}

}  // namespace

std::string ProgramName() { return gflags::ProgramInvocationShortName(); }

int RunProgram(int argc, char** argv, const std::string& usage, int (*run)()) {
  KeepFreedMemory();
  // A write then fails, and that is told.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  // A file that is opened never gets the number of a closed stdin, stdout or stderr.
  while (true) {
    const int descriptor = open("/dev/null", O_RDONLY);
    if (descriptor > STDERR_FILENO) close(descriptor);
    if (descriptor < 0 || descriptor > STDERR_FILENO) break;
  }
  try {
    ParseFlags(usage, &argc, &argv);
    return run();
  } catch (const std::exception& exception) {
    std::cerr << ProgramName() << ": " << ExceptionMessage(exception) << "\n";
  }
  return kExitFailed;
}

void ParseFlags(const std::string& usage, int* argc, char*** argv) {
  // The user of a program wants its own messages, not the libraries' log lines.
  FLAGS_minloglevel = google::GLOG_FATAL;
  google::InitGoogleLogging((*argv)[0]);
  gflags::SetUsageMessage(usage);
  gflags::SetVersionString(RigelVersion());
  // The name of the program, which --version prints before the flags are parsed.
  gflags::SetArgv(*argc, const_cast<const char**>(*argv));
  google::gflags_exitfunc = &ExitUsage;
  for (int k = 1; k < *argc; ++k) {
    const std::string argument = (*argv)[k];
    if (argument == "--") break;
    if (argument == "--help" || argument == "-help" || argument == "-h") {
      PrintHelp(usage);
      std::exit(FlushStdout() ? kExitDone : kExitFailed);
    }
    if (argument == "--version" || argument == "-version") {
      std::cout << ProgramName() << " " << RigelVersion() << "\n";
      std::exit(FlushStdout() ? kExitDone : kExitFailed);
    }
  }
  const std::string flag_files = FlagFilesError(*argc, *argv);
  if (!flag_files.empty()) std::exit(UsageError(flag_files));
  gflags::ParseCommandLineNonHelpFlags(argc, argv, true);
  if (*argc > 1) {
    std::exit(UsageError(std::string("unexpected argument '") + (*argv)[1] +
                         "'; everything is a flag, written --name=value"));
  }
}

int UsageError(const std::string& message) {
  std::cerr << ProgramName() << ": " << message << "\n";
  PointToHelp();
  return kExitUsage;
}

int Failure(const std::string& message) {
  std::cerr << message << "\n";
  return kExitFailed;
}

int ExitCode(bool ok) { return ok ? kExitDone : kExitFailed; }

std::vector<std::pair<std::string, std::string>> FlagValues(
    const std::vector<std::string>& without) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const auto& flag : OwnFlags()) {
    if (std::find(without.begin(), without.end(), flag.name) == without.end()) {
      values.emplace_back(flag.name, PlainValue(flag, flag.current_value));
    }
  }
  return values;
}

std::vector<std::string> GivenFlags() {
  std::vector<std::string> names;
  for (const auto& flag : OwnFlags()) {
    if (!flag.is_default) names.push_back(flag.name);
  }
  return names;
}

bool IsGiven(const std::string& flag) { return !FirstGiven({flag}).empty(); }

std::string FirstGiven(const std::vector<std::string>& flags) {
  const std::vector<std::string> given = GivenFlags();
  const auto first = std::find_if(flags.begin(), flags.end(), [&](const std::string& flag) {
    return std::find(given.begin(), given.end(), flag) != given.end();
  });
  return first == flags.end() ? "" : *first;
}

bool Refuse(const std::string& message, std::string* error) {
  *error = message;
  return false;
}

bool WrongValue(const std::string& flag, const std::string& value, const std::string& expected,
                std::string* error) {
  return Refuse("--" + flag + "=" + value + ": expected " + expected, error);
}

bool CheckThreads(int threads, int least, std::string* error) {
  constexpr int kMost = 1024;  // threads: more than any machine of today has cores
  if (threads >= least && threads <= kMost) return true;
  return WrongValue("threads", std::to_string(threads),
                    std::to_string(least) + " to " + std::to_string(kMost), error);
}

std::vector<std::string> SplitCommas(const std::string& text) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : text + ",") {
    if (c != ',') {
      part += c;
    } else if (!part.empty()) {
      parts.push_back(part);
      part.clear();
    }
  }
  return parts;
}

}  // namespace rigel
