// The images of any rig, by a rig file and patterns of paths.
#ifndef RIGEL_PROBLEMS_IMAGES_RIG_SEQUENCE_H_
#define RIGEL_PROBLEMS_IMAGES_RIG_SEQUENCE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rigel/core/rig.h"
#include "rigel/problems/images/image_sequence.h"

namespace rigel {

// Which images of the cameras are a frame.
enum class FrameOrder {
  kName,   // those of one {frame}
  kIndex,  // the first of each camera, the second of each, ...
  kTime    // those whose {frame} is about the same time (frame_stamps.h)
};

bool ParseFrameOrder(std::string_view name, FrameOrder* order);  // "name", "order", "time"

struct RigSequenceOptions {
  // image_pattern.h. {camera} is the name of the camera in the rig file; if no camera has images
  // by its name, its number. Empty: what the rig file names for each camera, relative to its
  // folder.
  std::string images;
  // As `images`, of images that are black where there shall be no features. {frame} may be absent.
  // Empty: none.
  std::string masks;
  // "overlap": those whose fields of view overlap (view_overlap.h). "all", "none", or pairs as in
  // "0-1,front-left".
  std::string camera_pairs = "overlap";
  std::string name;  // of the sequence; empty: the rig's, else that of its file
  FrameOrder order = FrameOrder::kName;
  // kTime: the largest difference, milliseconds. None: a tenth of the median frame interval.
  std::optional<double> sync_tolerance_ms;
  int64_t time_unit_ns = 1;  // kTime: what {frame} counts, 1 to 1e9 ns; it may have decimals

  bool IsValid(std::string* error) const;
};

// Frames are in the order of their names or times, and count from 0. Those of kTime have times, and
// the stamps are compared after the cameras' time offsets are subtracted. Frames may lack the image
// of a camera: the notes say how many of which camera. False with a message if a file cannot be
// read, or if a camera has no images at all.
bool ReadRigSequence(const std::string& rig_file, const RigSequenceOptions& options,
                     ImageSequence* sequence, std::string* error);

// What options.camera_pairs says of a rig whose cameras have these names, ascending, i < j. False
// with a message that begins with the flag.
bool ParseCameraPairs(const std::string& text, const Rig& rig,
                      const std::vector<std::string>& names,
                      std::vector<std::pair<int, int>>* pairs, std::string* error);

// `text` as the name of a sequence in a match file: other than printable ASCII becomes "_".
std::string SequenceName(std::string text);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_RIG_SEQUENCE_H_
