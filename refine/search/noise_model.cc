#include "rigel/refine/search/noise_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace rigel {
namespace {

// The gate grows at most by this factor from one estimate to the next, ...
constexpr double kMaxGrowth = 2.0;
// ... and in all: residuals that still fill it are those of a wrong motion, or of outliers.
constexpr double kMaxGate = 12.0;  // thresholds
constexpr int kMaxEstimates = 12;
// From a motion nearby: the refinement goes on with the next.
constexpr int kMaxUpdates = 2;
// The gate stands if it changes by less than this fraction.
constexpr double kStands = 0.01;
// Variance of the logarithm of an estimated noise, times the number of errors: 0.7 by the sampling
// alone, twice as much as part of a fit. Weights that follow the errors by chance cost more than
// equal ones [test/mechanisms.py].
constexpr double kLogVariance = 1.4;
// With fewer errors a camera pair has the noise of all.
constexpr int kMinOwn = 20;
// Variance of the logarithms of the noise of different camera pairs that is expected at least: they
// differ by a seventh.
constexpr double kMinSpread = 0.02;
// Largest logarithm of the ratio of the noise of a camera pair to that of all: a factor of four.
// The matches of a camera that is swapped with another fit with a noise of tens of pixels.
constexpr double kMaxRatio = 0.916;
// Uniform errors have their median at half the gate, normal ones of 2.5 times the expected noise at
// 0.28 of it.
constexpr double kFilled = 0.35;

// Counts of the errors below a gate, in bins of equal width. The median of normal errors lies near
// bin 50: finer bins would not change it by more than its standard error.
class Histogram {
 public:
  static constexpr int kBins = 256;
  explicit Histogram(double gate) : gate_(gate), bins_per_px_(kBins / gate) {}

  void Add(double error) {
    if (!(error < gate_)) return;
    ++counts_[std::min(static_cast<int>(error * bins_per_px_), kBins - 1)];
    ++total_;
  }
  double gate() const { return gate_; }
  int total() const { return total_; }

  // The error below which this share of the inliers lies, without `outliers` that are uniform below
  // the gate, and without the `fitted` smallest: a fit can make as many errors zero as it has
  // parameters.
  double Quantile(double share, double outliers, double fitted) const {
    const double wanted = fitted + share * (total_ - outliers - fitted);
    const double per_bin = outliers / kBins;
    double below = 0.0;
    for (int bin = 0; bin < kBins; ++bin) {
      const double here = counts_[bin] - per_bin;
      if (here > 0 && below + here >= wanted) return (bin + (wanted - below) / here) / bins_per_px_;
      below += here;
    }
    return gate_;
  }

  // The mean square of the inliers' errors below `limit`, which is at most the gate.
  double MeanSquareBelow(double limit, double outliers) const {
    const double per_bin = outliers / kBins;
    double n = 0.0, squares = 0.0;
    double left = limit * bins_per_px_;  // bins
    for (int bin = 0; bin < kBins && left > 0; ++bin, left -= 1.0) {
      const double error = (bin + 0.5) / bins_per_px_;
      const double here = std::min(left, 1.0) * (counts_[bin] - per_bin);
      n += here;
      squares += here * error * error;
    }
    return n > 0 ? squares / n : 0.0;
  }

