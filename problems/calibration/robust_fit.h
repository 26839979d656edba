// What the fits of a calibration share: robust weights, limits, texts for messages.
#ifndef RIGEL_PROBLEMS_CALIBRATION_ROBUST_FIT_H_
#define RIGEL_PROBLEMS_CALIBRATION_ROBUST_FIT_H_

#include <string>
#include <vector>

namespace rigel {

// Largest number of iterations: the weights may alternate without end.
inline constexpr int kMaxFitIterations = 50;
// The step that ends a fit, radians: far below what motions can determine.
inline constexpr double kConvergedRadians = 1e-12;
// Least spread of residuals, radians. Without noise the residuals are rounding errors, and weights
// by their spread would mean nothing.
inline constexpr double kMinSpread = 1e-7;

// 1-sigma of normally distributed residuals, by their median; at least kMinSpread.
double RobustSpread(std::vector<double> residuals);

// The weight of Cauchy's loss, 95 percent efficient on normal residuals.
double CauchyWeight(double residual, double spread);

// n / (n - parameters), the factor that corrects a variance: residuals of n motions are too small
// because parameters were fitted to them. 1 if n <= parameters.
double SmallSampleFactor(int n, int parameters);

// Whether a standard deviation, radians, is at most kMaxCalibrationSigmaDeg. False if negative.
bool IsDetermined(double sigma);

// "12.3 degrees".
std::string DegreesText(double radians);

// ", farther than the 30 that are believed": degrees, for messages that say how far a direction is
// from the expected one.
std::string TooFarText();

// "0.2 and 3.4 degrees, at most 1.0 is asked". A sigma that is negative or not finite is left out.
std::string SigmasText(double sigma1, double sigma2);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_CALIBRATION_ROBUST_FIT_H_
