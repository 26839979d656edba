#include "rigel/refine/inlier_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace rigel {
namespace {

// Inliers that a place where there is no other is likely to have.
constexpr double kPriorInliers = 0.1;

// Counts of matches by the logarithm of their parallax, four bins to a factor of two.
class Histogram {
 public:
  static constexpr int kBins = 96;
  static constexpr int kReach = 4;
  static int Bin(double sin2_parallax) {
    // floor(4 log2(sine)) = floor(2 log2(sin^2)), sin^2 = m 2^e with m in [1, 2): from its bits,
    // which are in order.
    constexpr uint64_t kRoot2Bits = 0x6a09e667f3bcd;
    constexpr int kMantissa = 52, kBias = 1023;
    const double value = std::max(sin2_parallax, 1e-14);
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    const int exponent = static_cast<int>(bits >> kMantissa) - kBias;
    const bool upper_half = (bits & ((uint64_t{1} << kMantissa) - 1)) >= kRoot2Bits;
    return std::clamp(kBins - 2 + 2 * exponent + (upper_half ? 1 : 0), 1, kBins - 2);
  }
  void Add(int bin) {
    ++counts_[bin];
    ++total_;
  }
  // How many there are within a factor of 1.3 of the parallax of each bin, as the mean over a wider
  // neighbourhood tells: down to a half, as the parallax of inliers ends somewhere, and up to
  // `above` bins.
  std::array<double, kBins> Near(int above) const {
    std::array<double, kBins> near;
    for (int bin = 0; bin < kBins; ++bin) {
      const int first = std::max(bin - kReach, 0);
      const int last = std::min(bin + above, kBins - 1);
      int sum = 0;
      for (int k = first; k <= last; ++k) sum += counts_[k];
      near[bin] = 3.0 * sum / (last - first + 1);
    }
    return near;
  }
  int Total() const { return total_; }
  // sin^2 of the 90th percentile.
  double HighSin2() const {
    int bin = kBins - 1;
    for (int above = counts_[bin]; bin > 0 && above < 0.1 * total_;) above += counts_[--bin];
    return std::exp2(2.0 * (bin - (kBins - 2) + 1) / 4.0);
  }

 private:
  std::array<int, kBins> counts_{};
  int total_ = 0;
};

}  // namespace

int SelectPlausibleInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                           std::vector<double>* squared_errors, std::vector<char>* inliers) {
  // With an inter-camera baseline the parallax is of another size.
  enum { kIntra, kInter };
  Histogram within[2], beyond[2];
  const int n = matches.size();
  squared_errors->resize(n);
  inliers->resize(n);
  std::vector<char> bins(n);
  std::vector<double> sin2(n);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = pose.R;
  const double gate2 = gate_px * gate_px;
  int count = 0, num_beyond = 0;
  for (const MatchGroup& group : matches.groups()) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = matches.Fundamental(group, pose);
    const RayArrays rays = matches.Directions(group);
    const int kind = group.camera1 == group.camera2 ? kIntra : kInter;
    double* errors = squared_errors->data() + group.begin;
    char* selected = inliers->data() + group.begin;
    SelectInFront(matches.Pixels(group), rays, F.data(), matches.MotionOf(group, pose, gate_px),
                  kBandEnd * kBandEnd * gate2, errors, selected);
    SquaredParallax(rays, R.data(), group.size, sin2.data() + group.begin);
    for (int k = 0; k < group.size; ++k) {
      if (!selected[k]) continue;
      const int bin = Histogram::Bin(sin2[group.begin + k]);
      bins[group.begin + k] = static_cast<char>(bin);
      const bool fits = errors[k] < gate2;
      const bool outlier = errors[k] >= kBandBegin * kBandBegin * gate2;
      if (fits) within[kind].Add(bin);
      if (outlier) beyond[kind].Add(bin);
      selected[k] = fits;
      count += fits;
      num_beyond += outlier;
    }
  }
  if (num_beyond == 0) return count;
  double high2[2] = {};
  std::array<double, Histogram::kBins> within_near[2], beyond_near[2];
  for (const int kind : {kIntra, kInter}) {
    if (within[kind].Total() == 0) continue;
    high2[kind] = within[kind].HighSin2();
    within_near[kind] = within[kind].Near(1);
    beyond_near[kind] = beyond[kind].Near(Histogram::kReach);
  }
  for (const MatchGroup& group : matches.groups()) {
    const int kind = group.camera1 == group.camera2 ? kIntra : kInter;
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (!(*inliers)[k]) continue;
      const double outliers = beyond_near[kind][bins[k]] / (kBandEnd - kBandBegin);
      const double others = within_near[kind][bins[k]] - 0.5 + kPriorInliers;
      const double limit =
          std::clamp(kMaxOutlierProbability * high2[kind] / std::max(sin2[k], 1e-300),
                     kMinOutlierProbability, kMaxOutlierProbability);
      if (outliers <= limit * (outliers + others)) continue;
      (*inliers)[k] = 0;
      --count;
    }
  }
  return count;
}

}  // namespace rigel