 private:
  double gate_;
  double bins_per_px_;
  std::array<int, kBins> counts_{};
  int total_ = 0;
};

// Standard deviation of normal errors of which those above `gate` are cut off and half lie below
// `median`; at most the gate.
double SigmaOfMedian(double median, double gate) {
  constexpr double kRoot2 = 1.4142135623730951;
  constexpr double kMedianSigmas = 0.6744897501960817;
  // A gate at six sigma and more cuts off nothing.
  constexpr double kWide = 6.0;
  if (gate > kWide * median / kMedianSigmas) return median / kMedianSigmas;
  // The share of errors below the median, under sigma, is half of those below the gate: Newton's
  // method for 1 / sigma. It falls from one step to the next, and four are exact up to a median of
  // 0.45 gates, where sigma is the gate.
  constexpr int kSteps = 4;
  constexpr double kTwoDensity0 = 0.7978845608028654;  // sqrt(2 / pi): twice the density at 0
  double u = kMedianSigmas / median;
  for (int k = 0; k < kSteps && u * gate > 1.0; ++k) {
    const double m = median * u, g = gate * u;
    const double excess = std::erf(m / kRoot2) - 0.5 * std::erf(g / kRoot2);
    u -= excess /
         (kTwoDensity0 * (median * std::exp(-0.5 * m * m) - 0.5 * gate * std::exp(-0.5 * g * g)));
  }
  return std::min(gate, 1.0 / u);
}

// The noise from errors below the gate, without the share of outliers. At most the gate, which
// means that the errors fill it. The median finds the size; the mean square of errors up to kCore
// times that has half its variance.
double RobustSigma(const Histogram& errors, double outliers_per_px, double fitted) {
  constexpr double kCore = 2.5;
  const double gate = errors.gate();
  const double outliers = outliers_per_px * gate;
  if (!(errors.total() - outliers >= 1.0)) return gate;
  const double sigma = SigmaOfMedian(errors.Quantile(0.5, outliers, fitted), gate);
  const double limit = kCore * sigma;
  if (!(limit < gate) || !(limit > 0)) return sigma;
  // Of normal errors below z sigma the mean square is (1 - 2 z phi(z) / (2 Phi(z) - 1)) sigma^2.
  constexpr double kInvSqrt2Pi = 0.3989422804014327;
  constexpr double kRoot2 = 1.4142135623730951;
  const double z = limit / sigma;
  const double share = 1.0 - 2.0 * z * kInvSqrt2Pi * std::exp(-0.5 * z * z) / std::erf(z / kRoot2);
  return std::sqrt(errors.MeanSquareBelow(limit, outliers) / share);
}

class Estimator {
 public:
  Estimator(const NoiseOptions& options, const GroupedMatches& matches, const MatchErrors& errors,
            int num_parameters, const NoiseModel* before)
      : options_(options),
        matches_(matches),
        errors_(errors),
        num_parameters_(num_parameters),
        px_(matches.size()) {
    for (int k = 0; k < matches.size(); ++k) {
      px_[k] = errors.in_front[k] ? std::sqrt(errors.squared[k])
                                  : std::numeric_limits<double>::infinity();
    }
    SetLeastGate();
    if (before != nullptr) {
      model_ = *before;
      max_estimates_ = kMaxUpdates;
      return;
    }
    const size_t n = matches.groups().size();
    model_.sigma_of.assign(n, options.threshold_px / kGateSigmas);
    model_.gate_of.assign(n, options.threshold_px);
    model_.outliers_per_px.assign(n, 0.0);
  }

  NoiseModel Run() {
    if (options_.noise_px.has_value()) {
      SetAll(*options_.noise_px);
      Count();
      return model_;
    }
    for (int k = 0; k < max_estimates_; ++k) {
      const std::vector<double> gates = model_.gate_of;
      Count();
      Estimate();
      bool stands = true;
      for (size_t g = 0; g < gates.size(); ++g) {
        stands = stands && std::abs(model_.gate_of[g] - gates[g]) <= kStands * gates[g];
      }
      if (stands) break;
    }
    return model_;
  }

 private:
  double GateOf(double sigma) const {
    return options_.keep_threshold ? options_.threshold_px : kGateSigmas * sigma;
  }

  void SetAll(double sigma) {
    model_.sigma_px = std::max(sigma, options_.min_noise_px);
    std::fill(model_.sigma_of.begin(), model_.sigma_of.end(), model_.sigma_px);
    const double gate = std::max(GateOf(model_.sigma_px), kGateSigmas * model_.sigma_px);
    std::fill(model_.gate_of.begin(), model_.gate_of.end(), gate);
  }

  // Nearly all errors below the threshold are those of inliers. A gate that leaves out more than a
  // tenth of them shrinks about the few that the motion was fitted to.
  void SetLeastGate() {
    constexpr double kKept = 0.9;
    Histogram all(options_.threshold_px);
    int in_band = 0;
    for (const double px : px_) {
      all.Add(px);
      in_band += static_cast<int>(px >= kBandBegin * options_.threshold_px) &
                 static_cast<int>(px < kBandEnd * options_.threshold_px);
    }
    if (all.total() > 0) {
      least_gate_ = all.Quantile(kKept, in_band / (kBandEnd - kBandBegin), 0.0);
    }
  }

  // Counts the errors below the gates, and the outliers of each camera pair in its band.
  void Count() {
    all_ = Histogram(*std::max_element(model_.gate_of.begin(), model_.gate_of.end()));
    own_.clear();
    for (size_t g = 0; g < model_.gate_of.size(); ++g) {
      const MatchGroup& group = matches_.groups()[g];
      own_.emplace_back(model_.gate_of[g]);
      const double begin = kBandBegin * model_.gate_of[g];
      const double end = kBandEnd * model_.gate_of[g];
      int in_band = 0;
      for (int k = group.begin; k < group.begin + group.size; ++k) {
        const double px = px_[k];
        all_.Add(px);
        own_[g].Add(px);
        in_band += static_cast<int>(px >= begin) & static_cast<int>(px < end);
      }
      model_.outliers_per_px[g] = in_band / (end - begin);
    }
  }

