// Output files that are complete or absent, never partly written.
//
// Links in the path are followed. A regular or absent file is replaced: the text is written to a
// temporary file in the same directory, which gets the mode and owner of the old file and is then
// renamed. Devices, FIFOs and /dev/stdout are written to directly.
//
// Temporary files are named NAME.rigel-tmp0 to 9 and are locked (flock) while their run lives. A
// temporary file without a lock was left by a killed run. The next run that writes the file removes
// it.
//
// Messages are one line of printable text.
#ifndef RIGEL_PROBLEMS_IO_WHOLE_FILE_H_
#define RIGEL_PROBLEMS_IO_WHOLE_FILE_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/problems/io/output_place.h"

namespace rigel {

// False with a message if that fails. An old file is then unchanged.
bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error);

// Checks in advance whether WriteWholeFile() can succeed. False with a message if not.
bool CanWriteWholeFile(const std::string& path, std::string* error);

// Several such files. All temporary files are written before the first is renamed, so that most
// failures, such as a full disk, occur before any output has changed.
class StagedFiles {
 public:
  StagedFiles() = default;
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;
  // Removes the temporary files that were not renamed.
  ~StagedFiles();

  // False with a message if the temporary file cannot be written.
  bool Add(const std::string& path, const std::string& text, std::string* error);

  // Renames all in order. False with a message at the first that fails.
  bool Commit(std::string* error);

  int committed() const { return committed_; }

 private:
  struct File {
    OutputPlace place;
    std::string name;       // as the caller calls it, for messages
    std::string temporary;  // empty: `text` is written to the place itself
    std::string text;
    int lock = -1;  // the open temporary, -1 if it is not locked
  };

  std::vector<File> files_;
  int committed_ = 0;
};

// Removes the temporary files of killed runs from a directory: those of names that `is_ours`
// accepts.
void RemoveLeftOvers(const std::string& directory,
                     const std::function<bool(const std::string& name)>& is_ours);

// Completes a file of a killed run: renames its temporary file if `accept` finds it complete. True
// if there was one.
bool FinishLeftOver(const std::string& path,
                    const std::function<bool(const std::string& temporary)>& accept);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_WHOLE_FILE_H_
