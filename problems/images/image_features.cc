#include "rigel/problems/images/image_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <tuple>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "rigel/core/enum_names.h"
#include "rigel/problems/io/exception_message.h"
#include "rigel/problems/io/input_file.h"
#include "rigel/problems/io/printable.h"

namespace rigel {
namespace {

constexpr EnumName<FeatureType> kFeatureNames[] = {{FeatureType::kSift, "sift"},
                                                   {FeatureType::kOrb, "orb"}};

// Of an image. The time of matching grows with their square.
constexpr int kMaxFeatures = 20000;
constexpr float kOrbScale = 1.2f;  // between two levels of the pyramid, as OpenCV has it

// Four digits say what a key point and a ratio are worth, and keep the files small.
double Rounded(double value) { return std::round(value * 1e4) / 1e4; }

// Told here, as libpng would write about it to stderr.
bool IsCutOffPng(std::string_view bytes) {
  constexpr std::string_view kBegin = "\x89PNG";
  constexpr std::string_view kEnd = "IEND\xae\x42\x60\x82";
  return bytes.substr(0, kBegin.size()) == kBegin && bytes.rfind(kEnd) == std::string_view::npos;
}

// The larger an image, the more its bytes can announce: told before anything is decoded. Pixels of
// an image and bytes of a file; both are far more than any camera's, and bound the memory.
constexpr int64_t kMaxPixels = 200000000;
constexpr size_t kMaxImageBytes = size_t{1} << 30;

// Width times height by the head of a PNG or a JPEG; 0 if there is none. Of other kinds OpenCV
// decodes at most 2^30 pixels.
int64_t AnnouncedPixels(std::string_view bytes) {
  const auto number = [&](size_t begin, size_t count) {
    int64_t value = 0;
    for (size_t k = begin; k < begin + count; ++k) {
      value = 256 * value + static_cast<unsigned char>(bytes[k]);
    }
    return value;
  };
  if (bytes.substr(0, 4) == "\x89PNG") {
    return bytes.size() < 24 ? 0 : number(16, 4) * number(20, 4);
  }
  if (bytes.substr(0, 2) != "\xff\xd8") return 0;
  // Segments: ff, kind, length with these two bytes; the frame's are c0 to cf but for three.
  for (size_t k = 2; k + 9 < bytes.size() && bytes[k] == '\xff';) {
    const auto kind = static_cast<int>(number(k + 1, 1));
    if (kind >= 0xc0 && kind <= 0xcf && kind != 0xc4 && kind != 0xc8 && kind != 0xcc) {
      return number(k + 5, 2) * number(k + 7, 2);
    }
    k += kind == 0xff ? 1 : 2 + static_cast<size_t>(number(k + 2, 2));
  }
  return 0;
}

bool ReadImage(const std::string& path, cv::Mat* image, std::string* error) {
  InputBytes input;
  if (!ReadBytes(path, &input, error, kMaxImageBytes)) return false;
  const std::string_view bytes = input.text();
  if (IsCutOffPng(bytes)) {
    *error = Printable(path) + ": the image is cut off";
    return false;
  }
  const auto too_large = [&](int64_t pixels) {
    *error = Printable(path) + ": " + std::to_string(pixels) + " pixels, expected at most " +
             std::to_string(kMaxPixels / 1000000) + " million";
    return false;
  };
  const int64_t announced = AnnouncedPixels(bytes);
  if (announced > kMaxPixels) return too_large(announced);
  if (!bytes.empty()) {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U,
                          const_cast<char*>(bytes.data()));  // it is only read
    *image = cv::imdecode(encoded, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  }
  if (static_cast<int64_t>(image->total()) > kMaxPixels) {
    return too_large(static_cast<int64_t>(image->total()));
  }
  if (!image->empty()) return true;
  *error = Printable(path) + ": not an image that can be decoded" +
           (bytes.empty() ? ": the file is empty" : "");
  return false;
}

// Where a key point really is. SIFT of OpenCV starts from the image at twice its size, whose pixel
// x lies at x/2 - 1/4; it reports x/2.
cv::Point2d SiftPixel(const cv::KeyPoint& point) {
  // Pixels: the quarter of the formula above.
  constexpr double kShift = 0.25;
  return {point.pt.x - kShift, point.pt.y - kShift};
}

// ORB reports the pixel of its level times the nominal scale; levels are of whole pixels, and their
// corners, not the centres of their first pixels, lie upon each other.
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
  // Of OpenCV's fixed-point iteration, which is slow where the lens distorts much; kMaxError
  // finds the points that need more.
  constexpr int kMaxIterations = 50;
  constexpr double kEpsilon = 1e-6;   // px, where it ends: far below the noise
  constexpr double kMaxError = 1e-2;  // px, of a point that was distorted again
  const PinholeCamera& c = camera.camera.intrinsics;
  const RadialTangential& d = *camera.distortion;
  const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  std::vector<cv::Point2d> normalized;
  cv::undistortPoints(
      *points, normalized, K, cv::Vec4d(d.k1, d.k2, d.p1, d.p2), cv::noArray(), cv::noArray(),
      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMaxIterations, kEpsilon));
  for (size_t k = 0; k < points->size(); ++k) {
    const Eigen::Vector2d u(normalized[k].x, normalized[k].y);
    const Eigen::Vector2d again = d.Distort(u);
    const cv::Point2d& seen = (*points)[k];
    const double error =
        std::hypot(c.fx * again.x() + c.cx - seen.x, c.fy * again.y() + c.cy - seen.y);
    (*valid)[k] = error <= kMaxError;
    (*points)[k] = {c.fx * u.x() + c.cx, c.fy * u.y() + c.cy};
  }
}

