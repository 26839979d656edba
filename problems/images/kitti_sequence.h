// A sequence of the KITTI odometry benchmark.
//
//   ROOT/sequences/NAME/calib.txt         P0: ... P3: ..., 12 numbers each, 3x4 projections
//   ROOT/sequences/NAME/image_0, image_1  000000.png, ...; the grey stereo pair
//   ROOT/sequences/NAME/image_2, image_3  the colour pair, taken where there is no grey one
//   ROOT/sequences/NAME/times.txt         a time a frame, seconds; optional
//   ROOT/poses/NAME.txt                   ground truth, see problems/io/kitti_poses.h; optional
//
// The body is the left grey camera (camera 0 of KITTI), the one whose poses the ground truth gives;
// the colour cameras are placed relative to it. "Down" is the Y axis of the first camera frame,
// level to a degree or two.
#ifndef RIGEL_PROBLEMS_IMAGES_KITTI_SEQUENCE_H_
#define RIGEL_PROBLEMS_IMAGES_KITTI_SEQUENCE_H_

#include <string>

#include "rigel/problems/images/image_sequence.h"

namespace rigel {

// Line k of times.txt and of the poses belongs to frame k: blank lines and comments between them
// are refused. Cameras that are not used are listed in the notes.
//
// The numbers of frames are those of the images, at most 10 million. A frame exists if a camera has
// an image of it. False with a message that names the file, and the line if there is one.
bool ReadKittiSequence(const std::string& root, const std::string& name, ImageSequence* sequence,
                       std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_KITTI_SEQUENCE_H_
