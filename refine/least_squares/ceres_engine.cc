#include "rigel/refine/least_squares/ceres_engine.h"

#include <deque>
#include <functional>
#include <memory>

#include <ceres/ceres.h>

#include "rigel/core/stop.h"
#include "rigel/refine/least_squares/epipolar_residuals.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/reprojection_cost.h"

namespace rigel {
namespace {

bool Asked(Stop* stop) { return stop != nullptr && stop->Asked(); }

// Shared by all residual blocks: the motion and the linearized camera pairs at the current point.
class SharedEvaluation : public ceres::EvaluationCallback {
 public:
  SharedEvaluation(const MotionParameterization& parameterization,
                   const EpipolarResiduals& residuals, const double* parameters, Stop* stop)
      : parameterization_(parameterization),
        residuals_(residuals),
        parameters_(parameters),
        stop_(stop) {}

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    stopped = stopped || Asked(stop_);
    if (stopped) return;
    if (!new_evaluation_point && (has_jacobians_ || !evaluate_jacobians)) return;
    parameterization_.Evaluate(parameters_, &pose, &basis);
    residuals_.Linearize(pose, evaluate_jacobians ? &basis : nullptr, &groups);
    has_jacobians_ = evaluate_jacobians;
  }

  Pose pose;
  MotionBasis basis;
  std::vector<GroupLinearization> groups;
  bool stopped = false;  // then no block evaluates: with many blocks that would take long

 private:
  const MotionParameterization& parameterization_;
  const EpipolarResiduals& residuals_;
  const double* parameters_;
  Stop* stop_;
  bool has_jacobians_ = false;
};

class MatchCost : public ceres::CostFunction {
 public:
  MatchCost(const EpipolarResiduals& residuals, const SharedEvaluation& shared, int k, int size,
            double weight)
      : residuals_(&residuals), shared_(&shared), k_(k), size_(size), weight_(weight) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(size);
  }
  bool Evaluate(double const* const*, double* r, double** jacobians) const override {
    if (shared_->stopped) return false;
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    r[0] = weight_ * residuals_->Evaluate(shared_->groups, k_, size_, jacobian);
    for (int m = 0; m < size_ && jacobian != nullptr; ++m) jacobian[m] *= weight_;
    return true;
  }

 private:
  const EpipolarResiduals* residuals_;
  const SharedEvaluation* shared_;
  int k_;
  int size_;
  double weight_;
};

class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(const PriorResiduals& prior, const SharedEvaluation& shared, double unit, int size)
      : prior_(&prior), shared_(&shared), unit_(unit) {
    set_num_residuals(prior.size());
    mutable_parameter_block_sizes()->push_back(size);
  }
  bool Evaluate(double const* const*, double* r, double** jacobians) const override {
    if (shared_->stopped) return false;
    PriorResiduals::Residuals values;
    PriorResiduals::Jacobian by_motion;
    prior_->Evaluate(shared_->pose, &values, &by_motion);
    for (int i = 0; i < prior_->size(); ++i) r[i] = unit_ * values(i);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      const int n = static_cast<int>(shared_->basis.cols());
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> out(
          jacobians[0], prior_->size(), n);
      out = unit_ * by_motion * shared_->basis;
    }
    return true;
  }

 private:
  const PriorResiduals* prior_;
  const SharedEvaluation* shared_;
  double unit_;  // the image noise: residuals of matches are in pixels, the prior's in sigmas
};

// Reports each iteration, and ends the solver when `stop` asks for it.
class IterationReport : public ceres::IterationCallback {
 public:
  IterationReport(Stop* stop, const std::function<void(int, double)>* progress)
      : stop_(stop), progress_(progress) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (progress_ != nullptr) (*progress_)(iteration.iteration, iteration.cost);
    return Asked(stop_) ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  Stop* stop_;
  const std::function<void(int, double)>* progress_;
};

}  // namespace

