// Robust losses by name.
#ifndef RIGEL_REFINE_LEAST_SQUARES_LOSS_H_
#define RIGEL_REFINE_LEAST_SQUARES_LOSS_H_

#include <memory>
#include <string_view>

#include <ceres/loss_function.h>

namespace rigel {

// rho(s) of the squared residual s with scale a: kNone s; kHuber, kCauchy, kTukey as in Ceres;
// kTruncated min(s, a^2).
enum class LossKind { kNone, kHuber, kCauchy, kTukey, kTruncated };

const char* LossName(LossKind kind);

// False if there is no loss of that name.
bool ParseLoss(std::string_view name, LossKind* kind);

// `scale` in the residual's unit, > 0. Null for kNone, which is what Ceres takes for plain least
// squares.
std::unique_ptr<ceres::LossFunction> MakeLoss(LossKind kind, double scale);

// Weight rho'(r^2) of a residual r: least squares with these weights has the same minimum.
double LossWeight(LossKind kind, double scale, double r);

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_LOSS_H_
