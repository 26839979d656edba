// The sums of the kernel against residuals and Jacobians match by match, and its paths against one
// another.
#include "rigel/refine/least_squares/sampson_kernel.h"

#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/refine/least_squares/epipolar_residuals.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/normal_equations.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr LossKind kLosses[] = {LossKind::kNone, LossKind::kHuber, LossKind::kCauchy,
                                LossKind::kTukey, LossKind::kTruncated};

struct Problem {
  FramePair pair;
  GroupedMatches matches;
  Pose pose;
  std::vector<double> weights;
};

// Residuals from well below to well above the scale of the loss, some matches left out.
Problem MakeProblem(int index, int num_matches) {
  SceneOptions options;
  options.num_matches = num_matches;
  options.inter_share = 0.5;
  options.outlier_share = 0.2;
  FramePair pair = ScenePair(options, index);
  Random random = Random::Stream(11, index);
  const Pose pose = StartNear(*pair.truth, 0.1, 0.05, &random);
  GroupedMatches matches(pair.rig, pair.matches);
  std::vector<double> weights(matches.size());
  for (double& w : weights) w = random.Uniform() < 0.2 ? 0.0 : random.Uniform();
  return {std::move(pair), std::move(matches), pose, std::move(weights)};
}

struct Expected {
  double cost = 0.0;
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  Matrix6d curvature = Matrix6d::Zero();
};

// By the loss functions of Ceres.
Expected SumOneByOne(const Problem& problem, const SampsonKernelOptions& options) {
  const EpipolarResiduals residuals(problem.matches, ResidualKind::kSampson);
  const MotionBasis basis = FullBasis(problem.pose, true);
  std::vector<GroupLinearization> groups;
  residuals.Linearize(problem.pose, &basis, &groups);
  const auto loss = MakeLoss(options.loss, options.loss_scale);
  Expected sum;
  for (int k = 0; k < residuals.size(); ++k) {
    Eigen::Matrix<double, 6, 1> j;
    const double w = problem.weights[k];
    const double e = w * residuals.Evaluate(groups, k, 6, j.data());
    j *= w;
    const double s = e * e;
    double rho[3] = {s, 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(s, rho);
    sum.cost += 0.5 * rho[0];
    sum.gradient += rho[1] * e * j;
    const double newton = rho[1] + 2.0 * s * rho[2];
    const bool take = newton > rho[1] / 3.0;
    sum.curvature += (take ? newton : rho[1]) * j * j.transpose();
  }
  return sum;
}

Expected SumByKernel(const Problem& problem, const SampsonKernelOptions& options, CpuPath path) {
  const MotionBasis basis = FullBasis(problem.pose, true);
  std::vector<GroupLinearization> groups;
  LinearizeGroups(problem.matches, ResidualKind::kSampson, problem.pose, &basis, &groups);
  Expected sum;
  for (size_t g = 0; g < groups.size(); ++g) {
    const MatchGroup& group = problem.matches.groups()[g];
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F = groups[g].F;
    SampsonSums sums, cost_only;
    const PixelArrays pixels = problem.matches.Pixels(group);
    const double* weights = problem.weights.data() + group.begin;
    SumSampson(options, pixels, weights, F.data(), groups[g].rounding2, SampsonParts::kAll, &sums,
               path);
    SumSampson(options, pixels, weights, F.data(), groups[g].rounding2, SampsonParts::kCost,
               &cost_only, path);
    EXPECT_EQ(sums.cost, cost_only.cost);
    Eigen::Matrix<double, 9, 6> D;
    for (int m = 0; m < 6; ++m) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(D.col(m).data()) = groups[g].dF[m];
    }
    sum.cost += sums.cost;
    sum.gradient += D.transpose() * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(sums.g);
    sum.curvature += D.transpose() * Eigen::Map<const Eigen::Matrix<double, 9, 9>>(sums.H) * D;
  }
  return sum;
}

