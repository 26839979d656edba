// Files of sensors for tests, in a directory of the test.
#ifndef RIGEL_TEST_PROBLEMS_SENSORS_SENSORS_TEST_FILE_H_
#define RIGEL_TEST_PROBLEMS_SENSORS_SENSORS_TEST_FILE_H_

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigel {

class SensorFileTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "/rigel_sensors_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string Write(const std::string& text) {
    const std::string path = directory_ + "/a.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  std::string directory_;
};

}  // namespace rigel

#endif  // RIGEL_TEST_PROBLEMS_SENSORS_SENSORS_TEST_FILE_H_
