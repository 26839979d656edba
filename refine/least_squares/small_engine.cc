#include "rigel/refine/least_squares/small_engine.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "rigel/core/stop.h"
#include "rigel/refine/least_squares/normal_equations.h"

namespace rigel {
namespace {

// Of at most six parameters: no heap.
using ParameterVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;
using ParameterMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

// Cost, gradient and curvature at one point.
class ParameterEquations {
 public:
  ParameterEquations(const LeastSquaresOptions& options, const GroupedMatches& matches,
                     const MotionParameterization& parameterization, const PackedMatches& packed,
                     const PriorResiduals& prior, double prior_unit)
      : matches_(matches),
        parameterization_(parameterization),
        packed_(packed),
        prior_(prior),
        prior_unit_(prior_unit) {
    kernel_.loss = options.loss;
    kernel_.loss_scale = options.loss_scale;
  }

  // Without `derivatives` only the cost is set.
  void Evaluate(const ParameterVector& parameters, bool derivatives) {
    const int n = static_cast<int>(parameters.size());
    Pose pose;
    MotionBasis basis;
    parameterization_.Evaluate(parameters.data(), &pose, &basis);
    MotionNormalEquations sum;
    for (size_t g = 0; g < packed_.groups.size(); ++g) {
      const RowArrays& rows = packed_.groups[g];
      const double* weights = packed_.weights.data() + (rows.x1 - packed_.x1.data());
      AddNormalEquations(kernel_, matches_, matches_.groups()[g], rows, weights, pose,
                         derivatives ? SampsonParts::kAll : SampsonParts::kCost, &sum);
    }
    cost = sum.cost;
    if (derivatives) {
      // Padded with zeros, so that the compiler knows the sizes.
      Matrix6d B = Matrix6d::Zero();
      B.leftCols(n) = basis;
      gradient = (B.transpose() * sum.gradient).head(n);
      const Matrix6d by_parameters = B.transpose() * (sum.curvature * B);
      curvature = by_parameters.topLeftCorner(n, n);
    }
    if (prior_.size() == 0) return;
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian by_motion;
    prior_.Evaluate(pose, &r, &by_motion);
    r *= prior_unit_;
    cost += 0.5 * r.squaredNorm();
    if (!derivatives) return;
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxPriorResiduals,
                        6>
        J = prior_unit_ * by_motion.lazyProduct(basis);
    gradient.noalias() += J.transpose().lazyProduct(r);
    curvature.noalias() += J.transpose().lazyProduct(J);
  }

  bool AllFinite() const {
    return std::isfinite(cost) && gradient.allFinite() && curvature.allFinite();
  }

  double cost = 0.0;
  ParameterVector gradient;
  ParameterMatrix curvature;

