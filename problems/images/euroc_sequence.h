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

#include <string>

#include "rigel/problems/images/image_sequence.h"

namespace rigel {

// `root` is mav0 or the folder that holds it; the latter names the sequence. A frame is a time
// stamp that both cameras have; images without a partner are left out, and counted in the notes.
// The ground truth is interpolated to the time of a frame; where it has a gap there (of more than
// 50 ms), the frame has none. False with a message that names the file, and the line where there is
// one.
bool ReadEurocSequence(const std::string& root, ImageSequence* sequence, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_EUROC_SEQUENCE_H_