LeastSquaresSummary SolveWithCeres(const LeastSquaresOptions& options,
                                   const GroupedMatches& matches,
                                   const MotionParameterization& parameterization,
                                   const std::vector<double>& weights, const PriorResiduals& prior,
                                   double prior_unit, const Pose& start, double* parameters) {
  const int size = parameterization.size();
  const EpipolarResiduals residuals(matches, options.residual);
  SharedEvaluation shared(parameterization, residuals, parameters, options.stop);
  std::deque<MatchCost> costs;
  PriorCost prior_cost(prior, shared, prior_unit, size);
  // The algebraic residual is in metres, and the scale of the loss in pixels.
  const std::unique_ptr<ceres::LossFunction> loss =
      options.residual == ResidualKind::kAlgebraic && !options.bundle
          ? nullptr
          : MakeLoss(options.loss, options.loss_scale);

  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  problem_options.evaluation_callback = &shared;
  ceres::Problem problem(problem_options);
  constexpr int kStopEvery = 1024;
  std::deque<ReprojectionCost> reprojections;
  // Contiguous, since Ceres orders the blocks of a group by their addresses.
  std::vector<ReprojectionCost::Point> points;
  if (options.bundle) points.reserve(weights.size());
  for (int k = 0; k < matches.size(); ++k) {
    // The parameters are still those of the start.
    if (k % kStopEvery == 0 && Asked(options.stop)) {
      LeastSquaresSummary summary;
      summary.usable = true;
      return summary;
    }
    if (weights[k] == 0.0) continue;
    if (options.bundle) {
      const Match& match = matches.matches()[k];
      points.push_back(ReprojectionCost::Triangulate(matches.rig(), match, start));
      reprojections.emplace_back(matches.rig(), match, shared.pose, shared.basis, size, weights[k],
                                 &shared.stopped);
      problem.AddResidualBlock(&reprojections.back(), loss.get(), parameters, points.back().data());
    } else {
      costs.emplace_back(residuals, shared, k, size, weights[k]);
      problem.AddResidualBlock(&costs.back(), loss.get(), parameters);
    }
  }
  if (prior.size() > 0) problem.AddResidualBlock(&prior_cost, nullptr, parameters);

  ceres::Solver::Options solver_options;
  solver_options.linear_solver_type =
      options.bundle ? ceres::DENSE_SCHUR : ceres::DENSE_NORMAL_CHOLESKY;
  if (options.bundle) {
    // The points are eliminated first.
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (ReprojectionCost::Point& point : points) ordering->AddElementToGroup(point.data(), 0);
    ordering->AddElementToGroup(parameters, 1);
    solver_options.linear_solver_ordering = ordering;
  }
  solver_options.logging_type = ceres::SILENT;
  solver_options.minimizer_progress_to_stdout = false;
  solver_options.num_threads = 1;
  solver_options.max_num_iterations = options.max_num_iterations;
  solver_options.function_tolerance = 1e-10;
  solver_options.parameter_tolerance = 1e-12;
  solver_options.gradient_tolerance = 1e-14;
  // Undetermined points must not make a step fail: Ceres would log that.
  solver_options.min_lm_diagonal = 1e-4;
  solver_options.max_trust_region_radius = 1e6;
  IterationReport report(options.stop, options.progress);
  solver_options.callbacks.push_back(&report);
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(solver_options, &problem, &ceres_summary);

  LeastSquaresSummary summary;
  // If stopped within the first evaluation, Ceres leaves the parameters at the start.
  summary.usable = ceres_summary.IsSolutionUsable() || shared.stopped;
  summary.initial_cost = ceres_summary.initial_cost;
  summary.final_cost = ceres_summary.final_cost;
  summary.num_iterations = static_cast<int>(ceres_summary.iterations.size());
  summary.converged = ceres_summary.termination_type != ceres::NO_CONVERGENCE;
  return summary;
}

}  // namespace rigel
