#include "rigel/refine/epipolar_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "rigel/core/row_point.h"

namespace rigel {
namespace {

// A sum below this share of its terms is rounding error: 1.4e-14.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

// X_to = R X_from + t, from two parameter blocks.
struct PoseBlocks {
  Eigen::Quaterniond q;  // normalized
  double norm = 0.0;     // of the block
  Eigen::Matrix3d R;
  Eigen::Vector3d t;

  bool Read(const double* quaternion, const double* translation, QuaternionOrder order) {
    const double* x = quaternion;
    q = order == QuaternionOrder::kCeres ? Eigen::Quaterniond(x[0], x[1], x[2], x[3])
                                         : Eigen::Quaterniond(x[3], x[0], x[1], x[2]);
    t = Eigen::Vector3d::Map(translation);
    const double norm2 = q.squaredNorm();
    if (!(norm2 >= std::numeric_limits<double>::min()) || !std::isfinite(norm2)) return false;
    norm = std::sqrt(norm2);
    q.coeffs() /= norm;
    R = q.toRotationMatrix();
    return t.allFinite();
  }

  // Converts the derivative by w in R <- Exp(w) R to that by the quaternion block. A step dq is the
  // rotation w = 2 vec(dq q*) / |q| of the normalized q; along q it is zero.
  void WriteQuaternionJacobian(const Eigen::Vector3d& by_w, QuaternionOrder order,
                               double* jacobian) const {
    const double scale = 2.0 / norm;
    const Eigen::Vector3d v = q.vec();
    const Eigen::Vector3d by_v = scale * (q.w() * by_w + by_w.cross(v));
    const bool w_first = order == QuaternionOrder::kCeres;
    jacobian[w_first ? 0 : 3] = -scale * v.dot(by_w);
    Eigen::Vector3d::Map(jacobian + (w_first ? 1 : 0)) = by_v;
  }
};

// Derivatives of the residual: by w in R <- Exp(w) R of a rotation, by e in t <- t + e.
struct Gradient {
  Eigen::Vector3d R, t;      // T_f2_f1
  Eigen::Vector3d Q_i, s_i;  // body_from_camera at time 1
  Eigen::Vector3d Q_j, s_j;  // and at time 2

