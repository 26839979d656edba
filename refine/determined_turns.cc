#include "rigel/refine/determined_turns.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rigel/core/angles.h"

namespace rigel {

DeterminedTurns::DeterminedTurns(const Eigen::MatrixXd& information) {
  const double least = 1.0 / std::pow(DegToRad(kMaxTurnSigmaDeg), 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const Eigen::VectorXd& values = eigen.eigenvalues();  // ascending
  const long count = (values.array() > least).count();
  directions_ = eigen.eigenvectors().rightCols(count);
  covariance_ =
      directions_ * values.tail(count).cwiseInverse().asDiagonal() * directions_.transpose();
}

double Chi2(const Eigen::VectorXd& x, const Eigen::MatrixXd& V) { return x.dot(V.ldlt().solve(x)); }

double MeanRatio(const DeterminedTurns& turns, const Eigen::MatrixXd& measured,
                 const Eigen::MatrixXd& model) {
  if (turns.size() == 0) return 1.0;
  const Eigen::MatrixXd ratios = turns.Within(model).ldlt().solve(turns.Within(measured));
  const double q = ratios.trace() / turns.size();
  return std::isfinite(q) && q > 0 ? q : 1.0;
}

}  // namespace rigel
