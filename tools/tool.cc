#include "rigel/tools/tool.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <system_error>

#include <gflags/gflags.h>
#include <glog/logging.h>

#include "rigel/problems/csv.h"
#include "rigel/tools/version.h"

// gflags leaves the process through this pointer, with code 1; it is not in a public header.
namespace google {
extern void (*gflags_exitfunc)(int);
}

namespace rigel {
namespace {

std::string ProgramName() { return gflags::ProgramInvocationShortName(); }

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

void PrintHelp(const std::string& usage) {
  std::cout << usage << "\nFlags:\n";
  for (const auto& flag : OwnFlags()) {
    std::string head = "  --" + flag.name;
    if (flag.type != "bool")
      head += "=" + (flag.default_value.empty() ? "\"\"" : PlainValue(flag, flag.default_value));
    else
      head += flag.default_value == "true" ? "  (on; --no" + flag.name + " is off)" : "  (off)";
    std::cout << head << "\n";
    // Wrapped at 92 columns behind an indent of 6.
    std::string line;
    const auto flush = [&] {
      if (!line.empty()) std::cout << "      " << line << "\n";
      line.clear();
    };
    std::string word;
    for (const char c : flag.description + " ") {
      if (c != ' ') {
        word += c;
        continue;
      }
      if (line.size() + word.size() + 1 > 92) flush();
      line += (line.empty() ? "" : " ") + word;
      word.clear();
    }
    flush();
  }
  std::cout << "\nExit code: 0 done, 1 failed, 2 wrong flag.\n";
}

}  // namespace

void ParseFlags(const std::string& usage, int* argc, char*** argv) {
  // The user of a program wants its own messages, not the libraries' log lines.
  FLAGS_minloglevel = google::GLOG_FATAL;
  google::InitGoogleLogging((*argv)[0]);
  gflags::SetUsageMessage(usage);
  gflags::SetVersionString(RIGEL_VERSION);
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
      std::cout << ProgramName() << " " << RIGEL_VERSION << "\n";
      std::exit(FlushStdout() ? kExitDone : kExitFailed);
    }
  }
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

bool FlushStdout() {
  if (std::cout.flush()) return true;
  std::cerr << ProgramName() << ": stdout: cannot be written\n";
  return false;
}

bool WriteOutput(const std::string& path, const std::string& text) {
  if (path.empty()) return true;
  if (path == "-") {
    std::cout << text;
    return FlushStdout();
  }
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    std::cerr << path << ": cannot be opened for writing: " << std::strerror(errno) << "\n";
    return false;
  }
  bool ok = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  // The disk may turn out to be full only here.
  ok = std::fclose(file) == 0 && ok;
  if (!ok) std::cerr << path << ": cannot be written: " << std::strerror(errno) << "\n";
  return ok;
}

bool SameOutputFile(const std::string& path1, const std::string& path2) {
  namespace fs = std::filesystem;
  if (path1.empty() || path2.empty() || path1 == "-" || path2 == "-") return false;
  std::error_code ignored;
  if (fs::exists(path1, ignored) && !fs::is_regular_file(path1, ignored)) return false;
  if (path1 == path2) return true;
  const fs::path real1 = fs::weakly_canonical(fs::absolute(path1, ignored), ignored);
  const fs::path real2 = fs::weakly_canonical(fs::absolute(path2, ignored), ignored);
  return !real1.empty() && real1 == real2;
}

bool OutputsDiffer(const std::vector<OutputFlag>& outputs, std::string* error) {
  for (size_t k = 0; k < outputs.size(); ++k) {
    const auto& [flag, file] = outputs[k];
    for (size_t i = 0; i < k; ++i) {
      const auto& [first_flag, first_file] = outputs[i];
      if (file == "-" && first_file == "-") {
        *error = "--" + std::string(flag) + "=-: stdout has that of --" + first_flag +
                 " already; name a file for one of them";
        return false;
      }
      if (SameOutputFile(first_file, file)) {
        *error = "--" + std::string(flag) + "=" + file + ": that of --" + first_flag +
                 " goes to this file already; name another for one of them";
        return false;
      }
    }
  }
  return true;
}

bool ReadInput(const std::string& path, std::string* text) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) {
    std::cerr << path << ": cannot be opened: " << std::strerror(errno) << "\n";
    return false;
  }
  text->clear();
  char buffer[1 << 16];
  for (size_t n; (n = std::fread(buffer, 1, sizeof(buffer), file)) > 0;) text->append(buffer, n);
  const bool ok = std::ferror(file) == 0;
  if (!ok) std::cerr << path << ": cannot be read: " << std::strerror(errno) << "\n";
  std::fclose(file);
  return ok;
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

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(total), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (terminal_ && done_ > 0) std::cerr << "\r\033[K" << std::flush;
}

void Progress::Step() {
  if (!terminal_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  std::cerr << "\r" << what_ << ": " << done_ << " of " << total_ << "\033[K" << std::flush;
}

}  // namespace rigel
