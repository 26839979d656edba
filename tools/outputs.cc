#include "rigel/tools/outputs.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/output_place.h"
#include "rigel/problems/io/whole_file.h"
#include "rigel/tools/flag_files.h"
#include "rigel/tools/tool.h"

namespace rigel {

bool FlushStdout() {
  if (std::cout.flush()) return true;
  std::cerr << ProgramName() << ": stdout: cannot be written\n";
  return false;
}

bool IsStdout(const std::string& path) {
  return path == "-" || (!path.empty() && FollowLinks(path).descriptor == STDOUT_FILENO);
}

bool PrintTable(const std::string& table, const std::vector<OutputFlag>& outputs) {
  const bool taken = std::any_of(outputs.begin(), outputs.end(),
                                 [](const OutputFlag& output) { return IsStdout(output.second); });
  if (taken) return true;
  std::cout << table;
  return FlushStdout();
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
        return Refuse(
            value + ": --" + first_flag + " goes to stdout already; name a file for one of them",
            error);
      }
      if (SameOutputFile(first_file, file)) {
        return Refuse(value + ": --" + first_flag +
                          " writes to this file already; name another for one of them",
                      error);
      }
    }
    if (has_stdout && !file.empty() && !IsStdout(file) && SamePlace(FollowLinks(file), out)) {
      return Refuse(value + ": stdout goes to this file already; name another", error);
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
      return Refuse(
          output + ": would overwrite the input " + PrintablePath(input == "-" ? "stdin" : input),
          error);
    }
  }
  return true;
}

}  // namespace rigel
