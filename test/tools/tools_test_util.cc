#include <fcntl.h>
#include <grp.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/match_file_list.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {
namespace {

constexpr unsigned kTimeoutSeconds = 300;  // under sanitizers on a busy machine

void Redirect(const char* path, int flags, int to) {
  const int from = open(path, flags, 0600);
  if (from < 0 || dup2(from, to) < 0) _exit(125);
  if (from != to) close(from);
}

void Limit(int resource, size_t value) {
  const rlimit limit = {value, value};
  if (value > 0 && setrlimit(resource, &limit) != 0) _exit(125);
}

// The user first: a limit that is exceeded already would stop the change.
void SetLimits(const Limits& limits) {
  constexpr int kNobody = 65534;
  if (limits.as_nobody && geteuid() == 0 &&
      (setgroups(0, nullptr) != 0 || setgid(kNobody) != 0 || setuid(kNobody) != 0)) {
    _exit(125);
  }
  Limit(RLIMIT_AS, limits.memory_bytes);
  Limit(RLIMIT_FSIZE, limits.file_bytes);
  Limit(RLIMIT_NPROC, limits.processes);
}

void ExpectFinite(const Json& json, const std::string& where) {
  EXPECT_FALSE(json.is_null()) << where << " is null";
  if (json.is_number()) {
    EXPECT_TRUE(std::isfinite(json.get<double>())) << where;
  }
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) ExpectFinite(value, where + "/" + key);
  } else if (json.is_array()) {
    for (size_t k = 0; k < json.size(); ++k) ExpectFinite(json[k], where + std::to_string(k));
  }
}

}  // namespace

Outcome RunTool(const std::string& name, const Args& args, Stdout to, const Limits& limits,
                const std::string& in) {
  Outcome run;
  const std::string program = std::string(RIGEL_PROGRAMS) + "/rigel_" + name;
  run.command = "rigel_" + name;
  for (const std::string& arg : args) run.command += " " + arg;
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& arg : args) argv.push_back(const_cast<char*>(arg.c_str()));
  argv.push_back(nullptr);

  // Files, not pipes: nothing to read while the program runs, so nothing that can block.
  std::string stem = testing::TempDir() + "/rigel_run_XXXXXX";
  const int fd = mkstemp(stem.data());
  if (fd < 0) {
    ADD_FAILURE() << "no temporary file in " << testing::TempDir();
    return run;
  }
  close(fd);
  const std::string out = stem + ".out";
  const std::string err = stem + ".err";
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;

  const pid_t child = fork();
  if (child == 0) {
    alarm(kTimeoutSeconds);  // outlives exec
    Redirect(in.c_str(), O_RDONLY, STDIN_FILENO);
    Redirect(err.c_str(), kWrite, STDERR_FILENO);
    switch (to) {
      case Stdout::kCaptured:
        Redirect(out.c_str(), kWrite, STDOUT_FILENO);
        break;
      case Stdout::kClosed:
        close(STDOUT_FILENO);
        break;
      case Stdout::kFullDevice:
        Redirect("/dev/full", O_WRONLY, STDOUT_FILENO);
        break;
      case Stdout::kBrokenPipe: {
        int ends[2];
        if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) _exit(125);
        close(ends[0]);
        close(ends[1]);
        // As under Python or a service manager; a shell's pipe would end the program by SIGPIPE.
        std::signal(SIGPIPE, SIG_IGN);
        break;
      }
    }
    SetLimits(limits);
    execv(program.c_str(), argv.data());
    _exit(126);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
  EXPECT_EQ(run.signal, 0) << run.command << " was ended by a signal";
  EXPECT_NE(run.exit_code, 126) << program << " cannot be run";
  if (to == Stdout::kCaptured) run.out = ReadText(out);
  run.err = ReadText(err);
  for (const std::string& path : {stem, out, err}) unlink(path.c_str());
  return run;
}

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path << " cannot be opened";
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void WriteText(const std::string& path, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  ASSERT_TRUE(file) << path << " cannot be written";
}

void MakeZUpWithoutPriors(const std::string& directory) {
  Eigen::Matrix3d B;
  B << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  std::vector<std::string> errors;
  for (const std::string& path : ListMatchFiles(directory, &errors)) {
    FramePair pair;
    std::string error;
    ASSERT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    for (RigCamera& camera : pair.rig.cameras) {
      camera.Q = B * camera.Q;
      camera.s = B * camera.s;
    }
    if (pair.truth) {
      pair.truth->R = B * pair.truth->R * B.transpose();
      pair.truth->t = B * pair.truth->t;
    }
    pair.prior = MotionPrior();
    ASSERT_TRUE(WriteMatchFile(path, pair, &error)) << error;
  }
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

size_t Width(const std::string& text) {
  size_t width = 0;
  for (const std::string& line : Lines(text)) {
    const auto characters =
        std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; });
    width = std::max(width, static_cast<size_t>(characters));
  }
  return width;
}

Args operator+(Args args, const Args& more) {
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

Json ParseReport(const std::string& text) {
  Json report = Json::parse(text, nullptr, false);
  if (report.is_discarded()) {
    ADD_FAILURE() << "not JSON:\n" << text;
    return Json();
  }
  ExpectFinite(report, "report");
  EXPECT_EQ(text.back(), '\n');
  return report;
}

std::vector<std::string> Keys(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

Json WithoutTimes(Json report) {
  if (report.is_object()) {
    for (const char* key :
         {"time_ms", "mean_us", "median_us", "spread_us", "ratio", "prepare_us", "reference_us"}) {
      report.erase(key);
    }
  }
  if (report.is_structured()) {
    for (auto& item : report) item = WithoutTimes(item);
  }
  return report;
}

void ToolsTest::SetUp() {
  directory_ = testing::TempDir() + "/rigel_tools_XXXXXX";
  ASSERT_NE(mkdtemp(directory_.data()), nullptr) << directory_;
}

void ToolsTest::TearDown() {
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

std::string ToolsTest::Simulate(const std::string& name, const Args& args) {
  const Outcome run = RunTool("simulate", Args{"--output=" + Path(name)} + args);
  EXPECT_EXIT_CODE(run, 0);
  return Path(name);
}

}  // namespace rigel
