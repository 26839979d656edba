// Files that are there whole or not at all.
#ifndef RIGEL_PROBLEMS_WHOLE_FILE_H_
#define RIGEL_PROBLEMS_WHOLE_FILE_H_

#include <string>
#include <utility>
#include <vector>

namespace rigel {

// Writes `text` to a temporary file beside `path`, which then takes its place, so that `path` is
// never half a file. False with a message, one line of printable text, if that fails.
bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error);

// Several such files whose temporaries are all written before the first takes its place: what can
// fail, a full disk above all, then fails before anything has changed.
class StagedFiles {
 public:
  StagedFiles() = default;
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;
  // Removes the temporaries that did not take their place.
  ~StagedFiles();

  // False with a message if the temporary file cannot be written.
  bool Add(const std::string& path, const std::string& text, std::string* error);

  // Puts all in their places, in order. False with a message at the first that cannot be put there.
  bool Commit(std::string* error);

  int committed() const { return committed_; }

 private:
  std::vector<std::pair<std::string, std::string>> files_;  // temporary, path
  int committed_ = 0;
};

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_WHOLE_FILE_H_
