// Key points of images and their matches.
//
// No function here throws: an exception of OpenCV becomes a message.
#ifndef RIGEL_PROBLEMS_IMAGES_IMAGE_FEATURES_H_
#define RIGEL_PROBLEMS_IMAGES_IMAGE_FEATURES_H_

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "rigel/problems/images/image_sequence.h"

namespace rigel {

enum class FeatureType { kSift, kOrb };

const char* FeatureTypeName(FeatureType type);
bool ParseFeatureType(std::string_view name, FeatureType* type);  // "sift", "orb"

struct FeatureOptions {
  FeatureType type = FeatureType::kSift;
  int max_features = 2000;  // of an image, the strongest; 1 to 20000
  // A match's nearest descriptor is at most this share of the distance of the second nearest, seen
  // from either image; 1 keeps all.
  double ratio = 0.8;

  bool IsValid(std::string* error) const;
};

struct ImageFeatures {
  int width = 0, height = 0;
  // Those of ImageCamera::camera. The centre of the first pixel is (0, 0), as it is for the
  // principal point.
  std::vector<Pixel> pixels;
  cv::Mat descriptors;  // a row a pixel: 16-bit integers for SIFT, bits for ORB
};

// Reads an image as grey and finds its key points, none where the image of `mask` is black; that
// may be empty. A key point whose pixel has no ray is dropped. The same image gives the same
// features. False with a message if a file is not an image, or not of the camera's size where that
// is known.
bool ExtractFeatures(const FeatureOptions& options, const ImageCamera& camera,
                     const std::string& path, const std::string& mask, ImageFeatures* features,
                     std::string* error);

// Four decimals: what a pixel or a ratio is accurate to. They keep the files small.
double RoundedToFile(double value);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_IMAGE_FEATURES_H_
