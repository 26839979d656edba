// Options and summary of the least-squares engines (small_engine.h, ceres_engine.h).
#ifndef RIGEL_REFINE_LEAST_SQUARES_LEAST_SQUARES_H_
#define RIGEL_REFINE_LEAST_SQUARES_LEAST_SQUARES_H_

#include <functional>

namespace rigel {

class Stop;

// The formulas are in epipolar_residuals.h.
enum class ResidualKind { kSampson, kAngular, kAlgebraic };

// rho(s) of the squared residual s with scale a: kNone s; kHuber, kCauchy, kTukey as in Ceres;
// kTruncated min(s, a^2).
enum class LossKind { kNone, kHuber, kCauchy, kTukey, kTruncated };

struct LeastSquaresOptions {
  LossKind loss = LossKind::kTruncated;
  double loss_scale = 1.5;  // pixels, > 0
  int max_num_iterations = 4;
  // Asked before each iteration; if it stops the engine, the best parameters by then are returned.
  // Null: never.
  Stop* stop = nullptr;
  // Called after each iteration with its number, from 1 (Ceres: from 0, the start), and the cost.
  // Null: not at all.
  const std::function<void(int, double)>* progress = nullptr;

  // Small engine only. Converged if a step is predicted to lower the cost by less than this
  // fraction of it. With n residuals the step is then about sqrt(n tolerance) standard deviations
  // long. It is still taken.
  double tolerance = 1e-4;
  // SmallEngine::Minimize() only: |t| stays within a quarter and a thousand times the start's, for
  // matches that hardly determine it. At a tiny |t| there are false minima (sign_and_scale.h).
  bool limits_length = false;

  // Ceres only; the small engine always has Sampson residuals and no points.
  ResidualKind residual = ResidualKind::kSampson;
  // The points of the matches are parameters too, and the residuals are their reprojection errors.
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
