// Pairs the images of two cameras by their time stamps.
#ifndef RIGEL_PROBLEMS_IMAGES_STEREO_STAMPS_H_
#define RIGEL_PROBLEMS_IMAGES_STEREO_STAMPS_H_

#include <cstdint>
#include <utility>
#include <vector>

namespace rigel {

// Time stamps in nanoseconds, from 0, ascending, each once.
using Stamps = std::vector<int64_t>;

// A tenth of the median interval; 0 of less than two stamps.
int64_t DefaultSyncTolerance(const Stamps& stamps);

// Indices of stamps that are nearest to each other and differ by at most `tolerance`; of two that
// are equally near the earlier one. In order; each stamp at most once.
std::vector<std::pair<int, int>> PairStamps(const Stamps& stamps1, const Stamps& stamps2,
                                            int64_t tolerance);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_STEREO_STAMPS_H_
