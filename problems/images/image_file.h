// Images of files, decoded by OpenCV.
#ifndef RIGEL_PROBLEMS_IMAGES_IMAGE_FILE_H_
#define RIGEL_PROBLEMS_IMAGES_IMAGE_FILE_H_

#include <string>

#include <opencv2/core/mat.hpp>

namespace rigel {

// Reads an image as grey. False with a message if the file cannot be read, is no image, is cut off,
// or is larger than 1 GiB or 200 million pixels: that is told before it is decoded. OpenCV may
// throw.
bool ReadImage(const std::string& path, cv::Mat* image, std::string* error);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_IMAGE_FILE_H_