Expected SumByMotion(const Problem& problem, const SampsonKernelOptions& options) {
  MotionNormalEquations sum;
  for (const MatchGroup& group : problem.matches.groups()) {
    AddNormalEquations(options, problem.matches, group, problem.matches.Pixels(group),
                       problem.weights.data() + group.begin, problem.pose, SampsonParts::kAll,
                       &sum);
  }
  return {sum.cost, sum.gradient, sum.curvature};
}

TEST(SampsonKernel, SumsTheResidualsAndJacobiansOfTheMatches) {
  for (const LossKind loss : kLosses) {
    {
      for (int index = 0; index < 20; ++index) {
        SCOPED_TRACE(std::string(LossName(loss)) + ", problem " + std::to_string(index));
        const Problem problem = MakeProblem(index, 40 + 17 * index);
        SampsonKernelOptions options;
        options.loss = loss;
        options.loss_scale = 2.0;
        const Expected expected = SumOneByOne(problem, options);
        for (const Expected& sum :
             {SumByKernel(problem, options, BestCpuPath()), SumByMotion(problem, options)}) {
          EXPECT_NEAR(sum.cost, expected.cost, 1e-11 * expected.cost);
          const Eigen::Matrix<double, 6, 1> scale =
              expected.curvature.diagonal().cwiseSqrt().cwiseMax(1e-3);
          const auto unit = scale.cwiseInverse().eval();
          EXPECT_LT((sum.gradient - expected.gradient).cwiseProduct(unit).norm(), 1e-8);
          EXPECT_LT(
              (unit.asDiagonal() * (sum.curvature - expected.curvature) * unit.asDiagonal()).norm(),
              1e-8);
        }
      }
    }
  }
}

TEST(SampsonKernel, CostAndGradientAloneAreTheSame) {
  for (const LossKind loss : kLosses) {
    const Problem problem = MakeProblem(7, 200);
    const MatchGroup& group = problem.matches.groups()[0];
    SampsonKernelOptions options;
    options.loss = loss;
    const auto sum = [&](SampsonParts parts) {
      MotionNormalEquations equations;
      AddNormalEquations(options, problem.matches, group, problem.matches.Pixels(group),
                         problem.weights.data() + group.begin, problem.pose, parts, &equations);
      return equations;
    };
    const MotionNormalEquations all = sum(SampsonParts::kAll);
    const MotionNormalEquations gradient = sum(SampsonParts::kGradient);
    const MotionNormalEquations cost = sum(SampsonParts::kCost);
    EXPECT_GT(cost.cost, 0.0);
    EXPECT_EQ(cost.cost, all.cost);
    EXPECT_EQ(cost.cost, gradient.cost);
    EXPECT_EQ(cost.gradient.norm(), 0.0);
    EXPECT_GT(all.gradient.norm(), 0.0);
    EXPECT_LT((gradient.gradient - all.gradient).norm(), 1e-12 * all.gradient.norm());
    EXPECT_EQ(gradient.curvature.norm(), 0.0);
  }
}

TEST(SampsonKernel, LeveragesAreThoseOfTheJacobians) {
  const Problem problem = MakeProblem(3, 300);
  const GroupedMatches& matches = problem.matches;
  const Matrix6d information = SampsonInformation(matches, problem.weights, problem.pose);
  const Matrix6d covariance = information.inverse();
  std::vector<double> leverages(matches.size());
  double sum = 0.0;
  for (const MatchGroup& group : matches.groups()) {
    Leverages(matches, group, problem.pose, problem.weights.data() + group.begin, covariance,
              leverages.data() + group.begin);
  }
  const EpipolarResiduals residuals(matches, ResidualKind::kSampson);
  const MotionBasis basis = FullBasis(problem.pose, true);
  std::vector<GroupLinearization> groups;
  residuals.Linearize(problem.pose, &basis, &groups);
  for (int k = 0; k < matches.size(); ++k) {
    Eigen::Matrix<double, 6, 1> j;
    residuals.Evaluate(groups, k, 6, j.data());
    j *= problem.weights[k];
    EXPECT_NEAR(leverages[k], j.dot(covariance * j), 1e-9);
    sum += leverages[k];
  }
  // The trace of a projection onto the six parameters.
  EXPECT_NEAR(sum, 6.0, 1e-8);
}

