// Runs of rigel_compare, for its tests.
#ifndef RIGEL_TEST_TOOLS_COMPARE_RUNS_H_
#define RIGEL_TEST_TOOLS_COMPARE_RUNS_H_

#include <string>

#include "rigel/test/tools/tools_test.h"

namespace rigel {

class CompareTest : public ToolsTest {
 protected:
  Json Compare(const Args& args) {
    const Outcome run = RunTool("compare", args + Args{"--json=-"});
    EXPECT_EXIT_CODE(run, 0);
    return ParseReport(run.out);
  }

  // The entry of the one solver of a run, over all pairs.
  Json Entry(const Args& args) {
    const Json report = Compare(args);
    if (!report.is_object() || report["results"].size() != 1) {
      ADD_FAILURE() << "not one result: " << report.dump();
      return Json::object();
    }
    return report["results"][0];
  }

  // Takes the line that starts with `keyword` out of a match file.
  void RemoveLine(const std::string& path, const std::string& keyword) {
    std::string text;
    for (const std::string& line : Lines(ReadText(path))) {
      if (line.rfind(keyword + " ", 0) != 0) text += line + "\n";
    }
    WriteText(path, text);
  }

  void AddLine(const std::string& path, const std::string& line) {
    const std::string text = ReadText(path);
    const size_t end = text.find('\n') + 1;
    WriteText(path, text.substr(0, end) + line + "\n" + text.substr(end));
  }
};

}  // namespace rigel

#endif  // RIGEL_TEST_TOOLS_COMPARE_RUNS_H_
