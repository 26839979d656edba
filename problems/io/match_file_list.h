// Which match files a path stands for.
#ifndef RIGEL_PROBLEMS_IO_MATCH_FILE_LIST_H_
#define RIGEL_PROBLEMS_IO_MATCH_FILE_LIST_H_

#include <string>
#include <vector>

namespace rigel {

// The match files of some paths, as they are found out.
struct MatchFileList {
  std::vector<std::string> paths;
  std::vector<std::string> errors;
  std::vector<std::string> by_number;  // directories whose order is not byte order
  bool has_stdin = false;

  // Adds a file, "-" for stdin, or the match files of a directory.
  void Add(const std::string& path);
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_MATCH_FILE_LIST_H_
