#include "rigel/refine/standing.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "rigel/core/pose.h"
#include "rigel/core/rig_centre.h"
#include "rigel/refine/least_squares/loss.h"
#include "rigel/refine/least_squares/normal_equations.h"
#include "rigel/refine/least_squares/turn_row.h"

namespace rigel {
namespace {

// Matches of one camera within their gates, and what the others say.
class StandingFit {
 public:
  StandingFit(const GroupedMatches& matches, const Eigen::Vector3d& point, const Fit& fit,
              LossKind loss, double loss_scale_sigmas, double inverse_depth)
      : matches_(matches),
        fit_(fit),
        loss_(loss),
        scale_(loss_scale_sigmas),
        point_(point),
        inverse_depth_(inverse_depth),
        R_(fit.pose.R) {}

  const Eigen::Matrix3d& R() const { return R_; }

  // False if the matches do not determine the rotation.
  bool Minimize() {
    constexpr int kMaxIterations = 20;
    constexpr double kStep = 1e-10;  // radians
    for (int i = 0; i < kMaxIterations; ++i) {
      SetRows();
      Eigen::Matrix3d A = of_others_.curvature.topLeftCorner<3, 3>();
      Eigen::Vector3d g = of_others_.gradient.head<3>();
      for (const Entry& e : rows_) {
        A += e.weight * e.row.by_turn.transpose() * e.row.by_turn;
        g += e.weight * e.row.by_turn.transpose() * e.row.z;
      }
      const Eigen::Vector3d step = A.ldlt().solve(g);
      if (!step.allFinite()) return false;
      R_ = ExpSO3(-step) * R_;
      if (step.norm() < kStep) break;
    }
    SetRows();
    return true;
  }

  // Of the inliers of the full model, those of one camera that this one explains too.
  bool ExplainsInliers() const {
    constexpr double kShare = 0.8;  // some mismatches fit an epipolar line: a tenth [euroc_still]
    constexpr size_t kMinRows = 8;
    return rows_.size() >= kMinRows && rows_.size() >= kShare * num_candidates_;
  }

  // Takes what the points of single cameras move in common out of the rotation. False if that can
  // be seen: the rig does not stand.
  bool HeedShifts();
  Matrix6d Covariance(const std::vector<SharedPixel>& shared, double inverse_depth) const;
  void SetInliers(StandingMotion* motion) const;

 private:
  struct Entry {
    int k;  // grouped position
    int camera;
    double weight, slope;  // rho' and d rho' / d|z| / |z|
    TurnRow row;
  };
  // The equations of a camera's motion over the depth of its points.
  struct Shift {
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero(), by_turn = Eigen::Matrix3d::Zero();
    Eigen::Vector3d score = Eigen::Vector3d::Zero();

    Eigen::Matrix3d prior = Eigen::Matrix3d::Zero();  // covariance of the shift about zero

    // Its covariance with the matches.
    Eigen::Matrix3d Posterior() const {
      return (Eigen::Matrix3d::Identity() + prior * own).inverse() * prior;
    }
  };
  void SetRows();
  void SetShifts();
  double Chi2OfShifts(double* dof, double* trace) const;
  Eigen::Matrix3d OfTurnAlone() const;

