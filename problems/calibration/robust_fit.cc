#include "rigel/problems/calibration/robust_fit.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/angles.h"
#include "rigel/core/median.h"
#include "rigel/problems/calibration/prior_calibration.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

// The standard deviation of a normal distribution over the median of its absolute values.
constexpr double kSigmaOfMedian = 1.4826;
// Sigmas: with this scale Cauchy's loss is 95 percent efficient on normal residuals.
constexpr double kCauchyScale = 2.385;

}  // namespace

double RobustSpread(std::vector<double> residuals) {
  if (residuals.empty()) return kMinSpread;
  for (double& r : residuals) r = std::abs(r);
  return std::max(kSigmaOfMedian * MedianInPlace(&residuals), kMinSpread);
}

double CauchyWeight(double residual, double spread) {
  const double u = residual / (kCauchyScale * spread);
  return 1.0 / (1.0 + u * u);
}

double SmallSampleFactor(int n, int parameters) {
  return n > parameters ? static_cast<double>(n) / (n - parameters) : 1.0;
}

bool IsDetermined(double sigma) { return sigma >= 0 && sigma <= DegToRad(kMaxCalibrationSigmaDeg); }

std::string DegreesText(double radians) { return FormatNumber(RadToDeg(radians), 1) + " degrees"; }

std::string TooFarText() {
  return ", farther than the " + FormatNumber(kMaxCalibrationTurnDeg, 0) + " that are believed";
}

std::string SigmasText(double sigma1, double sigma2) {
  std::string text;
  for (const double sigma : {sigma1, sigma2}) {
    if (!std::isfinite(sigma) || sigma < 0) continue;
    text += (text.empty() ? "" : " and ") + FormatNumber(RadToDeg(sigma), 2);
  }
  return (text.empty() ? "unknown" : text + " degrees") + ", at most " +
         FormatNumber(kMaxCalibrationSigmaDeg, 1) + " is asked";
}

}  // namespace rigel
