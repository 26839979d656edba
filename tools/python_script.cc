#include "rigel/tools/python_script.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "rigel/problems/io/match_file.h"

namespace rigel {
namespace {

// What a script exits with where a module is missing; it says which.
constexpr int kNoModule = 4;
// As a shell has it.
constexpr int kNoPython = 127;

std::string ScriptPath(const std::string& name) {
  std::error_code code;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
  return code ? name : (program.parent_path() / name).string();
}

std::string Quoted(const std::string& argument) {
  const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./,+:@%";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

ScriptOutcome RunScript(const std::string& name, const std::vector<std::string>& arguments,
                        std::string* error) {
  const std::string script = ScriptPath(name);
  std::error_code code;
  if (!std::filesystem::exists(script, code)) {
    *error = PrintablePath(script) + " is not there";
    return ScriptOutcome::kUnavailable;
  }
  std::vector<std::string> words = {"python3", script};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    // It ends with the program, even if that is killed: the next run writes the same files.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kNoPython);
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGXFSZ, SIG_DFL);
    execvp("python3", argv.data());
    _exit(kNoPython);
  }
  if (child < 0) {
    *error = std::string("no process for python3: ") + std::strerror(errno);
    return ScriptOutcome::kUnavailable;
  }
  int status = -1;  // no exit of the child, should waitpid() fail
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return ScriptOutcome::kDone;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoModule) {
    *error = "python3 lacks a module of " + PrintablePath(script);
    return ScriptOutcome::kUnavailable;
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoPython) {
    *error = "python3 cannot be run";
    return ScriptOutcome::kUnavailable;
  }
  *error = PrintablePath(script) + " failed";
  return ScriptOutcome::kFailed;
}

std::string ScriptCommand(const std::string& name, const std::vector<std::string>& arguments) {
  std::string command = "python3 " + Quoted(ScriptPath(name));
  for (const std::string& argument : arguments) command += " " + Quoted(argument);
  return command;
}

}  // namespace rigel
