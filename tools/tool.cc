#include "rigel/tools/tool.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <system_error>

#include <gflags/gflags.h>
#include <glog/logging.h>

#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/output_place.h"
#include "rigel/problems/io/version.h"
#include "rigel/problems/io/whole_file.h"

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

// The name of a flag as it is given, "--name=value"; empty if it is none.
std::string FlagName(const std::string& argument) {
  const size_t begin = argument.find_first_not_of('-');
  if (begin == 0 || begin > 2 || begin == std::string::npos) return "";
  return argument.substr(begin, std::min(argument.find('='), argument.size()) - begin);
}

// The flag files of the command line: inputs, too.
std::vector<std::string>& FlagFiles() {
  static std::vector<std::string> files;
  return files;
}

// gflags reads the flag files that a flag file names, and those of an environment variable, until
// the stack ends where they name each other. Of one file all is read that a user may want; a
// message if there is more to it. gflags opens it again, which a pipe does not bear.
std::string FlagFileError(const std::string& path) {
  // Bytes of one file: flags are lines that people write.
  constexpr size_t kMaxBytes = 1 << 20;
  const std::string flag = "--flagfile=" + PrintablePath(path) + ": ";
  std::error_code code;
  const auto type = std::filesystem::status(path, code).type();
  if (type != std::filesystem::file_type::regular && std::filesystem::exists(path, code)) {
    return flag + "no regular file, expected one";
  }
  FlagFiles().push_back(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) return flag + "cannot be opened: " + std::strerror(errno);
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return flag + "cannot be read";
  if (file) return flag + "larger than 1 MiB, expected flags, one a line";
  text.resize(static_cast<size_t>(file.gcount()));
  std::istringstream lines(text);
  int number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    line.erase(0, std::min(line.find_first_not_of(" \t\r\v\f"), line.size()));
    const std::string name = FlagName(line);
    if (name == "flagfile" || name == "fromenv" || name == "tryfromenv") {
      return flag + "line " + std::to_string(number) + ": --" + name +
             " is not taken from a flag file, only from the command line";
    }
  }
  return "";
}

// A message if a flag file is named that is not to be read.
std::string FlagFilesError(int argc, char** argv) {
  for (int k = 1; k < argc && std::strcmp(argv[k], "--") != 0; ++k) {
    const std::string argument = argv[k];
    const std::string name = FlagName(argument);
    if (name != "flagfile" && name != "fromenv" && name != "tryfromenv") continue;
    const size_t equals = argument.find('=');
    const bool next = equals == std::string::npos;
    if (next && k + 1 == argc) return "";  // no value: gflags tells it
    for (const std::string& part : SplitCommas(next ? argv[k + 1] : argument.substr(equals + 1))) {
      const std::string error =
          name == "flagfile" ? FlagFileError(part)
          : part == "flagfile"
              ? "--" + name + "=flagfile: a flag file is only taken from the command line"
              : "";
      if (!error.empty()) return error;
    }
  }
  return "";
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
  std::cout
      << "\nExit code: 0 done, 1 failed, 2 wrong flag, 3 a bound that a flag set was missed.\n";
}

}  // namespace

