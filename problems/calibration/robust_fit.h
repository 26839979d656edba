// What the fits of a calibration share: robust weights, limits, texts for messages.
#ifndef RIGEL_PROBLEMS_CALIBRATION_ROBUST_FIT_H_
#define RIGEL_PROBLEMS_CALIBRATION_ROBUST_FIT_H_

#include <string>
#include <vector>

namespace rigel {

// Iterations: weights may alternate without an end, and a fit has to.
inline constexpr int kMaxFitIterations = 50;
// The step that ends a fit, radians: far below what motions can determine.
inline constexpr double kConvergedRadians = 1e-12;
// Radians. Motions without noise have residuals of rounding only, of which no weights can be made.
inline constexpr double kMinSpread = 1e-7;

// 1-sigma of normally distributed residuals, by their median; at least kMinSpread.
double RobustSpread(std::vector<double> residuals);

// The weight of Cauchy's loss, 95 percent efficient on normal residuals.
double CauchyWeight(double residual, double spread);

// n / (n - parameters): what the residuals of n motions lack because parameters were fitted to
// them.
double SmallSampleFactor(int n, int parameters);

// Whether a standard deviation, radians, is at most kMaxCalibrationSigmaDeg. False if negative.
bool IsDetermined(double sigma);

// "12.3 degrees".
std::string DegreesText(double radians);

// ", farther than the 30 that are believed".
std::string TooFarText();

// "0.2 and 3.4 degrees, at most 1.0 is asked". A sigma that is negative or not finite is left out.
std::string SigmasText(double sigma1, double sigma2);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_ROBUST_FIT_H_
