#include "rigel/refine/search/inlier_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {
namespace {

// Histogram of a number of at most 1 by its logarithm, two bins for each factor of two.
class Histogram {
 public:
  static constexpr int kBins = 96;
  static int Bin(double value) {
    // floor(2 log2(value)) for value = m 2^e with m in [1, 2), from the bits of the number.
    constexpr uint64_t kRoot2Bits = 0x6a09e667f3bcd;
    constexpr int kMantissa = 52, kBias = 1023;
    const double positive = std::max(value, 1e-14);
    uint64_t bits;
    std::memcpy(&bits, &positive, sizeof bits);
    const int exponent = static_cast<int>(bits >> kMantissa) - kBias;
    const bool upper_half = (bits & ((uint64_t{1} << kMantissa) - 1)) >= kRoot2Bits;
    return std::clamp(kBins - 2 + 2 * exponent + (upper_half ? 1 : 0), 1, kBins - 2);
  }
  void Add(int bin) {
    ++counts_[bin];
    ++total_;
  }
  // For each bin the expected number in three bins around it: three times the mean of the bins from
  // `below` under it to `above` over it.
  std::array<double, kBins> Near(int below, int above) const {
    std::array<double, kBins> near;
    for (int bin = 0; bin < kBins; ++bin) {
      const int first = std::max(bin - below, 0);
      const int last = std::min(bin + above, kBins - 1);
      int sum = 0;
      for (int k = first; k <= last; ++k) sum += counts_[k];
      near[bin] = 3.0 * sum / (last - first + 1);
    }
    return near;
  }
  int Total() const { return total_; }

 private:
  std::array<int, kBins> counts_{};
  int total_ = 0;
};

using Numbers = std::array<double, Histogram::kBins>;

// For each bin the number of other inliers near an inlier of the bin, plus `prior`.
Numbers OtherInliers(const Histogram& in_gate, int below, int above, double prior) {
  Numbers near = in_gate.Near(below, above);
  const double itself = 3.0 / (below + above + 1);
  for (double& n : near) n += prior - itself;
  return near;
}

// One match whose leverage counts.
struct Judged {
  int match;
  int group;
  double leverage;
};

// Bins of h / (1 - h), the variance of the prediction by the other matches, scaled to the range of
// the histogram, which ends at 1.
int BinOf(double h) {
  constexpr double kMaxFactor = 1024.0;
  return Histogram::Bin(h / (1.0 - h) / kMaxFactor);
}

// Leverages of all matches. Of a match that was not fitted: what it would have if it were.
std::vector<double> LeveragesOf(const GroupedMatches& matches, const Pose& pose,
                                const InlierFit& fit) {
  constexpr double kMaxLeverage = 0.9999;
  std::vector<double> leverages(matches.size());
  for (const MatchGroup& group : matches.groups()) {
    Leverages(matches, group, pose, fit.weights.data() + group.begin, fit.covariance,
              leverages.data() + group.begin);
  }
  for (size_t k = 0; k < leverages.size(); ++k) {
    const double h = leverages[k];
    leverages[k] = std::min(fit.members[k] ? h : h / (1.0 + h), kMaxLeverage);
  }
  return leverages;
}

}  // namespace

int SelectWithinGate(const GroupedMatches& matches, const MatchErrors& errors,
                     const NoiseModel& noise, std::vector<char>* inliers) {
  inliers->resize(matches.size());
  int count = 0;
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    const double gate2 = noise.gate_of[g] * noise.gate_of[g];
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      (*inliers)[k] = static_cast<char>((errors.in_front[k] != 0) & (errors.squared[k] < gate2));
      count += (*inliers)[k];
    }
  }
  return count;
}

int ExcludeImplausible(const GroupedMatches& matches, const Pose& pose, const MatchErrors& errors,
                       const NoiseModel& noise, const InlierFit& fit, std::vector<char>* inliers) {
  constexpr double kPrior = 0.02;
  constexpr int kInlierReach = 4;
  constexpr int kReach = 8;
  // Matches with at least this part of the mean leverage enter the counts.
  constexpr double kCounted = 0.25;
  // Share of all outliers that is expected in the band.
  constexpr double kShareInBand = 0.1;
  // Errors of real matches have longer tails than normal ones: from this squared deviation on the
  // density falls as 1 / deviations^2.
  constexpr double kTail2 = 9.0;
  // Twice the mean leverage counts as high (Hoaglin and Welsch 1978).
  constexpr double kMeans = 2.0;
  constexpr int kParameters = 6;
  const int num_inliers = static_cast<int>(std::count(inliers->begin(), inliers->end(), 1));
  const int num_outliers = matches.size() - num_inliers;
  if (num_outliers == 0) return num_inliers;
  const int num_members = static_cast<int>(std::count(fit.members.begin(), fit.members.end(), 1));
  const double mean_leverage = kParameters / static_cast<double>(std::max(num_members, 1));
  const std::vector<double> leverages = LeveragesOf(matches, pose, fit);
  std::vector<Judged> judged;
  Histogram in_gate, in_band;
  for (size_t g = 0; g < matches.groups().size(); ++g) {
    const MatchGroup& group = matches.groups()[g];
    const double begin = kBandBegin * noise.gate_of[g];
    const double end = kBandEnd * noise.gate_of[g];
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      const double h = leverages[k];
      const double e2 = errors.squared[k];
      if ((*inliers)[k]) {
        if (h < kCounted * mean_leverage) continue;
        in_gate.Add(BinOf(h));
        if (h >= kMeans * mean_leverage) judged.push_back({k, static_cast<int>(g), h});
      } else if (errors.in_front[k] && e2 >= begin * begin && e2 < end * end) {
        in_band.Add(BinOf(h));
      }
    }
  }
  const Numbers near_inliers = OtherInliers(in_gate, kInlierReach, kInlierReach, kPrior);
  const Numbers band = in_band.Near(kReach, kReach);
  const double prior = kShareInBand * num_outliers * 3.0 / (2 * kReach + 1);
  constexpr double kOdds = kMaxOutlierProbability / (1.0 - kMaxOutlierProbability);
  int left = num_inliers;
  for (const auto& [k, g, h] : judged) {
    // Squared residual over variance. The error of the prediction by the other matches is
    // r / (1 - h) for the residual r of least squares. Its variance is sigma^2 / (1 - h).
    const double s = fit.weights[k] * fit.weights[k] * errors.squared[k];
    const double deviations2 = fit.members[k] ? s / (1.0 - h) : s * (1.0 - h);
    // Densities of the deviation: outliers are uniform in pixels on both sides, inliers normal.
    const int bin = BinOf(h);
    const double per_px = (band[bin] + prior) / (2.0 * (kBandEnd - kBandBegin) * noise.gate_of[g]);
    const double as_outlier = per_px / (fit.weights[k] * std::sqrt(1.0 - h));
    constexpr double kInvSqrt2Pi = 0.3989422804014327;
    const double normal = kInvSqrt2Pi * std::exp(-0.5 * std::min(deviations2, kTail2));
    const double as_inlier = near_inliers[bin] * normal * std::min(1.0, kTail2 / deviations2);
    if (as_outlier > kOdds * as_inlier) {
      (*inliers)[k] = 0;
      --left;
    }
  }
  return left;
}

}  // namespace rigel
