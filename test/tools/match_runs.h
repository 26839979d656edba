// Runs of rigel_match on images that are drawn, for its tests.
#ifndef RIGEL_TEST_TOOLS_MATCH_RUNS_H_
#define RIGEL_TEST_TOOLS_MATCH_RUNS_H_

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "rigel/problems/io/match_file.h"
#include "rigel/test/problems/images/plane_scene.h"
#include "rigel/test/tools/tools_test.h"

namespace rigel {

namespace fs = std::filesystem;

inline constexpr int kFrames = 4;

// Drawn once, for all tests; who changes it works on a copy.
inline const std::string& Data() {
  static const std::string* const data = [] {
    auto* const path = new std::string(testing::TempDir() + "/rigel_match_XXXXXX");
    EXPECT_NE(mkdtemp(path->data()), nullptr);
    const PlaneScene scene;
    WriteEurocScene(scene, kFrames, *path + "/plane");
    WriteKittiScene(scene, kFrames, "06", *path + "/kitti");
    std::atexit([] { fs::remove_all(Data()); });
    return path;
  }();
  return *data;
}

class MatchTest : public ToolsTest {
 protected:
  // The names of the files of a directory.
  std::vector<std::string> Names(const std::string& directory) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // All match files of a directory, one after the other, with their names.
  std::string Bytes(const std::string& directory) {
    std::string bytes;
    for (const std::string& name : Names(directory)) {
      bytes += name + "\n" + ReadText(directory + "/" + name);
    }
    return bytes;
  }

  FramePair Read(const std::string& path) {
    FramePair pair;
    std::string error;
    EXPECT_TRUE(ReadMatchFile(path, &pair, &error)) << error;
    return pair;
  }

  Outcome Euroc(const std::string& output, const Args& args = {}) {
    return RunTool("match", Args{"--euroc_root=" + Data() + "/plane", "--max_features=300",
                                 "--output=" + Path(output)} +
                                args);
  }
  Outcome Kitti(const std::string& output, const Args& args = {}) {
    return RunTool("match", Args{"--kitti_root=" + Data() + "/kitti", "--sequence=06",
                                 "--max_features=300", "--output=" + Path(output)} +
                                args);
  }
};

}  // namespace rigel

#endif  // RIGEL_TEST_TOOLS_MATCH_RUNS_H_
