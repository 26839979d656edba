#include "rigel/tools/plot_script.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "rigel/problems/match_file.h"

namespace rigel {
namespace {

// What the script exits with where matplotlib is missing.
constexpr int kNoMatplotlib = 4;
// As a shell has it.
constexpr int kNoPython = 127;

std::string ScriptPath() {
  std::error_code code;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
  return code ? "rigel_plot.py" : (program.parent_path() / "rigel_plot.py").string();
}

std::string Quoted(const std::string& argument) {
  const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./,+:@%";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

PlotOutcome RunPlotScript(const std::vector<std::string>& arguments, std::string* error) {
  const std::string script = ScriptPath();
  std::error_code code;
  if (!std::filesystem::exists(script, code)) {
    *error = "no figures: " + PrintablePath(script) + " is not there";
    return PlotOutcome::kUnavailable;
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
    // It ends with the program, even if that is killed: the next run draws the same files.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(kNoPython);
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGXFSZ, SIG_DFL);
    execvp("python3", argv.data());
    _exit(kNoPython);
  }
  if (child < 0) {
    *error = std::string("no figures: no process for python3: ") + std::strerror(errno);
    return PlotOutcome::kUnavailable;
  }
  int status = -1;  // no exit of the child, should waitpid() fail
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return PlotOutcome::kDone;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoMatplotlib) {
    *error = "no figures: python3 has no matplotlib (Debian: apt install python3-matplotlib)";
    return PlotOutcome::kUnavailable;
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoPython) {
    *error = "no figures: python3 cannot be run";
    return PlotOutcome::kUnavailable;
  }
  *error = "no figures: " + PrintablePath(script) + " failed";
  return PlotOutcome::kFailed;
}

std::string PlotCommand(const std::vector<std::string>& arguments) {
  std::string command = "python3 " + Quoted(ScriptPath());
  for (const std::string& argument : arguments) command += " " + Quoted(argument);
  return command;
}

}  // namespace rigel
