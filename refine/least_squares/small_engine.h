// Least squares on the Sampson errors of a frame pair without building a ceres::Problem: what local
// optimization in RANSAC and Refine() run on.
//
// Levenberg-Marquardt on the normal equations that sampson_kernel.h sums, so that an iteration
// costs little more than a look at each match: 600 matches and a robust loss from a hypothesis that
// is 1 degree off take a tenth of the time of a Problem (rigel_benchmark --refine).
#ifndef RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_
#define RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_

#include <functional>
#include <vector>

#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/core/stop.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"

namespace rigel {

struct SmallEngineOptions {
  LossKind loss = LossKind::kTruncated;
  double loss_scale = 1.5;  // pixels, > 0
  int max_num_iterations = 4;
  // Converged once a step promises to lower the cost by less than this fraction of it. Of n
  // residuals the step is then about sqrt(n tolerance) standard deviations long, and it is taken.
  double tolerance = 1e-4;
  // Minimize(): TranslationForm::kInverseScale instead of a free t, for matches that hardly
  // determine |t|.
  bool inverse_scale = false;
  // Asked before each iteration (null: never): it ends with the best parameters by then.
  Stop* stop = nullptr;
  // Called after each iteration with its number, from 1, and the cost. Null: not at all.
  const std::function<void(int, double)>* progress = nullptr;
};

// The matches of weight above zero, group by group: what is left out takes no time.
struct PackedMatches {
  // `weights`: grouped order.
  void Set(const GroupedMatches& matches, const std::vector<double>& weights);

  std::vector<double> x1, y1, x2, y2, weights;
  std::vector<PixelArrays> groups;  // into the arrays above
};

struct LeastSquaresSummary {
  bool usable = false;  // finite from the start to the end
  bool converged = false;
  int num_iterations = 0;
  double initial_cost = 0.0;  // 1/2 sum rho(r^2), with the prior's 1/2 r^2
  double final_cost = 0.0;
};

// Keeps its memory from call to call: no heap after the first.
class SmallEngine {
 public:
  // `matches` must outlive this object.
  explicit SmallEngine(const GroupedMatches& matches) : matches_(matches) {}
  SmallEngine(const SmallEngine&) = delete;
  SmallEngine& operator=(const SmallEngine&) = delete;

  // Minimizes over `parameters` (in: the start, out: the best found), parameterization.size() of
  // them. `weights` multiply the residuals (grouped order; 0 leaves a match out). The residuals of
  // `prior` at the motion are multiplied by `prior_unit`, pixels, and take no loss.
  LeastSquaresSummary Solve(const SmallEngineOptions& options,
                            const MotionParameterization& parameterization,
                            const std::vector<double>& weights, const PriorResiduals& prior,
                            double prior_unit, double* parameters);

  // Over rotation and translation and the matches with mask[k] != 0 (grouped order; as many as
  // the matches). False, and `pose` unchanged, if no step lowers the cost or the result is not
  // finite.
  bool Minimize(const SmallEngineOptions& options, const std::vector<char>& mask, Pose* pose);

  int num_iterations() const { return num_iterations_; }  // of the last call

 private:
  const GroupedMatches& matches_;
  std::vector<double> weights_;
  PackedMatches packed_;
  int num_iterations_ = 0;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_SMALL_ENGINE_H_
