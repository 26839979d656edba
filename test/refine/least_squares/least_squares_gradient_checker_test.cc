// The cost functions of the refinement through ceres::GradientChecker.
#include <cmath>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>
#include <Eigen/QR>

#include "rigel/test/refine/least_squares/jacobian_twins.h"

namespace rigel {
namespace {

// A cost function in turned parameters, x = M y with an orthogonal M for each block. The checker
// holds each number against itself, so a parameter that a residual does not depend on, such as |t|
// of an intra-camera match without rotation, would be rounding against rounding; turned, each
// number is a sum over the whole row.
class Turned final : public ceres::CostFunction {
 public:
  Turned(const ceres::CostFunction& cost, Random* random) : cost_(cost) {
    set_num_residuals(cost.num_residuals());
    *mutable_parameter_block_sizes() = cost.parameter_block_sizes();
    for (const int size : parameter_block_sizes()) {
      Eigen::MatrixXd A(size, size);
      for (double& a : A.reshaped()) a = random->Normal();
      M_.push_back(A.householderQr().householderQ());
    }
  }

  // y of the block's x.
  Eigen::VectorXd Turn(int block, const double* x) const {
    return M_[block].transpose() * Eigen::VectorXd::Map(x, M_[block].rows());
  }

  bool Evaluate(double const* const* y, double* residuals, double** jacobians) const override {
    std::vector<Eigen::VectorXd> x;
    std::vector<const double*> blocks;
    for (size_t k = 0; k < M_.size(); ++k) {
      x.push_back(M_[k] * Eigen::VectorXd::Map(y[k], M_[k].rows()));
    }
    for (const Eigen::VectorXd& v : x) blocks.push_back(v.data());
    if (!cost_.Evaluate(blocks.data(), residuals, jacobians)) return false;
    for (size_t k = 0; k < M_.size() && jacobians != nullptr; ++k) {
      if (jacobians[k] == nullptr) continue;
      for (int r = 0; r < num_residuals(); ++r) {
        Eigen::Map<Eigen::RowVectorXd> row(jacobians[k] + r * M_[k].rows(), M_[k].rows());
        row = (row * M_[k]).eval();
      }
    }
    return true;
  }

 private:
  const ceres::CostFunction& cost_;
  std::vector<Eigen::MatrixXd> M_;
};

// At x, without manifolds: the chart's parameters are plain numbers. The first step is 32 times the
// number given here; Ceres' own is too long for an angle.
bool Probe(const ceres::CostFunction& cost, const std::vector<const double*>& x, Random* random) {
  const Turned turned(cost, random);
  std::vector<Eigen::VectorXd> y;
  std::vector<const double*> blocks;
  for (size_t k = 0; k < x.size(); ++k) y.push_back(turned.Turn(static_cast<int>(k), x[k]));
  for (const Eigen::VectorXd& v : y) blocks.push_back(v.data());
  ceres::NumericDiffOptions numeric;
  numeric.ridders_relative_initial_step_size = 1e-4;
  const std::vector<const ceres::Manifold*> manifolds(blocks.size(), nullptr);
  const ceres::GradientChecker checker(&turned, &manifolds, numeric);
  // Without its results: Eigen memory of Ceres' library is not to be freed by a program under
  // AddressSanitizer, where Eigen allocates in another way.
  return checker.Probe(blocks.data(), kCheckerTolerance, nullptr);
}

// All matches as residuals of one block.
class EpipolarOnChart final : public ceres::CostFunction {
 public:
  EpipolarOnChart(const MotionParameterization& chart, const GroupedMatches& matches,
                  ResidualKind kind)
      : chart_(chart), residuals_(matches, kind) {
    set_num_residuals(residuals_.size());
    mutable_parameter_block_sizes()->push_back(chart.size());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const bool with_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    Pose pose;
    MotionBasis basis;
    std::vector<GroupLinearization> groups;
    chart_.Evaluate(parameters[0], &pose, &basis);
    residuals_.Linearize(pose, with_jacobian ? &basis : nullptr, &groups);
    for (int k = 0; k < residuals_.size(); ++k) {
      double* row = with_jacobian ? jacobians[0] + k * chart_.size() : nullptr;
      residuals[k] = residuals_.Evaluate(groups, k, chart_.size(), row);
    }
    return true;
  }

 private:
  const MotionParameterization& chart_;
  EpipolarResiduals residuals_;
};

class PriorOnChart final : public ceres::CostFunction {
 public:
  PriorOnChart(const MotionParameterization& chart, const PriorResiduals& prior)
      : chart_(chart), prior_(prior) {
    set_num_residuals(prior.size());
    mutable_parameter_block_sizes()->push_back(chart.size());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Pose pose;
    MotionBasis basis;
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian J;
    chart_.Evaluate(parameters[0], &pose, &basis);
    prior_.Evaluate(pose, &r, &J);
    Eigen::VectorXd::Map(residuals, r.size()) = r;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          jacobians[0], r.size(), chart_.size()) = J * basis;
    }
    return true;
  }

 private:
  const MotionParameterization& chart_;
  const PriorResiduals& prior_;
};

TEST(Jacobian, EpipolarResidualsPassGradientChecker) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(136, i);
    for (const Form& form : kForms) {
      const MotionParameterization chart = MakeChart(form, p.start);
      const Parameters x = RandomParameters(form, i, false, &random);
      for (const Match& m : {p.matches[i % 3 * 4], p.matches[1 + i % 3]}) {
        const GroupedMatches matches(p.rig, {m});
        for (int kind = 0; kind < 3; ++kind) {
          EXPECT_TRUE(Probe(EpipolarOnChart(chart, matches, kKinds[kind]), {x.data()}, &random))
              << kKindNames[kind] << ", " << At(form, i) << At(m);
        }
      }
    }
  }
}

TEST(Jacobian, PriorResidualsPassGradientChecker) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(137, i);
    const MotionPrior prior = FullPrior(&random);
    for (const PriorKind kind : kPriorKinds) {
      for (const Form& form : kForms) {
        // Where |t| stays, the weak length is a constant: its row is rounding against rounding.
        const bool stays = form.translation.holds_length && !form.translation.depths;
        const PriorResiduals residuals(prior, RandomParts(kind, stays ? 1 : 3, &random),
                                       p.start.pose);
        const MotionParameterization chart = MakeChart(form, p.start);
        const Parameters x = RandomParameters(form, i, false, &random);
        EXPECT_TRUE(Probe(PriorOnChart(chart, residuals), {x.data()}, &random))
            << "kind " << static_cast<int>(kind) << ", " << At(form, i);
      }
    }
  }
}

TEST(Jacobian, ReprojectionCostPassesGradientChecker) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(138, i);
    for (const Form& form : kForms) {
      const MotionParameterization chart = MakeChart(form, p.start);
      const Parameters x = RandomParameters(form, i, false, &random);
      const Motion<double> motion = ChartTwin(form, p.start)(x.data());
      for (const Match& m : {p.matches[i % 3 * 4], p.matches[1 + i % 3]}) {
        Vector3<double> point;
        if (!RandomImage(p.rig, motion, m, &random, &point)) continue;
        EXPECT_TRUE(
            Probe(ReprojectionOnChart(chart, p.rig, m, 0.7), {x.data(), point.data()}, &random))
            << At(form, i) << At(m);
      }
    }
  }
}

}  // namespace
}  // namespace rigel