// Any size, so that the last block is of every length.
TEST(SampsonKernel, EveryPathGivesTheSameBits) {
  if (BestCpuPath() == CpuPath::kBaseline) GTEST_SKIP() << "this machine has one path";
  for (const LossKind loss : kLosses) {
    for (int size = 0; size < 140; ++size) {
      const Problem problem = MakeProblem(size, 200);
      const MatchGroup& group = problem.matches.groups()[0];
      PixelArrays pixels = problem.matches.Pixels(group);
      pixels.size = std::min(size, pixels.size);
      const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> F =
          problem.matches.Fundamental(group, problem.pose);
      SampsonKernelOptions options;
      options.loss = loss;
      SampsonSums baseline{}, avx2{};
      SumSampson(options, pixels, problem.weights.data(), F.data(), 1e-20, SampsonParts::kAll,
                 &baseline, CpuPath::kBaseline);
      SumSampson(options, pixels, problem.weights.data(), F.data(), 1e-20, SampsonParts::kAll,
                 &avx2, CpuPath::kAvx2);
      EXPECT_EQ(std::memcmp(&baseline, &avx2, sizeof(baseline)), 0);
      std::vector<double> a(pixels.size), b(pixels.size);
      GradientWeights(pixels, F.data(), 1e-3, a.data(), CpuPath::kBaseline);
      GradientWeights(pixels, F.data(), 1e-3, b.data(), CpuPath::kAvx2);
      EXPECT_EQ(a, b);
      SampsonLeverages(pixels, problem.weights.data(), F.data(), baseline.H, 1e-20, a.data(),
                       CpuPath::kBaseline);
      SampsonLeverages(pixels, problem.weights.data(), F.data(), baseline.H, 1e-20, b.data(),
                       CpuPath::kAvx2);
      EXPECT_EQ(a, b);
    }
  }
}

TEST(SampsonKernel, ProjectionGivesTheSameBitsOnEveryPath) {
  if (BestCpuPath() == CpuPath::kBaseline) GTEST_SKIP() << "this machine has one path";
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    SampsonSums sums;
    for (double& g : sums.g) g = random.Normal();
    for (double& h : sums.H) h = random.Normal();
    FundamentalDerivatives D{};
    for (auto& row : D.d) {
      for (int m = 0; m < 6; ++m) row[m] = random.Normal();
    }
    double baseline[42], avx2[42];
    for (int i = 0; i < 42; ++i) baseline[i] = avx2[i] = i;
    AddProjected(sums, D, baseline, baseline + 6, CpuPath::kBaseline);
    AddProjected(sums, D, avx2, avx2 + 6, CpuPath::kAvx2);
    EXPECT_EQ(std::memcmp(baseline, avx2, sizeof(avx2)), 0);
    EXPECT_NE(baseline[41], 41.0);
  }
}

TEST(SampsonKernel, AMatchAtAnEpipoleAddsNothing) {
  // F = [e]x with the epipole at the origin of both images.
  const double F[9] = {0, -1, 0, 1, 0, 0, 0, 0, 0};
  const double zero[kKernelPadding] = {}, one[1] = {1.0};
  const PixelArrays pixels{zero, zero, zero, zero, 1};
  SampsonSums sums;
  SumSampson(SampsonKernelOptions(), pixels, one, F, 1e-30, SampsonParts::kAll, &sums);
  EXPECT_EQ(sums.cost, 0.0);
  for (const double h : sums.H) EXPECT_EQ(h, 0.0);
  const double none[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  SumSampson(SampsonKernelOptions(), pixels, one, none, 0.0, SampsonParts::kAll, &sums);
  EXPECT_EQ(sums.cost, 0.0);
  for (const double g : sums.g) EXPECT_EQ(g, 0.0);
}

}  // namespace
}  // namespace rigel
