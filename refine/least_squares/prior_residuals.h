// A motion prior as residuals in units of its sigma.
//
//   gravity   the two components of R g1 perpendicular to g2, over sqrt(2) sigma, since both
//             directions are measured
//   axis      the two components of R n - n perpendicular to n, over 2 sin(a/2) sigma. An error of
//             n by a small angle changes R n - n by 2 sin(a/2) times that angle, a the angle of
//             rotation (at most 3). Below kMinAxisAngle an axis is not measurable; a is then
//             kMinAxisAngle.
//   normal    the same for R n - n, and the component of t along n over |t| sigma
//   distance  (|t| - D) / sigma, D for example from wheel odometry
//   length    log(|b| / L) / kLengthSigma: a weak prior of what the matches do not say
// A part without a sigma gives no residual. Motions are of a point c of the body: b is its motion,
// and t = b + c - R c that of the body's origin.
#ifndef RIGEL_REFINE_LEAST_SQUARES_PRIOR_RESIDUALS_H_
#define RIGEL_REFINE_LEAST_SQUARES_PRIOR_RESIDUALS_H_

#include <array>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"
#include "rigel/core/pose.h"
#include "rigel/core/prior.h"

namespace rigel {

inline constexpr double kMinAxisAngle = 1e-3;  // radians
inline constexpr int kMaxPriorResiduals = 5;
// Standard deviation of log |b| about the typical length: a factor of e either way.
inline constexpr double kLengthSigma = 1.0;

// Which parts become residuals.
struct PriorParts {
  PriorKind direction = PriorKind::kNone;  // gravity, axis or normal
  bool distance = false;
  double typical_length = 0.0;              // L, metres; 0: no such residual
  std::array<double, 3> point = {0, 0, 0};  // c, metres in the body frame
};

class PriorResiduals {
 public:
  using Residuals =
      Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::DontAlign, kMaxPriorResiduals, 1>;
  using Jacobian =
      Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::DontAlign, kMaxPriorResiduals, 6>;

  PriorResiduals() = default;
  // The weights of axis and normal depend on the angle and |t| of `start` and stay fixed.
  PriorResiduals(const MotionPrior& prior, const PriorParts& parts, const Pose& start);

  int size() const { return size_; }

  // Residuals at `pose`, and their derivative by the perturbation R <- Exp(d) R, t <- t + e, if
  // `jacobian` is not null.
  void Evaluate(const Pose& pose, Residuals* residuals, Jacobian* jacobian) const;

 private:
  void SetDirection(const MotionPrior& prior, PriorKind kind, const Pose& start);

  int size_ = 0;
  int num_direction_ = 0;
  bool with_normal_ = false;
  bool with_distance_ = false;
  double distance_ = 0.0;
  double distance_weight_ = 0.0;
  double typical_length_ = 0.0;
  Eigen::Vector3d point_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d from_ = Eigen::Vector3d::Zero();  // R from_ = to_
  Eigen::Vector3d to_ = Eigen::Vector3d::Zero();
  Matrix3x2d across_ = Matrix3x2d::Zero();
  double weight_ = 0.0;
  double translation_weight_ = 0.0;
};

}  // namespace rigel

#endif  // RIGEL_REFINE_LEAST_SQUARES_PRIOR_RESIDUALS_H_
