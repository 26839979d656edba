#include "rigel/problems/images/image_features.h"

#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "rigel/core/enum_names.h"
#include "rigel/problems/images/image_file.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

constexpr EnumName<FeatureType> kFeatureNames[] = {{FeatureType::kSift, "sift"},
                                                   {FeatureType::kOrb, "orb"}};

// Of an image. The time of matching grows with their square.
constexpr int kMaxFeatures = 20000;
constexpr float kOrbScale = 1.2f;  // between two levels of the pyramid, as OpenCV has it

// The true position of a key point. OpenCV's SIFT starts with the image at twice its size, whose
// pixel x lies at x/2 - 1/4, but reports x/2.
Pixel SiftPixel(const cv::KeyPoint& point) {
  // Pixels: the quarter of the formula above.
  constexpr double kShift = 0.25;
  return {point.pt.x - kShift, point.pt.y - kShift};
}

// ORB reports the pixel of its level times the nominal scale. But levels have whole numbers of
// pixels, and it is their corners that coincide, not the centres of their first pixels.
Pixel OrbPixel(const cv::KeyPoint& point, const cv::Size& size) {
  const float scale = std::pow(kOrbScale, static_cast<float>(point.octave));
  const auto whole = [&](float x, int length) {
    const double of_level = std::round(x / scale);
    const double exact = static_cast<double>(length) / cvRound(length / scale);
    return (of_level + 0.5) * exact - 0.5;
  };
  return {whole(point.pt.x, size.width), whole(point.pt.y, size.height)};
}

// Moves a pixel of the lens to that of the pinhole `camera` that sees the same ray. False where the
// lens has no ray, or the pinhole no pixel of it.
bool Undistort(const Camera& lens, const Camera& camera, Pixel* pixel) {
  Eigen::Vector3d ray;
  return Unproject(lens, *pixel, &ray) && Project(camera, ray, pixel);
}

// The pixel as match files have it. False where the camera has no ray.
bool ToFilePixel(const ImageCamera& camera, Pixel* pixel) {
  if (camera.lens && !Undistort(*camera.lens, camera.camera.intrinsics, pixel)) return false;
  *pixel = {RoundedToFile(pixel->x()), RoundedToFile(pixel->y())};
  Eigen::Vector3d ignored;
  return Unproject(camera.camera.intrinsics, *pixel, &ignored);
}

// Where the mask is not black, as OpenCV's masks are. False with a message if it is no image of
// this size.
bool ReadMask(const std::string& path, const cv::Size& size, cv::Mat* mask, std::string* error) {
  if (!ReadImage(path, mask, error)) return false;
  if (mask->size() == size) return true;
  *error = Printable(path) + ": a mask of " + std::to_string(mask->cols) + " x " +
           std::to_string(mask->rows) + " pixels, expected " + std::to_string(size.width) + " x " +
           std::to_string(size.height) + " as the image has";
  return false;
}

// The strongest key points that the mask (empty: none) leaves, at most options.max_features, with
// their descriptors. OpenCV's SIFT counts before it masks, so that it is given no limit.
void Detect(const FeatureOptions& options, const cv::Mat& image, const cv::Mat& mask,
            std::vector<cv::KeyPoint>* points, cv::Mat* descriptors) {
  if (options.type == FeatureType::kOrb) {
    cv::ORB::create(options.max_features, kOrbScale)
        ->detectAndCompute(image, mask, *points, *descriptors);
    return;
  }
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(mask.empty() ? options.max_features : 0);
  if (mask.empty()) {
    sift->detectAndCompute(image, mask, *points, *descriptors);
    return;
  }
  sift->detect(image, *points, mask);
  cv::KeyPointsFilter::retainBest(*points, options.max_features);
  sift->compute(image, *points, *descriptors);
}

}  // namespace

const char* FeatureTypeName(FeatureType type) { return NameOf(kFeatureNames, type); }

bool ParseFeatureType(std::string_view name, FeatureType* type) {
  return FindValue(kFeatureNames, name, type);
}

double RoundedToFile(double value) { return std::round(value * 1e4) / 1e4; }

bool FeatureOptions::IsValid(std::string* error) const {
  if (max_features < 1 || max_features > kMaxFeatures) {
    *error = "max_features: expected 1 to " + std::to_string(kMaxFeatures);
    return false;
  }
  if (!(ratio > 0 && ratio <= 1)) {
    *error = "ratio: expected above 0, at most 1";
    return false;
  }
  return true;
}

bool ExtractFeatures(const FeatureOptions& options, const ImageCamera& camera,
                     const std::string& path, const std::string& mask_path, ImageFeatures* features,
                     std::string* error) try {
  cv::Mat image;
  if (!ReadImage(path, &image, error)) return false;
  const Camera& c = camera.camera.intrinsics;
  if (c.width > 0 && image.size() != cv::Size(c.width, c.height)) {
    *error = Printable(path) + ": " + std::to_string(image.cols) + " x " +
             std::to_string(image.rows) + " pixels, expected " + std::to_string(c.width) + " x " +
             std::to_string(c.height) + " as the calibration says";
    return false;
  }
  cv::Mat mask;
  if (!mask_path.empty() && !ReadMask(mask_path, image.size(), &mask, error)) return false;
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  Detect(options, image, mask, &points, &descriptors);

  ImageFeatures result;
  result.width = image.cols;
  result.height = image.rows;
  const bool sift = options.type == FeatureType::kSift;
  for (size_t k = 0; k < points.size(); ++k) {
    Pixel pixel = sift ? SiftPixel(points[k]) : OrbPixel(points[k], image.size());
    if (!ToFilePixel(camera, &pixel)) continue;
    result.pixels.push_back(pixel);
    result.descriptors.push_back(descriptors.row(static_cast<int>(k)));
  }
  // SIFT's numbers are integers from 0 to 255 in float.
  if (sift) result.descriptors.convertTo(result.descriptors, CV_16S);
  *features = std::move(result);
  return true;
} catch (const std::exception& exception) {
  *error = Printable(path) + ": " + ExceptionMessage(exception);
  return false;
}

}  // namespace rigel