int RunProgram(int argc, char** argv, const std::string& usage, int (*run)()) {
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

bool IsStdout(const std::string& path) {
  return path == "-" || (!path.empty() && FollowLinks(path).descriptor == STDOUT_FILENO);
}

bool WriteOutput(const std::string& path, const std::string& text) {
  if (path.empty()) return true;
  if (IsStdout(path)) {
    std::cout << text;
    return FlushStdout();
  }
  std::string error;
  if (WriteWholeFile(path, text, &error)) return true;
  std::cerr << error << "\n";
  return false;
}

bool SameOutputFile(const std::string& path1, const std::string& path2) {
  if (path1.empty() || path2.empty() || IsStdout(path1) || IsStdout(path2)) return false;
  return SamePlace(FollowLinks(path1), FollowLinks(path2));
}

bool OutputsDiffer(const std::vector<OutputFlag>& outputs, std::string* error) {
  OutputPlace out;
  out.kind = OutputPlace::Kind::kDescriptor;
  out.descriptor = STDOUT_FILENO;
  const bool has_stdout = fstat(STDOUT_FILENO, &out.status) == 0;
  for (size_t k = 0; k < outputs.size(); ++k) {
    const auto& [flag, file] = outputs[k];
    const std::string value = "--" + flag + "=" + file;
    for (size_t i = 0; i < k; ++i) {
      const auto& [first_flag, first_file] = outputs[i];
      if (IsStdout(file) && IsStdout(first_file)) {
        *error = value + ": stdout has that of --" + first_flag +
                 " already; name a file for one of them";
        return false;
      }
      if (SameOutputFile(first_file, file)) {
        *error = value + ": that of --" + first_flag +
                 " goes to this file already; name another for one of them";
        return false;
      }
    }
    if (has_stdout && !file.empty() && !IsStdout(file) && SamePlace(FollowLinks(file), out)) {
      *error = value + ": stdout goes to this file already; name another";
      return false;
    }
  }
  return true;
}

bool OutputsAreNoInputs(const std::vector<OutputFlag>& outputs,
                        const std::vector<std::string>& inputs, std::string* error) {
  std::vector<std::pair<std::string, struct stat>> files;
  struct stat status;
  if (fstat(STDOUT_FILENO, &status) == 0 && S_ISREG(status.st_mode)) {
    files.emplace_back("stdout", status);
  }
  for (const OutputFlag& output : outputs) {
    if (output.second.empty() || output.second == "-") continue;
    const OutputPlace place = FollowLinks(output.second);
    if (S_ISREG(place.status.st_mode)) {
      files.emplace_back("--" + output.first + "=" + output.second, place.status);
    }
  }
  if (files.empty()) return true;
  std::vector<std::string> all = inputs;
  all.insert(all.end(), FlagFiles().begin(), FlagFiles().end());
  for (const std::string& input : all) {
    if ((input == "-" ? fstat(STDIN_FILENO, &status) : stat(input.c_str(), &status)) != 0) continue;
    for (const auto& [output, of_output] : files) {
      if (status.st_dev != of_output.st_dev || status.st_ino != of_output.st_ino) continue;
      *error = output + ": is the input " + PrintablePath(input == "-" ? "stdin" : input) +
               ", which it would destroy";
      return false;
    }
  }
  return true;
}

bool ReadInput(const std::string& path, std::string* text) {
  // Bytes, as for any JSON (kMaxJsonBytes): a wrong file must not fill the memory.
  constexpr size_t kMaxBytes = size_t{1} << 30;
  InputBytes bytes;
  std::string error;
  if (!ReadInputFile(path, &bytes, &error, kMaxBytes)) {
    std::cerr << error << "\n";
    return false;
  }
  std::string_view input = bytes.text();
  int64_t line;
  if (!CheckText(&input, &line, &error)) {
    std::cerr << PrintablePath(InputName(path)) << (line > 0 ? ":" + std::to_string(line) : "")
              << ": " << error << ", expected UTF-8 text\n";
    return false;
  }
  *text = std::string(input);
  return true;
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
  if (terminal_ && shown_) std::cerr << "\r\033[K" << std::flush;
}

void Progress::Step() {
  if (!terminal_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  Show("");
}

void Progress::Note(const std::function<std::string()>& text) {
  if (!terminal_) return;
  constexpr std::chrono::milliseconds kPause(300);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - noted_ < kPause) return;
  noted_ = now;
  Show("; " + text());
}

void Progress::Show(const std::string& note) {
  shown_ = true;
  std::cerr << "\r" << what_ << ": " << done_ << " of " << total_ << note << "\033[K" << std::flush;
}

}  // namespace rigel
