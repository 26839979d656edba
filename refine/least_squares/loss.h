// Robust losses: names, Ceres loss functions, and weights.
#ifndef RIGEL_REFINE_LEAST_SQUARES_LOSS_H_
#define RIGEL_REFINE_LEAST_SQUARES_LOSS_H_

#include <memory>
#include <string_view>

#include <ceres/loss_function.h>

#include "rigel/refine/least_squares/least_squares.h"

namespace rigel {

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
