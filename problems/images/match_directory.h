// The directory that rigel_match fills: match files named after frames, and what they were made
// with.
#ifndef RIGEL_PROBLEMS_IMAGES_MATCH_DIRECTORY_H_
#define RIGEL_PROBLEMS_IMAGES_MATCH_DIRECTORY_H_

#include <set>
#include <string>
#include <vector>

#include "rigel/problems/images/image_sequence.h"
#include "rigel/problems/images/sequence_matching.h"

namespace rigel {

struct FrameIndices {
  int frame1, frame2;

  std::string FileName() const;  // "000020-000021.matches"
};

// Makes the directory ready for a run over `pairs`, and writes its settings. *kept are the names of
// the complete files of an earlier run. False with a message if it holds files that are not of this
// run, or that were made with other settings.
bool PrepareDirectory(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                      const std::vector<FrameIndices>& pairs, const std::string& directory,
                      std::set<std::string>* kept, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_MATCH_DIRECTORY_H_
