// A sequence of the EuRoC MAV data set, or one recorded in its layout.
//
//   mav0/cam0, mav0/cam1                       the stereo pair
//     sensor.yaml                              T_BS, intrinsics, distortion, resolution
//     data.csv                                 timestamp [ns], file name in data/
//   mav0/state_groundtruth_estimate0/data.csv  timestamp [ns], p (x, y, z), q (w, x, y, z), ...;
//                                              optional
//
// The body is that of T_BS and of the ground truth: the IMU. "Down" is -Z of the ground truth's
// world.
#ifndef RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_
#define RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_

#include <optional>
#include <string>

#include "rigel/problems/images/image_sequence.h"

namespace rigel {

struct EurocOptions {
  // How far the time stamps of a frame's two images may be apart, milliseconds; 0 or more. None: a
  // tenth of the frame interval (of cam0's, the median).
  std::optional<double> sync_tolerance_ms;

  bool IsValid(std::string* error) const;
};

// `root` is mav0 or the folder that holds it; the latter names the sequence. A frame is an image of
// cam0 and one of cam1, in time each other's nearest and within the tolerance; its time is that of
// cam0. Images without a partner are left out, and counted in the notes, which also have the
// largest difference of two partners' stamps and the cameras that are not used. Image files lie in
// the cameras' folders data: a name that leads out of it is refused. The ground truth is
// interpolated to the time of a frame; where it has a gap there (of more than 50 ms), the frame has
// none. False with a message that names the file, and the line where there is one.
bool ReadEurocSequence(const std::string& root, const EurocOptions& options,
                       ImageSequence* sequence, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_
