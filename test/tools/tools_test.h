// What the tests of the programs share: run one as a user would and look at all that it leaves.
#ifndef RIGEL_TEST_TOOLS_TOOLS_TEST_H_
#define RIGEL_TEST_TOOLS_TOOLS_TEST_H_

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace rigel {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

struct Outcome {
  std::string command;  // for messages
  int exit_code = -1;   // -1 if a signal ended the program
  int signal = 0;       // SIGALRM: it ran for more than five minutes
  std::string out;
  std::string err;
};

enum class Stdout { kCaptured, kClosed, kFullDevice, kBrokenPipe };

// What the system gives a program, as `ulimit` sets it; 0 is as the test has it.
struct Limits {
  size_t memory_bytes = 0;
  size_t file_bytes = 0;
  size_t processes = 0;  // threads are among them
  // Root knows no limits of processes and no modes of files: the program runs as another user.
  bool as_nobody = false;
};

// Runs "rigel_NAME" and waits for it. stdin is the file `in`.
Outcome RunTool(const std::string& name, const Args& args, Stdout to = Stdout::kCaptured,
                const Limits& limits = {}, const std::string& in = "/dev/null");

std::string ReadText(const std::string& path);
void WriteText(const std::string& path, const std::string& text);
std::vector<std::string> Lines(const std::string& text);

// The columns of the longest line, counted in UTF-8 characters.
size_t Width(const std::string& text);

// `args`, then `more`.
Args operator+(Args args, const Args& more);

// Parses JSON; a failed expectation and null if it is none, or if there is a null or anything that
// is not a finite number anywhere in it.
Json ParseReport(const std::string& text);

std::vector<std::string> Keys(const Json& object);

// Takes the entries out that may differ from run to run.
Json WithoutTimes(Json report);

// Turns the bodies of the match files of a directory, x right and y down, to x forward and z up,
// and takes out what they state of the motion but for the truth.
void MakeZUpWithoutPriors(const std::string& directory);

// Each test gets an empty directory of its own.
class ToolsTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  std::string Path(const std::string& name) const { return directory_ + "/" + name; }

  // Simulates match files in Path(name) and returns that path.
  std::string Simulate(const std::string& name, const Args& args);

 private:
  std::string directory_;
};

// Each with one readable line of what the program said.
#define EXPECT_EXIT_CODE(run, code)                                    \
  EXPECT_EQ((run).exit_code, code)                                     \
      << (run).command << "\nsignal " << (run).signal << "\nstdout:\n" \
      << (run).out << "\nstderr:\n"                                    \
      << (run).err
#define ASSERT_EXIT_CODE(run, code)                                    \
  ASSERT_EQ((run).exit_code, code)                                     \
      << (run).command << "\nsignal " << (run).signal << "\nstdout:\n" \
      << (run).out << "\nstderr:\n"                                    \
      << (run).err

}  // namespace rigel

#endif  // RIGEL_TEST_TOOLS_TOOLS_TEST_H_
