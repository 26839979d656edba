// The sums of the kernel against residuals and Jacobians match by match, and its paths against one
// another.
#include "rigel/refine/least_squares/sampson_kernel.h"

#include <cmath>
#include <cstring>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
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

// Residuals from well below to well above the scale of the loss, some matches left out. Every
// second problem has pixels of different noise, whose rows are of the general form.
Problem MakeProblem(int index, int num_matches) {
  SceneOptions options;
  options.num_matches = num_matches;
  options.inter_share = 0.5;
  options.outlier_share = 0.2;
  FramePair pair = ScenePair(options, index);
  Random random = Random::Stream(11, index);
  const Pose pose = StartNear(*pair.truth, 0.1, 0.05, &random);
  MatchColumns columns;
  for (std::vector<double>* sigma : {&columns.sigma1, &columns.sigma2}) {
    sigma->resize(index % 2 == 0 ? 0 : pair.matches.size());
    for (double& s : *sigma) s = random.Uniform(0.5, 2.0);
  }
  GroupedMatches matches(pair.rig, pair.matches, columns);
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
    const RowArrays pixels = problem.matches.Rows(group);
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
    AddNormalEquations(options, problem.matches, group, problem.matches.Rows(group),
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
  for (int index = 0; index < 2 * static_cast<int>(std::size(kLosses)); ++index) {
    const LossKind loss = kLosses[index / 2];
    const Problem problem = MakeProblem(index, 200);
    const MatchGroup& group = problem.matches.groups()[0];
    SampsonKernelOptions options;
    options.loss = loss;
    const auto sum = [&](SampsonParts parts) {
      MotionNormalEquations equations;
      AddNormalEquations(options, problem.matches, group, problem.matches.Rows(group),
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
      SCOPED_TRACE(size);
      const Problem problem = MakeProblem(size, 200);
      const MatchGroup& group = problem.matches.groups()[0];
      RowArrays pixels = problem.matches.Rows(group);
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

// Points and derivatives of any kind: the sums against numeric derivatives by the entries of F.
TEST(SampsonKernel, TakesTheRowsOfAnyCamera) {
  Random random(6);
  constexpr int kSize = 37;
  constexpr size_t kStride = 48;
  std::vector<double> data((4 + kGeneralArrays) * kStride, 1.0);
  for (double& number : data) number = random.Normal();
  const double* x1 = data.data();
  const RowArrays rows = {x1,    x1 + kStride,     x1 + 2 * kStride, x1 + 3 * kStride,
                          kSize, x1 + 4 * kStride, kStride};
  const auto point = [&](int k, int side) {
    RowPoint p;
    const double* of_k = x1 + k;
    p.p = {of_k[2 * side * kStride], of_k[(2 * side + 1) * kStride], of_k[(4 + side) * kStride]};
    for (int i = 0; i < 6; ++i) p.J(i / 2, i % 2) = of_k[(6 + 6 * side + i) * kStride];
    return p;
  };
  using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  RowMajor3d F;
  for (int i = 0; i < 9; ++i) F.data()[i] = random.Normal();
  std::vector<double> weights(kSize), leverages(kSize), epipole(kSize), errors(kSize);
  for (double& w : weights) w = random.Uniform();
  SampsonKernelOptions options;
  options.loss = LossKind::kCauchy;
  SampsonSums sums;
  SumSampson(options, rows, weights.data(), F.data(), 1e-25, SampsonParts::kAll, &sums);
  Eigen::Matrix<double, 9, 9> C = Eigen::Matrix<double, 9, 9>::Zero();
  for (int i = 0; i < 9; ++i) C(i, i) = 1.0 + i;
  C(2, 5) = C(5, 2) = 0.5;
  SampsonLeverages(rows, weights.data(), F.data(), C.data(), 1e-25, leverages.data());
  GradientWeights(rows, F.data(), 0.1, epipole.data());
  SquaredSampsonErrors(rows, F.data(), errors.data());
  const auto loss = MakeLoss(options.loss, options.loss_scale);
  double cost = 0.0;
  Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
  Eigen::Matrix<double, 9, 9> H = Eigen::Matrix<double, 9, 9>::Zero();
  for (int k = 0; k < kSize; ++k) {
    const RowPoint p1 = point(k, 0), p2 = point(k, 1);
    const double r = SampsonError(F, p1, p2);
    EXPECT_NEAR(errors[k], r * r, 1e-12 * (1.0 + r * r));
    Eigen::Matrix<double, 9, 1> j;
    for (int i = 0; i < 9; ++i) {
      constexpr double kStep = 1e-6;
      RowMajor3d up = F, down = F;
      up.data()[i] += kStep;
      down.data()[i] -= kStep;
      j(i) = (SampsonError(up, p1, p2) - SampsonError(down, p1, p2)) / (2.0 * kStep);
    }
    const double w = weights[k];
    EXPECT_NEAR(leverages[k], w * w * j.dot(C * j), 1e-6 * (1.0 + j.squaredNorm()));
    const double gradient2 = (p2.J.transpose() * F * p1.p).squaredNorm() +
                             (p1.J.transpose() * F.transpose() * p2.p).squaredNorm();
    const double mixed2 = (p2.J.transpose() * F * p1.J).squaredNorm();
    EXPECT_NEAR(epipole[k], gradient2 / (gradient2 + 0.1 * mixed2), 1e-12);
    const double s = w * w * r * r;
    double rho[3];
    loss->Evaluate(s, rho);
    cost += 0.5 * rho[0];
    g += rho[1] * w * w * r * j;
    const double newton = rho[1] + 2.0 * s * rho[2];
    H += w * w * (newton > rho[1] / 3.0 ? newton : rho[1]) * j * j.transpose();
  }
  EXPECT_NEAR(sums.cost, cost, 1e-11 * cost);
  EXPECT_LT((Eigen::Map<Eigen::Matrix<double, 9, 1>>(sums.g) - g).norm(), 1e-6 * g.norm());
  EXPECT_LT((Eigen::Map<Eigen::Matrix<double, 9, 9>>(sums.H) - H).norm(), 1e-6 * H.norm());
}

TEST(SampsonKernel, AMatchAtAnEpipoleAddsNothing) {
  // F = [e]x with the epipole at the origin of both images.
  const double F[9] = {0, -1, 0, 1, 0, 0, 0, 0, 0};
  const double zero[kKernelPadding] = {}, one[1] = {1.0};
  const RowArrays pixels{zero, zero, zero, zero, 1};
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