  void Estimate() {
    const Histogram& all = all_;
    const double largest = all.gate();
    if (all.total() == 0) return;
    const double outliers_per_px =
        std::accumulate(model_.outliers_per_px.begin(), model_.outliers_per_px.end(), 0.0);
    fitted_share_ = std::min(1.0, num_parameters_ / static_cast<double>(all.total()));
    double sigma = RobustSigma(all, outliers_per_px, fitted_share_ * all.total());
    // With as many matches as parameters the residuals are zero for any noise. With little
    // redundancy the threshold, which is meant to be three sigma, is the better estimate.
    constexpr int kMinRedundancy = 10;
    const int redundancy = all.total() - num_parameters_;
    correction_ = redundancy < kMinRedundancy
                      ? 1.0
                      : std::sqrt(all.total() / static_cast<double>(redundancy));
    sigma *= correction_;
    if (redundancy < kMinRedundancy) sigma = std::max(sigma, options_.threshold_px / 3.0);
    model_.sigma_px = Limited(sigma, largest);
    SetGroups();
  }

  // The noise of each camera pair: that of its own errors, drawn to that of all. The more the
  // camera pairs differ, beyond the errors of their estimates, the less.
  void SetGroups() {
    const size_t num_groups = model_.gate_of.size();
    const double log_of_all = std::log(model_.sigma_px);
    std::vector<double> logs(num_groups, log_of_all), variances(num_groups, 1.0);
    double squares = 0.0, expected = 0.0, total = 0.0;
    for (size_t g = 0; g < num_groups && num_groups > 1; ++g) {
      const Histogram& own = own_[g];
      if (own.total() < kMinOwn) continue;
      const double n = own.total();
      // Errors that fill the gate are no noise: the camera pair does not fit.
      const double outliers = model_.outliers_per_px[g] * own.gate();
      if (own.Quantile(0.5, outliers, fitted_share_ * n) > kFilled * own.gate()) continue;
      const double sigma = RobustSigma(own, model_.outliers_per_px[g], fitted_share_ * n);
      logs[g] = std::log(std::max(correction_ * sigma, options_.min_noise_px));
      variances[g] = kLogVariance / n;
      squares += n * (logs[g] - log_of_all) * (logs[g] - log_of_all);
      expected += kLogVariance;
      total += n;
    }
    const double spread = std::max(kMinSpread, total > 0 ? (squares - expected) / total : 0.0);
    for (size_t g = 0; g < num_groups; ++g) {
      const double share = spread / (spread + variances[g]);
      const double log =
          log_of_all + std::clamp(share * (logs[g] - log_of_all), -kMaxRatio, kMaxRatio);
      model_.sigma_of[g] = Limited(std::exp(log), model_.gate_of[g]);
      model_.gate_of[g] = GateOf(model_.sigma_of[g]);
    }
  }

  // The noise whose gate grows by no more than it may.
  double Limited(double sigma, double gate) const {
    const double growth = options_.keep_threshold ? kMaxGate : kMaxGrowth;
    const double largest = std::min(growth * gate, kMaxGate * options_.threshold_px);
    const double least = std::max(options_.min_noise_px, least_gate_ / kGateSigmas);
    return std::clamp(sigma, least, std::max(least, largest / kGateSigmas));
  }

  const NoiseOptions& options_;
  const GroupedMatches& matches_;
  const MatchErrors& errors_;
  int num_parameters_;
  std::vector<double> px_;  // the errors; infinite behind a camera
  Histogram all_{1.0};
  std::vector<Histogram> own_;  // of the camera pairs
  double least_gate_ = 0.0;
  double fitted_share_ = 0.0;  // of the errors: parameters that were fitted to them
  double correction_ = 1.0;    // residuals are smaller than the noise: n - p of n
  int max_estimates_ = kMaxEstimates;
  NoiseModel model_;
};

}  // namespace

void MatchErrors::Set(const GroupedMatches& matches, const Pose& pose, double threshold_px) {
  squared.resize(matches.size());
  in_front.resize(matches.size());
  // Larger errors are in no band.
  const double limit = kBandEnd * kMaxGate * threshold_px;
  for (const MatchGroup& group : matches.groups()) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = matches.Fundamental(group, pose);
    SelectInFront(matches.Rows(group), matches.Directions(group), F.data(),
                  matches.MotionOf(group, pose, threshold_px), limit * limit,
                  squared.data() + group.begin, in_front.data() + group.begin);
  }
}

NoiseModel EstimateNoise(const NoiseOptions& options, const GroupedMatches& matches,
                         const MatchErrors& errors, int num_parameters, const NoiseModel* before) {
  return Estimator(options, matches, errors, num_parameters, before).Run();
}

}  // namespace rigel
