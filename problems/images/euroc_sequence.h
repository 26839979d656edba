// A sequence of the EuRoC MAV data set, or one recorded in its layout.
//
//   mav0/cam0, mav0/cam1                       the stereo pair
//     sensor.yaml                              T_BS, intrinsics, distortion, resolution
//     data.csv                                 timestamp [ns], file name in data/
//   mav0/state_groundtruth_estimate0/data.csv  timestamp [ns], p (x, y, z), q (w, x, y, z), ...;
//                                              optional
//
// The lens may be any of problems/rigs/euroc_rig.h. The body is that of T_BS and of the ground
// truth: the IMU. "Down" is -Z of the ground truth's world.
#ifndef RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_
#define RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_

#include <optional>
#include <string>

#include "rigel/problems/images/image_sequence.h"

namespace rigel {

struct EurocOptions {
  // The largest difference of the time stamps of a frame's two images, milliseconds; 0 or more.
  // None: a tenth of the median frame interval of cam0.
  std::optional<double> sync_tolerance_ms;

  bool IsValid(std::string* error) const;
};

// `root` is mav0 or the folder that contains it, which names the sequence.
//   - A frame is an image of cam0 and an image of cam1 that are nearest to each other in time and
//     within the tolerance. Its time is that of cam0. Images without a partner are left out.
//   - The notes have the number of these, the largest difference of the stamps of partners, and the
//     cameras that are not used.
//   - Image files are in the folder data of a camera. A name that leads out of it is refused.
//   - The ground truth is interpolated to the time of a frame. In a gap of more than 50 ms a frame
//   has
//     no truth.
// False with a message that names the file, and the line if there is one.
bool ReadEurocSequence(const std::string& root, const EurocOptions& options,
                       ImageSequence* sequence, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_
