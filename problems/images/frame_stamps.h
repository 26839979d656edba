// Frames of the images of several cameras by their time stamps.
#ifndef RIGEL_PROBLEMS_IMAGES_FRAME_STAMPS_H_
#define RIGEL_PROBLEMS_IMAGES_FRAME_STAMPS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rigel {

// Time stamps in nanoseconds, ascending, each once.
using Stamps = std::vector<int64_t>;

// A tenth of the median interval; 0 of less than two stamps.
int64_t DefaultSyncTolerance(const Stamps& stamps);

// Indices of stamps that are nearest to each other and differ by at most `tolerance`; of two that
// are equally near the earlier one. In order; each stamp at most once.
std::vector<std::pair<int, int>> PairStamps(const Stamps& stamps1, const Stamps& stamps2,
                                            int64_t tolerance);

struct StampFrame {
  int64_t time = 0;         // of its first image in the order of the cameras
  std::vector<int> images;  // the index of each camera's stamp; -1 where it has none
};

struct StampFrames {
  std::vector<StampFrame> frames;  // in the order of their times
  int64_t largest = 0;             // difference of a stamp to the time of its frame
  std::string within;              // the tolerance in words
  std::string setting;             // and as a line of the settings; empty if `largest` is 0
};

// Images of one frame are paired, by PairStamps(), with the frames of the cameras before theirs.
// One without a partner is a frame of its own. The tolerance is in milliseconds, from 0; by default
// it is that of the first camera's stamps.
StampFrames GroupStamps(const std::vector<Stamps>& cameras, std::optional<double> tolerance_ms);

// Of a tolerance: it is not given, or finite and not negative. False with a message that begins
// with the name of the flag.
bool IsSyncTolerance(std::optional<double> tolerance_ms, std::string* error);

// "0.25 ms".
std::string Milliseconds(int64_t nanoseconds);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_FRAME_STAMPS_H_
