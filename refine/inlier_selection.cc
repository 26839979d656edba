#include "rigel/refine/inlier_selection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigel {
namespace {

// The band beyond the gate where the outliers are counted, in gates.
constexpr double kBand = 20.0;
// Inliers that a place where there is no other is likely to have.
constexpr double kPriorInliers = 0.1;

// Counts of matches by the logarithm of their parallax, four bins to a factor of two.
class Histogram {
 public:
  static int Bin(double sin2_parallax) {
    // sin^2 halves twice where the sine halves.
    const double octaves = 0.5 * std::log2(std::max(sin2_parallax, 1e-14));
    return std::clamp(kBins - 2 + static_cast<int>(std::floor(4.0 * octaves)), 1, kBins - 2);
  }
  void Add(int bin) { ++counts_[bin]; }
  // How many there are of about the same parallax, within a factor of 1.3.
  int Near(int bin) const { return counts_[bin - 1] + counts_[bin] + counts_[bin + 1]; }
  // The same expected where there are few: from a wider neighbourhood.
  double NearSmoothed(int bin) const {
    const int first = std::max(bin - kReach, 0);
    const int last = std::min(bin + kReach, kBins - 1);
    int sum = 0;
    for (int k = first; k <= last; ++k) sum += counts_[k];
    return 3.0 * sum / (2 * kReach + 1);
  }

 private:
  static constexpr int kReach = 4;
  static constexpr int kBins = 96;
  std::array<int, kBins> counts_{};
};

// Squared sines of the parallax, what is left of the angle of a match's rays without rotation.
void SquaredParallax(const RayArrays& rays, const Eigen::Matrix3d& R, int size, double* sin2) {
  for (int k = 0; k < size; ++k) {
    const Eigen::Vector3d g = R * Eigen::Vector3d(rays.x1[k], rays.y1[k], rays.z1[k]);
    const double x = g.y() * rays.z2[k] - g.z() * rays.y2[k];
    const double y = g.z() * rays.x2[k] - g.x() * rays.z2[k];
    const double z = g.x() * rays.y2[k] - g.y() * rays.x2[k];
    sin2[k] = x * x + y * y + z * z;
  }
}

}  // namespace

int SelectInliers(const GroupedMatches& matches, const Pose& pose, double gate_px,
                  std::vector<double>* squared_errors, std::vector<char>* inliers) {
  // With an inter-camera baseline the parallax is of another size.
  enum { kIntra, kInter };
  Histogram within[2], beyond[2];
  const int n = matches.size();
  squared_errors->resize(n);
  inliers->resize(n);
  std::vector<char> bins(n);
  std::vector<double> sin2(n);
  const double gate2 = gate_px * gate_px;
  int count = 0, num_beyond = 0;
  for (const MatchGroup& group : matches.groups()) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = matches.Fundamental(group, pose);
    const RayArrays rays = matches.Directions(group);
    const int kind = group.camera1 == group.camera2 ? kIntra : kInter;
    double* errors = squared_errors->data() + group.begin;
    char* selected = inliers->data() + group.begin;
    SelectInFront(matches.Pixels(group), rays, F.data(), matches.MotionOf(group, pose, gate_px),
                  kBand * kBand * gate2, errors, selected);
    SquaredParallax(rays, pose.R, group.size, sin2.data() + group.begin);
    for (int k = 0; k < group.size; ++k) {
      if (!selected[k]) continue;
      const int bin = Histogram::Bin(sin2[group.begin + k]);
      bins[group.begin + k] = static_cast<char>(bin);
      const bool fits = errors[k] < gate2;
      (fits ? within : beyond)[kind].Add(bin);
      selected[k] = fits;
      count += fits;
      num_beyond += !fits;
    }
  }
  if (num_beyond == 0) return count;
  for (const MatchGroup& group : matches.groups()) {
    const int kind = group.camera1 == group.camera2 ? kIntra : kInter;
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (!(*inliers)[k]) continue;
      const double outliers = beyond[kind].NearSmoothed(bins[k]) / (kBand - 1.0);
      const double others = within[kind].Near(bins[k]) - 1 + kPriorInliers;
      if (outliers <= kMaxOutlierProbability * (outliers + others)) continue;
      (*inliers)[k] = 0;
      --count;
    }
  }
  return count;
}

}  // namespace rigel
