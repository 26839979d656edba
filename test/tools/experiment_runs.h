// Small runs of rigel_experiment, for its tests and those of its figures.
#ifndef RIGEL_TEST_TOOLS_EXPERIMENT_RUNS_H_
#define RIGEL_TEST_TOOLS_EXPERIMENT_RUNS_H_

#include <cstdlib>
#include <filesystem>
#include <string>

#include "rigel/test/tools/tools_test.h"

namespace rigel {

// Beside its results each run gives figures, where matplotlib is.
inline const Args kSmall = {"--name=outliers", "--quick", "--pairs=2", "--no_times"};
// Ten frames straight ahead, 1 m each.
inline void WritePoses(const std::string& path) {
  std::string text;
  for (int k = 0; k < 10; ++k) text += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
  WriteText(path, text);
}

class ExperimentTest : public ToolsTest {
 protected:
  Outcome Experiment(const Args& args) { return RunTool("experiment", args + Args{"--nofigures"}); }

  // A matplotlib that cannot be imported hides the real one.
  void HideMatplotlib() {
    std::filesystem::create_directories(Path("hide/matplotlib"));
    WriteText(Path("hide/matplotlib/__init__.py"), "raise ImportError('hidden')\n");
    setenv("PYTHONPATH", Path("hide").c_str(), 1);
  }
  void TearDown() override {
    unsetenv("PYTHONPATH");
    ToolsTest::TearDown();
  }
};

}  // namespace rigel

#endif  // RIGEL_TEST_TOOLS_EXPERIMENT_RUNS_H_
