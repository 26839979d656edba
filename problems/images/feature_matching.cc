#include "rigel/problems/images/feature_matching.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include <opencv2/core.hpp>

namespace rigel {
namespace {

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
      found.push_back(
          {camera1, features1.pixels[i], camera2, features2.pixels[j], RoundedToFile(score)});
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