  const GroupedMatches& matches_;
  const Fit& fit_;
  const LossKind loss_;
  const double scale_;
  const Eigen::Vector3d point_;  // from what the body turns about to the origin of the matches
  const double inverse_depth_;   // typical, of points
  Eigen::Matrix3d R_;
  std::vector<Entry> rows_;
  size_t num_candidates_ = 0;
  MotionNormalEquations of_others_;  // of matches between cameras, over sigma^2
  Eigen::Matrix3d of_turn_;          // the equations of the rotation without shifts
  std::vector<Shift> shifts_;        // of each camera
  double variance_ = 1.0;            // of the scores, over what the weights say
};

void StandingFit::SetRows() {
  constexpr double kStep = 1e-4;  // of |z|
  rows_.clear();
  num_candidates_ = 0;
  of_others_ = MotionNormalEquations();
  const Pose pose = MotionOfPoint({R_, Eigen::Vector3d::Zero()}, point_);
  for (size_t g = 0; g < matches_.groups().size(); ++g) {
    const MatchGroup& group = matches_.groups()[g];
    const double sigma = fit_.noise.sigma_of[g];
    if (group.camera1 != group.camera2) {
      AddRobustEquations(loss_, scale_, sigma, matches_, group, fit_.factors.data() + group.begin,
                         pose, SampsonParts::kAll, &of_others_);
      continue;
    }
    const Eigen::Matrix3d A = matches_.PlacesOf(group, pose, false).A1;
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (!fit_.inliers[k]) continue;
      ++num_candidates_;
      Entry e;
      if (!MakeTurnRow(A, matches_.Point1(k), matches_.Point2(k), R_, sigma, &e.row)) continue;
      const double size = e.row.z.norm();
      if (!(size * sigma < fit_.noise.gate_of[g])) continue;
      e.k = k;
      e.camera = group.camera1;
      e.weight = LossWeight(loss_, scale_, size);
      e.slope =
          size > 0 ? (LossWeight(loss_, scale_, size + kStep) - e.weight) / (kStep * size) : 0;
      rows_.push_back(e);
    }
  }
}

void StandingFit::SetShifts() {
  of_turn_ = of_others_.curvature.topLeftCorner<3, 3>();
  shifts_.assign(matches_.rig().size(), Shift());
  double weights = 0.0, squares = 0.0;
  for (const Entry& e : rows_) {
    Shift& shift = shifts_[e.camera];
    shift.own += e.weight * e.row.by_shift.transpose() * e.row.by_shift;
    shift.by_turn += e.weight * e.row.by_shift.transpose() * e.row.by_turn;
    shift.score += e.weight * e.row.by_shift.transpose() * e.row.z;
    of_turn_ += e.weight * e.row.by_turn.transpose() * e.row.by_turn;
    weights += e.weight;
    squares += e.weight * e.weight * e.row.z.squaredNorm() / 2.0;
  }
  variance_ = squares / weights;
}

// The score test of the shifts of all cameras, whatever the rotation, beyond their priors. *trace
// gets the sum of their information.
double StandingFit::Chi2OfShifts(double* dof, double* trace) const {
  constexpr double kNothing = 1e-6;  // of the largest eigenvalue: no information
  const long size = 3 * static_cast<long>(shifts_.size());
  Eigen::MatrixXd V = Eigen::MatrixXd::Zero(size, size), prior = V, by_turn(size, 3);
  Eigen::VectorXd score(size);
  for (size_t k = 0; k < shifts_.size(); ++k) {
    const long at = 3 * static_cast<long>(k);
    V.block<3, 3>(at, at) = shifts_[k].own;
    prior.block<3, 3>(at, at) = shifts_[k].prior;
    by_turn.middleRows<3>(at) = shifts_[k].by_turn;
    score.segment<3>(at) = shifts_[k].score;
  }
  V -= by_turn * of_turn_.ldlt().solve(by_turn.transpose());
  *trace = V.trace();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(V);
  const double least = kNothing * eigen.eigenvalues()(size - 1);
  const long rank = (eigen.eigenvalues().array() > least).count();
  *dof = static_cast<double>(rank);
  const auto U = eigen.eigenvectors().rightCols(rank);
  const Eigen::MatrixXd diagonal = eigen.eigenvalues().tail(rank).asDiagonal();
  const Eigen::VectorXd along = U.transpose() * score;
  const Eigen::MatrixXd expected = diagonal + diagonal * U.transpose() * prior * U * diagonal;
  return along.dot(expected.ldlt().solve(along)) / variance_;
}

bool StandingFit::HeedShifts() {
  constexpr double kChance = 5.0;  // standard deviations of chi2: no shift
  constexpr double kSeen = 0.3;    // of the noise, by which lenses and sub-pixel places move points
  SetShifts();
  // Cameras off the body's origin move where it turns.
  for (size_t k = 0; k < shifts_.size(); ++k) {
    const Eigen::Vector3d s = matches_.rig().cameras[k].s + point_;
    const Eigen::Vector3d moved = inverse_depth_ * (R_ * s - s);
    shifts_[k].prior = moved * moved.transpose() / variance_;
  }
  double dof, trace;
  const double chi2 = Chi2OfShifts(&dof, &trace);
  const double by_chance = dof + kChance * std::sqrt(2.0 * dof);
  if (!(chi2 < by_chance + kSeen * kSeen * rows_.size())) return false;
  // Shifts of random sizes: the variance that makes such a chi2.
  const double s2 = chi2 > by_chance ? (chi2 - dof) / trace : 0.0;
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (Shift& shift : shifts_) {
    shift.prior += s2 * Eigen::Matrix3d::Identity();
    g -= shift.by_turn.transpose() * shift.Posterior() * shift.score;
  }
  R_ = ExpSO3(-OfTurnAlone().ldlt().solve(g)) * R_;
  SetRows();
  return true;
}

// The information on the rotation that the shifts leave.
Eigen::Matrix3d StandingFit::OfTurnAlone() const {
  Eigen::Matrix3d left = of_turn_;
  for (const Shift& shift : shifts_) {
    left -= shift.by_turn.transpose() * shift.Posterior() * shift.by_turn;
  }
  return left;
}

Matrix6d StandingFit::Covariance(const std::vector<SharedPixel>& shared,
                                 double inverse_depth) const {
  const std::vector<int> set_of = LinkedSets(shared, matches_.size());
  std::vector<Eigen::Vector3d> scores(matches_.size(), Eigen::Vector3d::Zero());
  Eigen::Matrix3d A = of_others_.curvature.topLeftCorner<3, 3>();
  Eigen::Matrix3d weighted = A;
  Eigen::Matrix3d cross = of_others_.curvature.bottomLeftCorner<3, 3>();
  Eigen::Matrix3d of_shift = of_others_.curvature.bottomRightCorner<3, 3>();
  Eigen::Matrix3d model = Eigen::Matrix3d::Zero();
  for (const Entry& e : rows_) {
    const auto& J = e.row.by_turn;
    const Eigen::Vector3d score = J.transpose() * e.row.z;
    weighted += e.weight * J.transpose() * J;
    A += e.weight * J.transpose() * J + e.slope * score * score.transpose();
    model += (e.weight * e.weight * e.row.z.squaredNorm() / 2.0) * J.transpose() * J;
    scores[set_of[e.k]] += e.weight * score;
    const Eigen::Matrix<double, 2, 3> by_shift = inverse_depth * e.row.by_shift;
    cross += e.weight * by_shift.transpose() * J;
    of_shift += e.weight * by_shift.transpose() * by_shift;
  }
  Eigen::Matrix3d measured = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& score : scores) measured += score * score.transpose();
  // Matches that share a pixel, or noise that is alike near by, make the scatter larger.
  const double q = (model.ldlt().solve(measured)).trace() / 3.0;
  const Eigen::Matrix3d inverse = A.inverse();
  const Eigen::Matrix3d scatter = q * model + of_others_.curvature.topLeftCorner<3, 3>();
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() =
      inverse * scatter * inverse + variance_ * (OfTurnAlone().inverse() - of_turn_.inverse());
  covariance.bottomRightCorner<3, 3>() =
      q * (of_shift - cross * weighted.inverse() * cross.transpose()).inverse();
  return covariance;
}

