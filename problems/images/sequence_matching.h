// Match files of the frame pairs of an image sequence: a run that can be interrupted and resumed.
#ifndef RIGEL_PROBLEMS_IMAGES_SEQUENCE_MATCHING_H_
#define RIGEL_PROBLEMS_IMAGES_SEQUENCE_MATCHING_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
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
  // Whether the files get the column `landmark` (landmark_tracks.h). For it the images of one frame
  // are matched with each other as well.
  bool landmarks = false;
  // Keep the complete files of an earlier run of the same settings, and do the rest.
  bool resume = false;
  // Lines of the header that replace those of a pair (ReplaceHeaderLines() in
  // rigel/problems/io/match_header.h); may be empty. Called on any thread.
  std::function<std::map<std::string, std::string>(const FramePair& pair)> header_lines;
  std::string header_settings;  // lines of what they are made from, for the settings of the run

  bool IsValid(std::string* error) const;
};

struct SequenceMatchingSummary {
  int num_pairs = 0;  // those of the range
  int written = 0;
  int kept = 0;  // were there already
  // One line for each missing image, and one for each image that could not be used or file that
  // could not be written, in order. Pairs with such images are neither written nor kept. Of pairs
  // without any image `notes` has the number.
  std::vector<std::string> missing;
  std::vector<std::string> errors;
  // The ends of the range without an image, and the number of pairs without any.
  std::vector<std::string> notes;
};

// Writes DIRECTORY/000020-000021.matches, ..., named after the frames, each complete or absent. The
// directory is created if necessary. DIRECTORY/rigel_match.settings has the settings of the run. A
// directory with match files of another run is refused, as other programs would read them as files
// of this run. Without `resume` any directory with match files is refused.
//
// `begin` is called with the number of pairs to do before the first, `step` after each, from any
// thread. False with a message, and nothing done, if the range is not in the sequence or the
// directory cannot be used. What fails later is in summary->errors.
bool MatchSequence(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                   const std::string& directory, const std::function<void(int)>& begin,
                   const std::function<void()>& step, SequenceMatchingSummary* summary,
                   std::string* error);

struct TracksSummary {
  size_t observations = 0;
  int64_t landmarks = 0;
};

// Joins the match files that MatchSequence() wrote to tracks over all frames of the range, and
// writes them as a track file (problems/io/track_file.h). Without the column `landmark` the matches
// alone join them. Takes some 150 bytes of memory a key point that is matched. False with a
// message if a file cannot be read or written.
bool WriteTracks(const SequenceMatchingOptions& options, const ImageSequence& sequence,
                 const std::string& directory, const std::string& path, TracksSummary* summary,
                 std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_SEQUENCE_MATCHING_H_
