#include "rigel/refine/rig_doubts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rigel/core/angles.h"
#include "rigel/core/median.h"
#include "rigel/core/statistics.h"
#include "rigel/refine/rig_score_of_fit.h"

namespace rigel {
namespace {

// The turns that the matches determine, of all those that a score has.
class DeterminedTurns {
 public:
  explicit DeterminedTurns(const Eigen::MatrixXd& information);

  int size() const { return static_cast<int>(directions_.cols()); }
  // Orthonormal directions of turns.
  const Eigen::MatrixXd& directions() const { return directions_; }
  // Along the directions: the inverse of the information. Times the negative gradient: the turns.
  const Eigen::MatrixXd& covariance() const { return covariance_; }

  // Parts along the directions.
  Eigen::VectorXd Along(const Eigen::VectorXd& v) const { return directions_.transpose() * v; }
  Eigen::MatrixXd Within(const Eigen::MatrixXd& m) const {
    return directions_.transpose() * m * directions_;
  }

 private:
  Eigen::MatrixXd directions_, covariance_;
};

DeterminedTurns::DeterminedTurns(const Eigen::MatrixXd& information) {
  const double least = 1.0 / std::pow(DegToRad(kMaxTurnSigmaDeg), 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const Eigen::VectorXd& values = eigen.eigenvalues();  // ascending
  const long count = (values.array() > least).count();
  directions_ = eigen.eigenvectors().rightCols(count);
  covariance_ =
      directions_ * values.tail(count).cwiseInverse().asDiagonal() * directions_.transpose();
}

// x' V^-1 x.
double Chi2(const Eigen::VectorXd& x, const Eigen::MatrixXd& V) { return x.dot(V.ldlt().solve(x)); }

// The turns that a score asks for, with their covariances.
struct Turns {
  Eigen::VectorXd value;
  Eigen::MatrixXd by_noise, by_calibration;
};

Turns TurnsOf(const RigScore& score, const DeterminedTurns& determined) {
  const Eigen::MatrixXd& C = determined.covariance();
  Turns turns;
  turns.value = -C * score.gradient;
  turns.by_noise = C * score.variance * C;
  turns.by_calibration = std::pow(DegToRad(kUsualTurnDeg), 2) * determined.directions() *
                         determined.directions().transpose();
  if (score.by_calibration.cols() > 0) {
    const Eigen::MatrixXd stated = C * score.by_calibration;
    turns.by_calibration += stated * stated.transpose();
  }
  return turns;
}

// Rows and columns `k` of a matrix.
Eigen::MatrixXd Part(const Eigen::MatrixXd& matrix, const std::vector<int>& k) {
  const long size = static_cast<long>(k.size());
  Eigen::MatrixXd part(size, size);
  for (long i = 0; i < size; ++i) {
    for (long j = 0; j < size; ++j) part(i, j) = matrix(k[i], k[j]);
  }
  return part;
}

// Without values if none of its turns is determined.
CameraTurn TurnOfCamera(int camera, const Turns& turns, const DeterminedTurns& determined) {
  constexpr double kNearlyAll = 0.9;  // of the turn lies along the directions
  CameraTurn result;
  result.camera = camera;
  std::vector<int> known;
  for (int axis = 0; axis < 3; ++axis) {
    const int k = 3 * (camera - 1) + axis;
    if (!(determined.directions().row(k).squaredNorm() > kNearlyAll)) continue;
    result.turn[axis] = turns.value(k);
    result.sigma[axis] = std::sqrt(turns.by_noise(k, k));
    known.push_back(k);
  }
  if (known.empty()) return result;
  const int size = static_cast<int>(known.size());
  Eigen::VectorXd value(size);
  for (int i = 0; i < size; ++i) value(i) = turns.value(known[i]);
  const Eigen::MatrixXd by_noise = Part(turns.by_noise, known);
  result.p = ChiSquaredTail(Chi2(value, by_noise), size);
  result.p_with_calibration =
      ChiSquaredTail(Chi2(value, by_noise + Part(turns.by_calibration, known)), size);
  return result;
}

// Whether two scores can be of one rig.
bool SameShape(const RigScore& a, const RigScore& b) {
  return a.gradient.size() == b.gradient.size() &&
         a.by_calibration.cols() == b.by_calibration.cols();
}

// Sums over the pairs with their weights.
RigScore WeightedSum(const std::vector<const RigScore*>& pairs,
                     const std::vector<double>& weights) {
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

// What is left of the gradient of each pair at the turns of the run.
std::vector<Eigen::VectorXd> RestsOf(const std::vector<const RigScore*>& pairs,
                                     const RigScore& run) {
  const Eigen::VectorXd turns = -DeterminedTurns(run.information).covariance() * run.gradient;
  std::vector<Eigen::VectorXd> rests;
  rests.reserve(pairs.size());
  for (const RigScore* pair : pairs) rests.emplace_back(pair->gradient + pair->information * turns);
  return rests;
}

// Pairs whose rests are far larger than those of the others, against their variance, count less.
std::vector<double> WeightsOf(const std::vector<const RigScore*>& pairs,
                              const std::vector<Eigen::VectorXd>& rests) {
  constexpr double kLimit = 9.0;  // times the median
  std::vector<double> ratios;
  ratios.reserve(pairs.size());
  for (size_t k = 0; k < pairs.size(); ++k) {
    ratios.push_back(MeanRatio(rests[k].cwiseAbs2(), pairs[k]->variance.diagonal()));
  }
  std::vector<double> sorted = ratios;
  const double limit = kLimit * std::max(1.0, MedianInPlace(&sorted));
  std::vector<double> weights;
  weights.reserve(ratios.size());
  for (const double ratio : ratios) weights.push_back(std::sqrt(limit / std::max(limit, ratio)));
  return weights;
}

// The variance of the sum of the rests, times their weights, by how they scatter (Newey and West, A
// simple, positive semi-definite, heteroskedasticity and autocorrelation consistent covariance
// matrix, 1987). Two pairs that follow each other share an image.
Eigen::MatrixXd MeasuredVariance(const std::vector<Eigen::VectorXd>& rests,
                                 const std::vector<double>& weights) {
  constexpr size_t kLags = 2;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rests[0].size(), rests[0].size());
  for (size_t k = 0; k < rests.size(); ++k) {
    const Eigen::VectorXd rest = weights[k] * rests[k];
    sum += rest * rest.transpose();
    for (size_t lag = 1; lag <= std::min(kLags, k); ++lag) {
      const Eigen::MatrixXd product = weights[k - lag] * rest * rests[k - lag].transpose();
      sum += (1.0 - lag / (kLags + 1.0)) * (product + product.transpose());
    }
  }
  // Less their mean, the rests scatter less.
  const double n = static_cast<double>(rests.size());
  return n / std::max(n - kLags - 1.0, 1.0) * sum;
}

}  // namespace

RigTest TestRig(const RigScore& score) {
  RigTest test;
  test.num_pairs = score.num_pairs;
  if (score.empty()) return test;
  const DeterminedTurns determined(score.information);
  if (determined.size() == 0) return test;
  const Turns turns = TurnsOf(score, determined);
  const Eigen::VectorXd along = determined.Along(turns.value);
  const Eigen::MatrixXd by_noise = determined.Within(turns.by_noise);
  const double chi2 = Chi2(along, by_noise);
  if (!std::isfinite(chi2)) return test;
  test.degrees_of_freedom = determined.size();
  test.chi2 = chi2;
  test.p = ChiSquaredTail(chi2, determined.size());
  test.p_with_calibration = ChiSquaredTail(
      Chi2(along, by_noise + determined.Within(turns.by_calibration)), determined.size());
  for (int camera = 1; camera <= score.gradient.size() / 3; ++camera) {
    const CameraTurn turn = TurnOfCamera(camera, turns, determined);
    const bool any = turn.turn[0] || turn.turn[1] || turn.turn[2];
    if (any) test.cameras.push_back(turn);
  }
  return test;
}

RigScore ScoreOfRun(const std::vector<RigScore>& scores) {
  constexpr int kRounds = 5;
  std::vector<const RigScore*> pairs;
  for (const RigScore& score : scores) {
    if (!score.empty() && (pairs.empty() || SameShape(score, *pairs[0]))) pairs.push_back(&score);
  }
  if (pairs.empty()) return {};
  std::vector<double> weights(pairs.size(), 1.0);
  RigScore run = WeightedSum(pairs, weights);
  if (pairs.size() < 2) return run;
  std::vector<Eigen::VectorXd> rests;
  for (int round = 0; round < kRounds; ++round) {
    rests = RestsOf(pairs, run);
    weights = WeightsOf(pairs, rests);
    run = WeightedSum(pairs, weights);
  }
  // Of the right size in the mean over the turns; few pairs may scatter too little by chance. Its
  // shape is that of the model where the pairs are few for the number of turns.
  constexpr double kPairsOfATurn = 5.0;
  const Eigen::MatrixXd measured = MeasuredVariance(rests, weights);
  const DeterminedTurns turns(run.information);
  const double q = std::max(1.0, MeanRatio(measured.diagonal(), run.variance.diagonal()));
  const double share = pairs.size() / (pairs.size() + kPairsOfATurn * turns.size());
  run.variance = (1.0 - 0.5 * share) * q * run.variance + 0.5 * share * measured;
  return run;
}

}  // namespace rigel
