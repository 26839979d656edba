#include "rigel/refine/rig_score.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rigel/core/angles.h"
#include "rigel/core/median.h"
#include "rigel/core/statistics.h"

namespace rigel {
namespace {

// The directions of turns that the matches determine, with their information.
struct Determined {
  explicit Determined(const Eigen::MatrixXd& information) {
    const double least = 1.0 / std::pow(DegToRad(kMaxTurnSigmaDeg), 2);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
    const long size = information.rows();
    long count = 0;
    while (count < size && eigen.eigenvalues()(size - 1 - count) > least) ++count;
    directions = eigen.eigenvectors().rightCols(count);
    to_turn = directions * eigen.eigenvalues().tail(count).cwiseInverse().asDiagonal();
  }
  Eigen::MatrixXd directions;
  Eigen::MatrixXd to_turn;  // times the negative gradient along the directions: the turns
};

double Chi2(const Eigen::VectorXd& value, const Eigen::MatrixXd& variance) {
  return value.dot(variance.ldlt().solve(value));
}

CameraTurn TurnOf(int camera, const Eigen::VectorXd& turns, const Eigen::MatrixXd& covariance,
                  const Determined& determined) {
  constexpr double kNearlyAll = 0.9;  // of a turn about an axis lies along the directions
  CameraTurn turn;
  turn.camera = camera;
  std::vector<int> known;
  for (int axis = 0; axis < 3; ++axis) {
    const int k = 3 * (camera - 1) + axis;
    if (!(determined.directions.row(k).squaredNorm() > kNearlyAll)) continue;
    turn.turn[axis] = turns(k);
    turn.sigma[axis] = std::sqrt(covariance(k, k));
    known.push_back(k);
  }
  const long size = static_cast<long>(known.size());
  Eigen::VectorXd value(size);
  Eigen::MatrixXd variance(size, size);
  for (long i = 0; i < size; ++i) {
    value(i) = turns(known[i]);
    for (long j = 0; j < size; ++j) variance(i, j) = covariance(known[i], known[j]);
  }
  if (size > 0) turn.p = ChiSquaredTail(Chi2(value, variance), static_cast<int>(size));
  return turn;
}

// Sums over the pairs with their weights.
RigScore WeightedSum(const std::vector<const RigScore*>& pairs, const std::vector<double>& weights) {
  RigScore sum = *pairs[0];
  sum.gradient.setZero();
  sum.information.setZero();
  sum.variance.setZero();
  sum.by_calibration.setZero();
  for (size_t k = 0; k < pairs.size(); ++k) {
    sum.gradient += weights[k] * pairs[k]->gradient;
    sum.information += weights[k] * pairs[k]->information;
    sum.variance += weights[k] * weights[k] * pairs[k]->variance;
    sum.by_calibration += weights[k] * pairs[k]->by_calibration;
  }
  sum.num_pairs = static_cast<int>(pairs.size());
  return sum;
}

// Of each pair: what is left of its gradient at the turns of the run, and how much more that is
// than its variance says, in the mean over the turns.
struct Rest {
  Eigen::VectorXd gradient;
  double ratio = 0.0;
};

std::vector<Rest> RestsOf(const std::vector<const RigScore*>& pairs, const RigScore& run) {
  const Determined determined(run.information);
  const Eigen::VectorXd turns =
      -determined.to_turn * (determined.directions.transpose() * run.gradient);
  std::vector<Rest> rests;
  for (const RigScore* pair : pairs) {
    Rest rest;
    rest.gradient = pair->gradient + pair->information * turns;
    const Determined own(pair->information);
    if (own.directions.cols() > 0) {
      rest.ratio = Chi2(own.directions.transpose() * rest.gradient,
                        own.directions.transpose() * pair->variance * own.directions) /
                   static_cast<double>(own.directions.cols());
    }
    rests.push_back(std::move(rest));
  }
  return rests;
}

// Pairs with far larger rests than the others count less.
std::vector<double> WeightsOf(const std::vector<Rest>& rests) {
  constexpr double kLimit = 9.0;  // times the median
  std::vector<double> ratios;
  for (const Rest& rest : rests) ratios.push_back(rest.ratio);
  const double limit = kLimit * std::max(1.0, MedianInPlace(&ratios));
  std::vector<double> weights;
  for (const Rest& rest : rests) weights.push_back(std::sqrt(limit / std::max(limit, rest.ratio)));
  return weights;
}

}  // namespace

RigTest TestRig(const RigScore& score) {
  RigTest test;
  test.num_pairs = score.num_pairs;
  if (score.empty()) return test;
  const Determined determined(score.information);
  const Eigen::MatrixXd& along = determined.directions;
  test.degrees_of_freedom = static_cast<int>(along.cols());
  if (along.cols() == 0) return test;
  const Eigen::VectorXd gradient = along.transpose() * score.gradient;
  const Eigen::MatrixXd variance = along.transpose() * score.variance * along;
  test.chi2 = Chi2(gradient, variance);
  test.p = ChiSquaredTail(test.chi2, test.degrees_of_freedom);
  if (score.by_calibration.cols() > 0) {
    const Eigen::MatrixXd stated = along.transpose() * score.by_calibration;
    test.p_with_calibration = ChiSquaredTail(
        Chi2(gradient, variance + stated * stated.transpose()), test.degrees_of_freedom);
  }
  const Eigen::VectorXd turns = -determined.to_turn * gradient;
  const Eigen::MatrixXd covariance =
      determined.to_turn * variance * determined.to_turn.transpose();
  for (int camera = 1; camera <= score.gradient.size() / 3; ++camera) {
    CameraTurn turn = TurnOf(camera, turns, covariance, determined);
    const bool any = std::any_of(turn.turn.begin(), turn.turn.end(),
                                 [](const std::optional<double>& t) { return t.has_value(); });
    if (any) test.cameras.push_back(turn);
  }
  return test;
}

Eigen::MatrixXd BlendedVariance(const RigScore& score, const Eigen::MatrixXd& measured,
                                double share) {
  const Determined determined(score.information);
  const Eigen::MatrixXd& along = determined.directions;
  if (along.cols() == 0) return score.variance;
  const Eigen::MatrixXd model = along.transpose() * score.variance * along;
  const Eigen::MatrixXd ratios =
      model.ldlt().solve(Eigen::MatrixXd(along.transpose() * measured * along));
  const double q = ratios.trace() / static_cast<double>(along.cols());
  if (!std::isfinite(q) || !(q > 0)) return score.variance;
  return (1.0 - share + 0.5 * share * q) * score.variance + 0.5 * share * measured;
}

RigScore ScoreOfRun(const std::vector<RigScore>& scores) {
  constexpr int kRounds = 5;
  std::vector<const RigScore*> pairs;
  for (const RigScore& score : scores) {
    if (!score.empty()) pairs.push_back(&score);
  }
  if (pairs.empty()) return {};
  std::vector<double> weights(pairs.size(), 1.0);
  RigScore run = WeightedSum(pairs, weights);
  if (pairs.size() < 2) return run;
  std::vector<Rest> rests;
  for (int round = 0; round < kRounds; ++round) {
    rests = RestsOf(pairs, run);
    weights = WeightsOf(rests);
    run = WeightedSum(pairs, weights);
  }
  const int lags = getenv("LAGS") ? atoi(getenv("LAGS")) : 2;
  Eigen::MatrixXd measured = Eigen::MatrixXd::Zero(run.gradient.size(), run.gradient.size());
  for (size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::VectorXd a = weights[k] * rests[k].gradient;
    measured += a * a.transpose();
    for (int lag = 1; lag <= lags && lag <= static_cast<int>(k); ++lag) {
      const Eigen::VectorXd b = weights[k - lag] * rests[k - lag].gradient;
      const double w = 1.0 - lag / (lags + 1.0);
      measured += w * (a * b.transpose() + b * a.transpose());
    }
  }
  measured *= static_cast<double>(pairs.size()) / static_cast<double>(pairs.size() - 1);
  run.variance = BlendedVariance(run, measured, 1.0);
  return run;
}

}  // namespace rigel
