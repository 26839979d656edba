#include "rigel/tools/flag_files.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>

#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/tools/tool.h"

namespace rigel {
namespace {

// The name of a flag as it is given, "--name=value"; empty if it is none.
std::string FlagName(const std::string& argument) {
  const size_t begin = argument.find_first_not_of('-');
  if (begin == 0 || begin > 2 || begin == std::string::npos) return "";
  return argument.substr(begin, std::min(argument.find('='), argument.size()) - begin);
}

// Flags of gflags that name further flags: those of a file, and of environment variables.
bool NamesFlagFiles(const std::string& flag) {
  return flag == "flagfile" || flag == "fromenv" || flag == "tryfromenv";
}

std::vector<std::string>& FilesOfCommandLine() {
  static std::vector<std::string> files;
  return files;
}

// A message if the file cannot be read or names another flag file.
std::string FlagFileError(const std::string& path) {
  // Bytes of one file: flags are lines that people write.
  constexpr size_t kMaxBytes = 1 << 20;
  const std::string flag = "--flagfile=" + PrintablePath(path) + ": ";
  std::error_code code;
  const auto type = std::filesystem::status(path, code).type();
  // gflags opens the file again, which a pipe does not bear.
  if (type != std::filesystem::file_type::regular && std::filesystem::exists(path, code)) {
    return flag + "no regular file, expected one";
  }
  FilesOfCommandLine().push_back(path);
  InputBytes bytes;
  std::string error;
  if (!ReadInputFile(path, &bytes, &error, kMaxBytes)) return "--flagfile: " + error;
  std::string_view text = bytes.text();
  int64_t number = 0;
  if (!CheckText(&text, &number, &error)) return flag + error + ", expected UTF-8 text";
  // gflags does not decompress.
  if (std::filesystem::file_size(path, code) != bytes.size()) {
    return flag + "compressed, expected plain text";
  }
  std::istringstream lines{std::string(text)};
  number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    line.erase(0, std::min(line.find_first_not_of(" \t\r\v\f"), line.size()));
    const std::string name = FlagName(line);
    if (NamesFlagFiles(name)) {
      return flag + "line " + std::to_string(number) + ": --" + name +
             " is not taken from a flag file, only from the command line";
    }
  }
  return "";
}

}  // namespace

std::string FlagFilesError(int argc, char** argv) {
  for (int k = 1; k < argc && std::strcmp(argv[k], "--") != 0; ++k) {
    const std::string argument = argv[k];
    const std::string name = FlagName(argument);
    if (!NamesFlagFiles(name)) continue;
    const size_t equals = argument.find('=');
    const bool next = equals == std::string::npos;
    if (next && k + 1 == argc) return "";  // no value: gflags tells it
    for (const std::string& part : SplitCommas(next ? argv[k + 1] : argument.substr(equals + 1))) {
      std::string error =
          name == "flagfile" ? FlagFileError(part)
          : part == "flagfile"
              ? "--" + name + "=flagfile: a flag file is only taken from the command line"
              : "";
      if (!error.empty()) return error;
    }
  }
  return "";
}

const std::vector<std::string>& FlagFiles() { return FilesOfCommandLine(); }

}  // namespace rigel
