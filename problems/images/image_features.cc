#include "rigel/problems/images/image_features.h"

#include <cmath>
#include <cstdint>

#include <opencv2/calib3d.hpp>
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
cv::Point2d SiftPixel(const cv::KeyPoint& point) {
  // Pixels: the quarter of the formula above.
  constexpr double kShift = 0.25;
  return {point.pt.x - kShift, point.pt.y - kShift};
}

// ORB reports the pixel of its level times the nominal scale. But levels have whole numbers of
// pixels, and it is their corners that coincide, not the centres of their first pixels.
cv::Point2d OrbPixel(const cv::KeyPoint& point, const cv::Size& size) {
  const float scale = std::pow(kOrbScale, static_cast<float>(point.octave));
  const auto whole = [&](float x, int length) {
    const double of_level = std::round(x / scale);
    const double exact = static_cast<double>(length) / cvRound(length / scale);
    return (of_level + 0.5) * exact - 0.5;
  };
  return {whole(point.pt.x, size.width), whole(point.pt.y, size.height)};
}

// Pixels of the undistorted camera; empty `distortion` changes nothing. *valid[k] is false where
// the distortion cannot be inverted: far outside of the lens's model.
void Undistort(const ImageCamera& camera, std::vector<cv::Point2d>* points,
               std::vector<bool>* valid) {
  valid->assign(points->size(), true);
  if (!camera.distortion || points->empty()) return;
  // Iterations of OpenCV's fixed-point method, which converges slowly where distortion is strong.
  // kMaxError finds the points that need more.
  constexpr int kMaxIterations = 50;
  constexpr double kEpsilon = 1e-6;   // px, where it ends: far below the noise
  constexpr double kMaxError = 1e-2;  // px, of a point that was distorted again
  const Camera& c = camera.camera.intrinsics;
  const RadialTangential& d = *camera.distortion;
  const cv::Matx33d K(c.fx(), 0, c.cx(), 0, c.fy(), c.cy(), 0, 0, 1);
  std::vector<cv::Point2d> normalized;
  cv::undistortPoints(
      *points, normalized, K, cv::Vec4d(d.k1, d.k2, d.p1, d.p2), cv::noArray(), cv::noArray(),
      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMaxIterations, kEpsilon));
  for (size_t k = 0; k < points->size(); ++k) {
    const Eigen::Vector2d u(normalized[k].x, normalized[k].y);
    const Eigen::Vector2d again = d.Distort(u);
    const cv::Point2d& seen = (*points)[k];
    const double error =
        std::hypot(c.fx() * again.x() + c.cx() - seen.x, c.fy() * again.y() + c.cy() - seen.y);
    (*valid)[k] = error <= kMaxError;
    (*points)[k] = {c.fx() * u.x() + c.cx(), c.fy() * u.y() + c.cy()};
  }
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
                     const std::string& path, ImageFeatures* features, std::string* error) try {
  cv::Mat image;
  if (!ReadImage(path, &image, error)) return false;
  const Camera& c = camera.camera.intrinsics;
  if (c.width > 0 && image.size() != cv::Size(c.width, c.height)) {
    *error = Printable(path) + ": " + std::to_string(image.cols) + " x " +
             std::to_string(image.rows) + " pixels, expected " + std::to_string(c.width) + " x " +
             std::to_string(c.height) + " as the calibration says";
    return false;
  }
  const bool sift = options.type == FeatureType::kSift;
  cv::Ptr<cv::Feature2D> extractor;
  if (sift) {
    extractor = cv::SIFT::create(options.max_features);
  } else {
    extractor = cv::ORB::create(options.max_features, kOrbScale);
  }
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
  extractor->detectAndCompute(image, cv::noArray(), points, descriptors);

  std::vector<cv::Point2d> pixels;
  pixels.reserve(points.size());
  for (const cv::KeyPoint& point : points) {
    pixels.push_back(sift ? SiftPixel(point) : OrbPixel(point, image.size()));
  }
  std::vector<bool> valid;
  Undistort(camera, &pixels, &valid);

  ImageFeatures result;
  result.width = image.cols;
  result.height = image.rows;
  for (size_t k = 0; k < pixels.size(); ++k) {
    if (!valid[k]) continue;
    result.pixels.emplace_back(RoundedToFile(pixels[k].x), RoundedToFile(pixels[k].y));
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
