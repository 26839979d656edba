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
  // The 90th percentile.
  double High() const {
    int bin = kBins - 1;
    for (int above = counts_[bin]; bin > 0 && above < 0.1 * total_;) above += counts_[--bin];
    return std::exp2(0.5 * (bin - (kBins - 2) + 1));
  }

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

// Intra-camera and inter-camera matches are judged apart, since their parallax differs in size.
enum Kind { kIntra, kInter };

// Matches in front of the cameras, by their error.
struct Placed {
  std::vector<int> in_gate, in_band;
};

// Clears `selected` for likely outliers by parallax. `sin2` is the squared sine of the parallax.
void JudgeByParallax(const Placed& placed, const std::vector<double>& sin2,
                     std::vector<char>* selected) {
  // Expected number of inliers near a parallax at which there is no other.
  constexpr double kPrior = 0.1;
  constexpr int kReach = 4;
  if (placed.in_gate.empty() || placed.in_band.empty()) return;
  Histogram in_gate, in_band;
  for (const int k : placed.in_gate) in_gate.Add(Histogram::Bin(sin2[k]));
  for (const int k : placed.in_band) in_band.Add(Histogram::Bin(sin2[k]));
  const double high2 = in_gate.High();
  // Only one bin above: inliers of larger parallax are few.
  const Numbers inliers = OtherInliers(in_gate, kReach, 1, kPrior);
  const Numbers band = in_band.Near(kReach, kReach);
  for (const int k : placed.in_gate) {
    const int bin = Histogram::Bin(sin2[k]);
    const double outliers = band[bin] / (kBandEnd - kBandBegin);
    const double limit = std::clamp(kMaxOutlierProbability * high2 / std::max(sin2[k], 1e-300),
                                    kMinOutlierProbability, kMaxOutlierProbability);
    if (outliers > limit * (outliers + inliers[bin])) (*selected)[k] = 0;
  }
}

// Clears `selected` for likely outliers by leverage.
void JudgeByLeverage(const GroupedMatches& matches, const Pose& pose, double gate_px,
                     const InlierFit& fit, const std::vector<double>& squared_errors,
                     const Placed (&placed)[2], int num_outliers, std::vector<char>* selected) {
  constexpr double kPrior = 0.02;
  constexpr int kInlierReach = 4;
  constexpr int kReach = 8;
  // A smaller leverage does no harm. With few matches all leverages are large and none stands out.
  // The mean leverage is parameters over inliers, and twice the mean counts as high (Hoaglin and
  // Welsch 1978). Matches with at least an eighth of that limit enter the counts.
  constexpr double kHarmless = 0.1;
  constexpr double kMeans = 2.0;
  const int num_members = static_cast<int>(std::count(fit.members.begin(), fit.members.end(), 1));
  const double min_leverage = std::max(kHarmless, kMeans * 6.0 / std::max(num_members, 1));
  constexpr double kMaxLeverage = 0.9999;
  // Share of all outliers that is expected in the band.
  constexpr double kShareInBand = 0.1;
  // Scales h / (1 - h) to the range of the histogram, which ends at 1.
  constexpr double kMaxFactor = 1024.0;
  // Errors of real matches have longer tails than normal ones: from this squared deviation on the
  // density falls as 1 / deviations^2.
  constexpr double kTail2 = 9.0;
  const double variance = fit.noise_px * fit.noise_px;
  std::vector<double> leverages(matches.size());
  const Matrix6d of_unit_noise = fit.covariance / variance;
  for (const MatchGroup& group : matches.groups()) {
    Leverages(matches, group, pose, fit.weights.data() + group.begin, of_unit_noise,
              leverages.data() + group.begin);
  }
  const auto leverage_of = [&](int k) {
    const double h = leverages[k];
    return std::min(fit.members[k] ? h : h / (1.0 + h), kMaxLeverage);
  };
  std::vector<int> judged;
  Histogram in_gate, in_band;
  // Bins of h / (1 - h), the variance of the prediction by the other matches.
  const auto bin_of = [](double h) { return Histogram::Bin(h / (1.0 - h) / kMaxFactor); };
  for (const Placed& matches_of_kind : placed) {
    for (const int k : matches_of_kind.in_gate) {
      const double h = leverage_of(k);
      if (h < min_leverage / 8.0) continue;
      in_gate.Add(bin_of(h));
      if (h >= min_leverage) judged.push_back(k);
    }
  }
  if (judged.empty()) return;
  for (const Placed& matches_of_kind : placed) {
    for (const int k : matches_of_kind.in_band) in_band.Add(bin_of(leverage_of(k)));
  }
  const Numbers inliers = OtherInliers(in_gate, kInlierReach, kInlierReach, kPrior);
  const Numbers band = in_band.Near(kReach, kReach);
  const double prior = kShareInBand * num_outliers * 3.0 / (2 * kReach + 1);
  for (const int k : judged) {
    const double h = leverage_of(k);
    // Squared residual over variance. The error of the prediction by the other matches is
    // r / (1 - h) for the residual r of least squares. Its variance is sigma^2 / (1 - h).
    const double s = fit.weights[k] * fit.weights[k] * squared_errors[k] / variance;
    const double deviations2 = fit.members[k] && fit.is_minimum ? s / (1.0 - h) : s * (1.0 - h);
    // Densities of the deviation: outliers are uniform in pixels on both sides, inliers normal.
    const int bin = bin_of(h);
    const double per_px = (band[bin] + prior) / (2.0 * (kBandEnd - kBandBegin) * gate_px);
    const double as_outlier = per_px * fit.noise_px / (fit.weights[k] * std::sqrt(1.0 - h));
    constexpr double kInvSqrt2Pi = 0.3989422804014327;
    const double normal = kInvSqrt2Pi * std::exp(-0.5 * std::min(deviations2, kTail2));
    const double as_inlier = inliers[bin] * normal * std::min(1.0, kTail2 / deviations2);
    if (as_outlier > as_inlier) (*selected)[k] = 0;
  }
}

}  // namespace

int SelectPlausibleInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                           const InlierFitFunction& fit, std::vector<double>* squared_errors,
                           std::vector<char>* inliers) {
  const int n = matches.size();
  const double gate2 = gate_px * gate_px;
  constexpr double kBegin2 = kBandBegin * kBandBegin;
  squared_errors->resize(n);
  inliers->resize(n);
  Placed placed[2];
  for (Placed& kind : placed) {
    // One entry more, so that the loop below can write each match and overwrite those not kept.
    kind.in_gate.resize(n + 1);
    kind.in_band.resize(n + 1);
  }
  int in_gate[2] = {}, in_band[2] = {}, num_outliers = 0;
  for (const MatchGroup& group : matches.groups()) {
    const Kind kind = group.camera1 == group.camera2 ? kIntra : kInter;
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = matches.Fundamental(group, pose);
    double* errors = squared_errors->data() + group.begin;
    char* selected = inliers->data() + group.begin;
    SelectInFront(matches.Pixels(group), matches.Directions(group), F.data(),
                  matches.MotionOf(group, pose, gate_px), kBandEnd * kBandEnd * gate2, errors,
                  selected);
    for (int k = 0; k < group.size; ++k) {
      const int fits = (selected[k] != 0) & (errors[k] < gate2);
      const int outlier = (selected[k] == 0) | (errors[k] >= kBegin2 * gate2);
      placed[kind].in_gate[in_gate[kind]] = group.begin + k;
      in_gate[kind] += fits;
      placed[kind].in_band[in_band[kind]] = group.begin + k;
      in_band[kind] += outlier & selected[k];
      num_outliers += outlier;
      selected[k] = static_cast<char>(fits);
    }
  }
  if (num_outliers == 0) return in_gate[kIntra] + in_gate[kInter];
  std::vector<double> sin2(n);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = pose.R;
  for (const MatchGroup& group : matches.groups()) {
    SquaredParallax(matches.Directions(group), R.data(), group.size, sin2.data() + group.begin);
  }
  for (const Kind kind : {kIntra, kInter}) {
    placed[kind].in_gate.resize(in_gate[kind]);
    placed[kind].in_band.resize(in_band[kind]);
    JudgeByParallax(placed[kind], sin2, inliers);
  }
  InlierFit at_pose;
  if (fit != nullptr && fit(&at_pose)) {
    JudgeByLeverage(matches, pose, gate_px, at_pose, *squared_errors, placed, num_outliers,
                    inliers);
  }
  return static_cast<int>(std::count(inliers->begin(), inliers->end(), 1));
}

}  // namespace rigel
