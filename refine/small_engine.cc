#include "rigel/refine/small_engine.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <ceres/tiny_solver.h>

#include "rigel/refine/motion_parameterization.h"

namespace rigel {
namespace {

// rho(s), so that r sqrt(rho(r^2)) / |r| is the folded residual.
double LossValue(LossKind kind, double scale, double s) {
  const double scale2 = scale * scale;
  switch (kind) {
    case LossKind::kNone:
      return s;
    case LossKind::kHuber:
      return s <= scale2 ? s : 2.0 * scale * std::sqrt(s) - scale2;
    case LossKind::kCauchy:
      return scale2 * std::log1p(s / scale2);
    case LossKind::kTukey: {
      const double u = std::max(0.0, 1.0 - s / scale2);
      return scale2 / 3.0 * (1.0 - u * u * u);
    }
    case LossKind::kTruncated:
      return std::min(s, scale2);
  }
  return s;
}

}  // namespace

class SmallEngine::Impl {
 public:
  // What ceres::TinySolver asks of a function.
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 6 };

  explicit Impl(const EpipolarResiduals& residuals) : residuals_(residuals) {}

  int NumResiduals() const { return residuals_.size(); }

  bool operator()(const double* parameters, double* r, double* jacobian) const {
    Pose pose;
    parameterization_.Evaluate(parameters, &pose, jacobian != nullptr ? &basis_ : nullptr);
    residuals_.Linearize(pose, jacobian != nullptr ? &basis_ : nullptr, &groups_);
    const int n = residuals_.size();
    for (int k = 0; k < n; ++k) {
      double* row = jacobian != nullptr ? jacobian + k : nullptr;
      if (!(*mask_)[k]) {
        r[k] = 0.0;
        for (int m = 0; m < 6 && row != nullptr; ++m) row[m * n] = 0.0;
        continue;
      }
      const double value = residuals_.Evaluate(groups_, k, 6, row, n);
      const double s = value * value;
      const double rho = LossValue(options_.loss, options_.loss_scale, s);
      const double fold = s > 0 ? std::sqrt(rho / s) : 1.0;
      r[k] = fold * value;
      if (row == nullptr) continue;
      // d(r sqrt(rho / s)) / dr = rho' / fold.
      const double slope =
          fold > 0 ? LossWeight(options_.loss, options_.loss_scale, value) / fold : 0.0;
      for (int m = 0; m < 6; ++m) row[m * n] *= slope;
    }
    return true;
  }

  bool Minimize(const SmallEngineOptions& options, const std::vector<char>& mask, Pose* pose) {
    options_ = options;
    mask_ = &mask;
    const auto form =
        options.inverse_scale ? TranslationForm::kInverseScale : TranslationForm::kFree;
    if (!parameterization_.Set(RotationForm::kFree, form, *pose, Alignment(), RayPair())) {
      return false;
    }
    Eigen::Matrix<double, 6, 1> parameters = Eigen::Matrix<double, 6, 1>::Zero();
    solver_.options.max_num_iterations = options.max_num_iterations;
    solver_.Solve(*this, &parameters);
    if (!(solver_.summary.final_cost < solver_.summary.initial_cost) || !parameters.allFinite()) {
      return false;
    }
    Pose result;
    parameterization_.Evaluate(parameters.data(), &result, nullptr);
    if (!result.AllFinite()) return false;
    *pose = result;
    return true;
  }

  int num_iterations() const { return solver_.summary.iterations; }

 private:
  const EpipolarResiduals& residuals_;
  SmallEngineOptions options_;
  const std::vector<char>* mask_ = nullptr;
  MotionParameterization parameterization_;
  mutable MotionBasis basis_;
  mutable std::vector<GroupLinearization> groups_;
  ceres::TinySolver<Impl> solver_;
};

SmallEngine::SmallEngine(const EpipolarResiduals& residuals)
    : impl_(std::make_unique<Impl>(residuals)) {}
SmallEngine::~SmallEngine() = default;

bool SmallEngine::Minimize(const SmallEngineOptions& options, const std::vector<char>& mask,
                           Pose* pose) {
  return impl_->Minimize(options, mask, pose);
}

int SmallEngine::num_iterations() const { return impl_->num_iterations(); }

}  // namespace rigel
