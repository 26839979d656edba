// Outputs that are there whole or not at all, and that destroy nothing else.
//
// The links of a path are followed. A regular file, or nothing, is replaced: the text is written to
// a temporary file beside it, which gets its mode and owner and then takes its place. All else that
// can be written to, a device, a FIFO or /dev/stdout, is written to and stays what it is.
//
// Temporaries are called NAME.rigel-tmp0 to 9 and are locked (flock) while their run lives. What a
// killed run left behind is known by that: it is removed by the next that writes the file.
//
// Messages are one line of printable text.
#ifndef RIGEL_PROBLEMS_IO_WHOLE_FILE_H_
#define RIGEL_PROBLEMS_IO_WHOLE_FILE_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/problems/io/output_place.h"

namespace rigel {

// False with a message if that fails; a file that was there is then as it was.
bool WriteWholeFile(const std::string& path, const std::string& text, std::string* error);

// False with a message if WriteWholeFile() would fail, as far as can be known before.
bool CanWriteWholeFile(const std::string& path, std::string* error);

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

// Removes from a directory what killed runs left of files whose names `is_ours` knows.
void RemoveLeftOvers(const std::string& directory,
                     const std::function<bool(const std::string& name)>& is_ours);

// Lets what a killed run left of a file take its place if `accept` knows the temporary as whole.
// Whether there was such a one.
bool FinishLeftOver(const std::string& path,
                    const std::function<bool(const std::string& temporary)>& accept);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_WHOLE_FILE_H_
