// The turns of cameras that matches determine, of all those that a RigScore has.
#ifndef RIGEL_REFINE_DETERMINED_TURNS_H_
#define RIGEL_REFINE_DETERMINED_TURNS_H_

#include <Eigen/Core>

#include "rigel/refine/rig_doubts.h"

namespace rigel {

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

// x' V^-1 x.
double Chi2(const Eigen::VectorXd& x, const Eigen::MatrixXd& V);

// The mean ratio of two variances of a score over the turns that are determined; 1 if there is
// none.
double MeanRatio(const DeterminedTurns& turns, const Eigen::MatrixXd& measured,
                 const Eigen::MatrixXd& model);

}  // namespace rigel

#endif  // RIGEL_REFINE_DETERMINED_TURNS_H_