  void SetZero() {
    for (Eigen::Vector3d* v : {&R, &t, &Q_i, &s_i, &Q_j, &s_j}) v->setZero();
  }
};

enum class MotionBlocks { kRelative, kAbsolute };
enum class ExtrinsicBlocks { kNone, kOne, kTwo };

class EpipolarCost final : public ceres::CostFunction {
 public:
  // The arguments have been checked.
  EpipolarCost(const RigCamera& camera_i, const RigCamera& camera_j, const Match& match,
               double sigma_px, QuaternionOrder order, MotionBlocks motion,
               ExtrinsicBlocks extrinsics)
      : motion_(motion),
        extrinsics_(extrinsics),
        order_(order),
        Q_i_(camera_i.Q),
        Q_j_(camera_j.Q),
        s_i_(camera_i.s),
        s_j_(camera_j.s),
        i_(RayPointOf(camera_i, match.pixel1)),
        j_(RayPointOf(camera_j, match.pixel2)),
        weight_(1.0 / sigma_px) {
    gradient2_rounding_ = kRounding * kRounding *
                          (i_.p.squaredNorm() * std::pow(j_.J.cwiseAbs().maxCoeff(), 2) +
                           j_.p.squaredNorm() * std::pow(i_.J.cwiseAbs().maxCoeff(), 2));
    int poses = motion == MotionBlocks::kRelative ? 1 : 2;
    if (extrinsics == ExtrinsicBlocks::kOne) poses += 1;
    if (extrinsics == ExtrinsicBlocks::kTwo) poses += 2;
    set_num_residuals(1);
    for (int k = 0; k < poses; ++k) {
      mutable_parameter_block_sizes()->push_back(4);
      mutable_parameter_block_sizes()->push_back(3);
    }
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    // T_f2_f1, alone or from the poses of both bodies.
    PoseBlocks pose1, pose2;
    Eigen::Matrix3d R;
    Eigen::Vector3d t;
    int block = 0;  // the first one after the motion
    if (!pose1.Read(x[0], x[1], order_)) return false;
    if (motion_ == MotionBlocks::kRelative) {
      R = pose1.R;
      t = pose1.t;
      block = 2;
    } else {
      if (!pose2.Read(x[2], x[3], order_)) return false;
      R = pose2.R.transpose() * pose1.R;
      t = pose2.R.transpose() * (pose1.t - pose2.t);
      block = 4;
    }

    PoseBlocks camera_i, camera_j;
    if (extrinsics_ != ExtrinsicBlocks::kNone) {
      if (!camera_i.Read(x[block], x[block + 1], order_)) return false;
      camera_j = camera_i;
      if (extrinsics_ == ExtrinsicBlocks::kTwo &&
          !camera_j.Read(x[block + 2], x[block + 3], order_)) {
        return false;
      }
    } else {
      camera_i.R = Q_i_;
      camera_i.t = s_i_;
      camera_j.R = Q_j_;
      camera_j.t = s_j_;
    }

    Gradient by;
    if (!Sampson(R, t, camera_i.R, camera_i.t, camera_j.R, camera_j.t, &residuals[0],
                 jacobians == nullptr ? nullptr : &by)) {
      return false;
    }
    if (jacobians == nullptr) return true;

    const auto write = [&](int k, const PoseBlocks& pose, const Eigen::Vector3d& by_w,
                           const Eigen::Vector3d& by_t) {
      if (jacobians[k] != nullptr) pose.WriteQuaternionJacobian(by_w, order_, jacobians[k]);
      if (jacobians[k + 1] != nullptr) Eigen::Vector3d::Map(jacobians[k + 1]) = by_t;
    };
    if (motion_ == MotionBlocks::kRelative) {
      write(0, pose1, by.R, by.t);
    } else {
      // Turning body 1 by w turns R by R_2'w and leaves t; turning body 2 turns R and t by -R_2'w.
      write(0, pose1, pose2.R * by.R, pose2.R * by.t);
      write(2, pose2, -(pose2.R * (by.R + t.cross(by.t))), -(pose2.R * by.t));
    }
    if (extrinsics_ == ExtrinsicBlocks::kOne) {
      write(block, camera_i, by.Q_i + by.Q_j, by.s_i + by.s_j);
    } else if (extrinsics_ == ExtrinsicBlocks::kTwo) {
      write(block, camera_i, by.Q_i, by.s_i);
      write(block + 2, camera_j, by.Q_j, by.s_j);
    }
    return true;
  }

 private:
  // The residual, and its gradient if `by` is not null. False at E = 0, where there is no residual.
  //
  // With y = R Q_i u_i and z = Q_j u_j, in f2, the constraint is C = z . (b x y) = u_j'E u_i. It is
  // divided by |g|, g = (g_i, g_j) its derivatives by the pixels. Since d|g|^2 / 2 = h_j'dE u_i +
  // u_j'dE h_i for h = J g, J = du/d(pixel),
  //   dr = (dC - C / |g|^2 (h_j'dE u_i + u_j'dE h_i)) / |g|
  // is the differential of two triple products z . (b x y) with constant camera vectors: of
  // (u_j - C / |g|^2 h_j, u_i) and of (-C / |g|^2 u_j, h_i).
  bool Sampson(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const Eigen::Matrix3d& Q_i,
               const Eigen::Vector3d& s_i, const Eigen::Matrix3d& Q_j, const Eigen::Vector3d& s_j,
               double* residual, Gradient* by) const {
    *residual = 0.0;
    if (by != nullptr) by->SetZero();
    const Eigen::Vector3d Rs = R * s_i;
    Eigen::Vector3d b = Rs + t - s_j;
    const double baseline = b.stableNorm();
    const double terms = s_i.stableNorm() + t.stableNorm() + s_j.stableNorm();
    if (!(baseline > kRounding * terms) || !(baseline >= std::numeric_limits<double>::min()) ||
        !std::isfinite(baseline)) {
      return false;
    }
    b /= baseline;  // which does not change the residual

    const Eigen::Matrix3d RQ_i = R * Q_i;
    const Eigen::Vector3d y = RQ_i * i_.p;
    const Eigen::Vector3d z = Q_j * j_.p;
    const Eigen::Vector3d b_y = b.cross(y);
    const Eigen::Vector2d g_i = i_.J.transpose() * (RQ_i.transpose() * z.cross(b));  // J'E'u_j
    const Eigen::Vector2d g_j = j_.J.transpose() * (Q_j.transpose() * b_y);          // J'E u_i
    const double gradient2 = g_i.squaredNorm() + g_j.squaredNorm();
    if (!(gradient2 > gradient2_rounding_) || !std::isfinite(gradient2)) return true;  // an epipole
    const double C = z.dot(b_y);
    const double weight = weight_ / std::sqrt(gradient2);
    *residual = weight * C;
    if (by == nullptr) return true;

    const Eigen::Vector3d h_i = i_.J * g_i;
    const Eigen::Vector3d h_j = j_.J * g_j;
    const double ratio = C / gradient2;
    const Eigen::Vector3d y_of[2] = {y, RQ_i * h_i};
    const Eigen::Vector3d z_of[2] = {weight * (z - ratio * (Q_j * h_j)), -weight * ratio * z};
    Eigen::Vector3d turn_i = Eigen::Vector3d::Zero();  // by w in y <- Exp(w) y
    for (int k = 0; k < 2; ++k) {
      by->t += y_of[k].cross(z_of[k]);
      turn_i += y_of[k].cross(z_of[k].cross(b));
      by->Q_j += z_of[k].cross(b.cross(y_of[k]));
    }
    by->t /= baseline;
    by->R = turn_i + Rs.cross(by->t);
    by->Q_i = R.transpose() * turn_i;
    by->s_i = R.transpose() * by->t;
    by->s_j = -by->t;
    return true;
  }

