// Match files of the frame pairs of an image sequence: a run that can be interrupted and resumed.
#ifndef RIGEL_PROBLEMS_IMAGES_SEQUENCE_MATCHING_H_
#define RIGEL_PROBLEMS_IMAGES_SEQUENCE_MATCHING_H_

#include <functional>
#include <string>
#include <vector>

#include "rigel/problems/images/image_features.h"
#include "rigel/problems/images/image_sequence.h"

namespace rigel {

struct SequenceMatchingOptions {
  FeatureOptions features;
  // Pairs are (first, first + stride), (first + stride, first + 2 stride), ... up to last.
  int first = 0;
  int last = -1;  // negative: the last frame of the sequence
  int stride = 1;
  int num_threads = 1;  // the files do not depend on it
  // Keep the complete files of an earlier run of the same settings, and do the rest.
  bool resume = false;

  bool IsValid(std::string* error) const;
};

struct SequenceMatchingSummary {
  int num_pairs = 0;  // those of the range
  int written = 0;
  int kept = 0;  // were there already
  // One line an image that is not there (of pairs that have none at all there is only their number,
  // in `notes`), an image that could not be used or a file that could not
  // be written, in order. The pairs that they touch are neither written nor kept; all others are.
  std::vector<std::string> missing;
  std::vector<std::string> errors;
  // The ends of the range that have no image at all, and how many pairs have none.
  std::vector<std::string> notes;
};

// Writes DIRECTORY/000020-000021.matches, ..., named after the frames, each complete or not there
// at all. The directory is made if missing; DIRECTORY/rigel_match.settings says what the files were
// made with. Without `resume` a directory that has match files is refused, and always one with
// match files that are not of this run: they would be read as if they were.
//
// `begin` is called with the number of pairs to do before the first, `step` after each, from any
// thread. False with a message, and nothing done, if the range is not in the sequence or the
// directory cannot be used. What fails later is in summary->errors.
bool MatchSequence(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                   const std::string& directory, const std::function<void(int)>& begin,
                   const std::function<void()>& step, SequenceMatchingSummary* summary,
                   std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_SEQUENCE_MATCHING_H_
