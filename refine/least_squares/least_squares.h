// What the engines that minimize over the residuals of a frame pair have in common: their options
// and what they tell.
#ifndef RIGEL_REFINE_LEAST_SQUARES_LEAST_SQUARES_H_
#define RIGEL_REFINE_LEAST_SQUARES_LEAST_SQUARES_H_

#include <functional>

namespace rigel {

class Stop;

// Their formulas: epipolar_residuals.h.
enum class ResidualKind { kSampson, kAngular, kAlgebraic };

// rho(s) of the squared residual s with scale a: kNone s; kHuber, kCauchy, kTukey as in Ceres;
// kTruncated min(s, a^2).
enum class LossKind { kNone, kHuber, kCauchy, kTukey, kTruncated };

struct LeastSquaresOptions {
  LossKind loss = LossKind::kTruncated;
  double loss_scale = 1.5;  // pixels, > 0
  int max_num_iterations = 4;
  // Asked before each iteration (null: never): it ends with the best parameters by then.
  Stop* stop = nullptr;
  // Called after each iteration with its number, from 1 (Ceres: from 0, the start), and the cost.
  // Null: not at all.
  const std::function<void(int, double)>* progress = nullptr;

  // Of the small engine alone. Converged once a step promises to lower the cost by less than this
  // fraction of it. Of n residuals the step is then about sqrt(n tolerance) standard deviations
  // long, and it is taken.
  double tolerance = 1e-4;
  // SmallEngine::Minimize(): TranslationForm::kInverseScale instead of a free t, for matches that
  // hardly determine |t|.
  bool inverse_scale = false;

  // Of Ceres alone: the small engine has Sampson errors, and no points.
  ResidualKind residual = ResidualKind::kSampson;
  // The points of the matches are parameters, too, and their reprojection errors the residuals.
  bool bundle = false;
};

struct LeastSquaresSummary {
  bool usable = false;  // finite from the start to the end
  bool converged = false;
  int num_iterations = 0;
  double initial_cost = 0.0;  // 1/2 sum rho(r^2), with the prior's 1/2 r^2
  double final_cost = 0.0;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_LEAST_SQUARES_H_