  const MotionBlocks motion_;
  const ExtrinsicBlocks extrinsics_;
  const QuaternionOrder order_;
  const Eigen::Matrix3d Q_i_, Q_j_;  // of the rig, where they are no parameters
  const Eigen::Vector3d s_i_, s_j_;
  const RowPoint i_, j_;       // along the rays
  const double weight_;        // 1 / sigma
  double gradient2_rounding_;  // |g|^2 of rounding errors, for |b| = 1
};

ceres::CostFunction* Make(const Rig& rig, const Match& match, double sigma_px,
                          QuaternionOrder order, MotionBlocks motion, bool with_extrinsics) {
  const auto in_rig = [&rig](int camera) { return camera >= 0 && camera < rig.size(); };
  std::string unused;
  // Beyond these a residual or its derivatives may overflow.
  constexpr double kMinSigmaPx = 1e-12, kMaxSigmaPx = 1e12;
  if (!(sigma_px >= kMinSigmaPx) || !(sigma_px <= kMaxSigmaPx) || !in_rig(match.camera1) ||
      !in_rig(match.camera2) || !match.pixel1.allFinite() || !match.pixel2.allFinite() ||
      !rig.IsValid(&unused) ||
      (order != QuaternionOrder::kCeres && order != QuaternionOrder::kEigen)) {
    return nullptr;
  }
  if (!RayPointOf(rig.cameras[match.camera1], match.pixel1).p.allFinite() ||
      !RayPointOf(rig.cameras[match.camera2], match.pixel2).p.allFinite()) {
    return nullptr;
  }
  const ExtrinsicBlocks extrinsics = !with_extrinsics  ? ExtrinsicBlocks::kNone
                                     : match.IsIntra() ? ExtrinsicBlocks::kOne
                                                       : ExtrinsicBlocks::kTwo;
  return new EpipolarCost(rig.cameras[match.camera1], rig.cameras[match.camera2], match, sigma_px,
                          order, motion, extrinsics);
}

}  // namespace

ceres::CostFunction* MakeRelativeEpipolarCost(const Rig& rig, const Match& match, double sigma_px,
                                              QuaternionOrder order) {
  return Make(rig, match, sigma_px, order, MotionBlocks::kRelative, false);
}

ceres::CostFunction* MakeAbsoluteEpipolarCost(const Rig& rig, const Match& match, double sigma_px,
                                              QuaternionOrder order) {
  return Make(rig, match, sigma_px, order, MotionBlocks::kAbsolute, false);
}

ceres::CostFunction* MakeRelativeEpipolarCostWithExtrinsics(const Rig& rig, const Match& match,
                                                            double sigma_px,
                                                            QuaternionOrder order) {
  return Make(rig, match, sigma_px, order, MotionBlocks::kRelative, true);
}

ceres::CostFunction* MakeAbsoluteEpipolarCostWithExtrinsics(const Rig& rig, const Match& match,
                                                            double sigma_px,
                                                            QuaternionOrder order) {
  return Make(rig, match, sigma_px, order, MotionBlocks::kAbsolute, true);
}

}  // namespace rigel