 private:
  const GroupedMatches& matches_;
  const MotionParameterization& parameterization_;
  const PackedMatches& packed_;
  const PriorResiduals& prior_;
  double prior_unit_;
  SampsonKernelOptions kernel_;
};

// Damping by the diagonal of the scaled curvature, since radians and metres differ in size.
ParameterVector DampedStep(const ParameterEquations& at, double mu) {
  constexpr double kMinDiagonal = 1e-6;
  const ParameterVector scale = (1.0 + at.curvature.diagonal().array().sqrt()).inverse();
  ParameterMatrix scaled = scale.asDiagonal() * at.curvature * scale.asDiagonal();
  scaled.diagonal() += mu * scaled.diagonal().cwiseMax(kMinDiagonal);
  const ParameterVector b = -(scale.array() * at.gradient.array());
  return scale.array() * scaled.llt().solve(b).array();
}

}  // namespace

void PackedMatches::Set(const GroupedMatches& matches, const std::vector<double>& all_weights) {
  const size_t stride = matches.size() + kKernelPadding;
  for (std::vector<double>* values : {&x1, &y1, &x2, &y2, &weights}) values->resize(stride);
  groups.clear();
  int n = 0;
  for (const MatchGroup& group : matches.groups()) {
    const RowArrays rows = matches.Rows(group);
    const double* w = all_weights.data() + group.begin;
    const int begin = n;
    for (int k = 0; k < group.size; ++k) {
      x1[n] = rows.x1[k];
      y1[n] = rows.y1[k];
      x2[n] = rows.x2[k];
      y2[n] = rows.y2[k];
      weights[n] = w[k];
      n += w[k] != 0.0 ? 1 : 0;
    }
    const double* more = nullptr;
    if (rows.general != nullptr) {
      general.resize(kGeneralArrays * stride);
      for (int c = 0; c < kGeneralArrays; ++c) {
        int i = begin;
        for (int k = 0; k < group.size; ++k) {
          general[c * stride + i] = rows.general[c * rows.stride + k];
          i += w[k] != 0.0 ? 1 : 0;
        }
      }
      more = general.data() + begin;
    }
    groups.push_back({x1.data() + begin, y1.data() + begin, x2.data() + begin, y2.data() + begin,
                      n - begin, more, stride});
  }
}

LeastSquaresSummary SmallEngine::Solve(const LeastSquaresOptions& options,
                                       const MotionParameterization& parameterization,
                                       const std::vector<double>& weights,
                                       const PriorResiduals& prior, double prior_unit,
                                       double* parameters) {
  constexpr double kInitialDamping = 1e-4;
  constexpr double kMaxDamping = 1e16;
  constexpr double kMinStep = 1e-14;  // radians and metres
  LeastSquaresSummary summary;
  num_iterations_ = 0;
  const int n = parameterization.size();
  Eigen::Map<ParameterVector> best(parameters, n);
  packed_.Set(matches_, weights);
  ParameterEquations at(options, matches_, parameterization, packed_, prior, prior_unit);
  ParameterEquations next = at;
  at.Evaluate(best, /*derivatives=*/true);
  if (!at.AllFinite()) return summary;
  summary.usable = true;
  summary.initial_cost = at.cost;
  double mu = kInitialDamping;
  double growth = 2.0;
  while (summary.num_iterations < options.max_num_iterations) {
    if (options.stop != nullptr && options.stop->Asked()) break;
    ++summary.num_iterations;
    const ParameterVector step = DampedStep(at, mu);
    const double predicted =
        -step.dot(at.gradient) - 0.5 * step.dot(at.curvature.lazyProduct(step));
    if (step.allFinite() && (predicted <= options.tolerance * at.cost || step.norm() < kMinStep)) {
      summary.converged = true;
      if (predicted > 0) {
        best += step;
        at.cost = std::max(0.0, at.cost - predicted);
      }
      break;
    }
    const ParameterVector candidate = best + step;
    // After the last step no derivatives are needed.
    const bool last = summary.num_iterations == options.max_num_iterations;
    if (candidate.allFinite()) next.Evaluate(candidate, /*derivatives=*/!last);
    if (candidate.allFinite() && next.AllFinite() && next.cost < at.cost) {
      const double quality = (at.cost - next.cost) / predicted;
      const double shrink = 2.0 * quality - 1.0;
      mu *= std::max(1.0 / 3.0, 1.0 - shrink * shrink * shrink);
      growth = 2.0;
      best = candidate;
      std::swap(at.cost, next.cost);
      std::swap(at.gradient, next.gradient);
      std::swap(at.curvature, next.curvature);
    } else {
      mu *= growth;
      growth *= 2.0;
      // The step is so short that only rounding is left.
      if (mu > kMaxDamping) break;
    }
    if (options.progress != nullptr) (*options.progress)(summary.num_iterations, at.cost);
  }
  summary.final_cost = at.cost;
  num_iterations_ = summary.num_iterations;
  return summary;
}

bool SmallEngine::Minimize(const LeastSquaresOptions& options, const std::vector<char>& mask,
                           const PriorResiduals& prior, double prior_unit, Pose* pose) {
  constexpr LengthRange kRange = {0.25, 1000.0};
  num_iterations_ = 0;
  const double length = pose->t.norm();
  LengthRange range;
  if (options.limits_length) range = {kRange.min * length, kRange.max * length};
  MotionParameterization parameterization;
  if (!parameterization.Set(RotationForm::kFree, {}, *pose, Alignment(), RayPair(), range)) {
    return false;
  }
  weights_.assign(mask.begin(), mask.end());
  double parameters[6] = {0, 0, 0, 0, 0, 0};
  const LeastSquaresSummary summary =
      Solve(options, parameterization, weights_, prior, prior_unit, parameters);
  if (!summary.usable || !(summary.final_cost < summary.initial_cost)) return false;
  Pose result;
  parameterization.Evaluate(parameters, &result, nullptr);
  if (!result.AllFinite()) return false;
  *pose = result;
  return true;
}

}  // namespace rigel