// Squared distances (SIFT) or numbers of bits (ORB) between the rows begin..end-1 of `a` and all
// rows of `b`, as a matrix of int. Whole numbers: the same on any machine.
void Distances(FeatureType type, const cv::Mat& a, int begin, int end, const cv::Mat& b,
               cv::Mat* distances) {
  if (type == FeatureType::kOrb) {
    cv::batchDistance(a.rowRange(begin, end), b, *distances, CV_32S, cv::noArray(),
                      cv::NORM_HAMMING);
    return;
  }
  distances->create(end - begin, b.rows, CV_32S);
  constexpr int kSize = 128;  // of a descriptor; known to the compiler it makes one loop of vectors
  for (int i = begin; i < end; ++i) {
    const int16_t* const x = a.ptr<int16_t>(i);
    int* const out = distances->ptr<int>(i - begin);
    for (int j = 0; j < b.rows; ++j) {
      const int16_t* const y = b.ptr<int16_t>(j);
      int sum = 0;
      for (int k = 0; k < kSize; ++k) {
        const auto difference = static_cast<int16_t>(x[k] - y[k]);
        sum += difference * difference;
      }
      out[j] = sum;
    }
  }
}

// The nearest of one descriptor and the distance of the second.
struct Nearest {
  int index = -1;
  int first = std::numeric_limits<int>::max();
  int second = std::numeric_limits<int>::max();

  void Add(int candidate, int distance) {
    if (distance < first) {
      second = first;
      first = distance;
      index = candidate;
    } else if (distance < second) {
      second = distance;
    }
  }

  // Of the first distance to the second; 1 if that cannot be told from one candidate.
  double Ratio(FeatureType type) const {
    if (second == std::numeric_limits<int>::max() || second == 0) return 1.0;
    const double ratio = static_cast<double>(first) / second;
    return type == FeatureType::kSift ? std::sqrt(ratio) : ratio;
  }
};

}  // namespace

const char* FeatureTypeName(FeatureType type) { return NameOf(kFeatureNames, type); }

bool ParseFeatureType(std::string_view name, FeatureType* type) {
  return FindValue(kFeatureNames, name, type);
}

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
  const PinholeCamera& c = camera.camera.intrinsics;
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
    result.pixels.emplace_back(Rounded(pixels[k].x), Rounded(pixels[k].y));
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

void AppendMatches(const FeatureOptions& options, int camera1, const ImageFeatures& features1,
                   int camera2, const ImageFeatures& features2, std::vector<Match>* matches) {
  const int rows = static_cast<int>(features1.pixels.size());
  const int columns = static_cast<int>(features2.pixels.size());
  if (rows == 0 || columns == 0) return;
  std::vector<Nearest> of_row(rows), of_column(columns);
  // Some rows at a time, so that the distances stay in the cache.
  constexpr int kBlock = 32;
  cv::Mat distances;
  for (int begin = 0; begin < rows; begin += kBlock) {
    const int end = std::min(begin + kBlock, rows);
    Distances(options.type, features1.descriptors, begin, end, features2.descriptors, &distances);
    for (int i = begin; i < end; ++i) {
      const int* const distance = distances.ptr<int>(i - begin);
      for (int j = 0; j < columns; ++j) {
        of_row[i].Add(j, distance[j]);
        of_column[j].Add(i, distance[j]);
      }
    }
  }

  std::vector<Match> found;
  for (int i = 0; i < rows; ++i) {
    const int j = of_row[i].index;
    if (of_column[j].index != i) continue;
    const double score = std::max(of_row[i].Ratio(options.type), of_column[j].Ratio(options.type));
    if (score <= options.ratio) {
      found.push_back({camera1, features1.pixels[i], camera2, features2.pixels[j], Rounded(score)});
    }
  }
  const auto key = [](const Match& m) {
    return std::make_tuple(m.pixel1.x(), m.pixel1.y(), m.pixel2.x(), m.pixel2.y());
  };
  std::sort(found.begin(), found.end(), [&](const Match& a, const Match& b) {
    return std::make_pair(key(a), a.score) < std::make_pair(key(b), b.score);
  });
  const auto end = std::unique(found.begin(), found.end(),
                               [&](const Match& a, const Match& b) { return key(a) == key(b); });
  matches->insert(matches->end(), found.begin(), end);
}

}  // namespace rigel