void StandingFit::SetInliers(StandingMotion* motion) const {
  motion->inliers = fit_.inliers;
  for (const MatchGroup& group : matches_.groups()) {
    if (group.camera1 != group.camera2) continue;
    std::fill_n(motion->inliers.begin() + group.begin, group.size, 0);
  }
  for (const Entry& e : rows_) motion->inliers[e.k] = 1;
  motion->num_inliers =
      static_cast<int>(std::count(motion->inliers.begin(), motion->inliers.end(), 1));
}

}  // namespace

bool MayStand(const MotionPrior& prior) {
  constexpr double kSigmas = 3.0;
  return prior.distance.value_or(0.0) <= kStillMetres + kSigmas * prior.distance_sigma;
}

std::optional<StandingMotion> FitStanding(const GroupedMatches& matches,
                                          const std::vector<SharedPixel>& shared,
                                          const Eigen::Vector3d& point, const Fit& fit,
                                          LossKind loss, double loss_scale_sigmas,
                                          double typical_length) {
  const bool turns_about_origin = point.norm() <= kMaxPivot * typical_length;
  const Eigen::Vector3d arm = turns_about_origin ? point : Eigen::Vector3d::Zero();
  StandingFit standing(matches, arm, fit, loss, loss_scale_sigmas,
                       1.0 / (kNearDepth * typical_length));
  if (!standing.Minimize() || !standing.ExplainsInliers() || !standing.HeedShifts()) {
    return std::nullopt;
  }
  StandingMotion motion;
  motion.pose = MotionOfPoint({standing.R(), Eigen::Vector3d::Zero()}, arm);
  const Matrix6d to_point = BodyFromPointJacobian(standing.R(), -arm);
  motion.covariance = to_point *
                      standing.Covariance(shared, 1.0 / (kStandingDepth * typical_length)) *
                      to_point.transpose();
  if (!motion.covariance.allFinite()) return std::nullopt;
  standing.SetInliers(&motion);
  return motion;
}

}  // namespace rigel
