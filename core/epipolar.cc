#include "rigel/core/epipolar.h"

#include <cmath>
#include <limits>

#include "rigel/core/sampson_terms.h"

namespace rigel {

double GecTripleProduct(const Pose& pose, const RayPair& rays) {
  const Eigen::Vector3d b = Baseline(pose, rays.ray1.s, rays.ray2.s);
  return rays.ray2.x.dot(b.cross(pose.R * rays.ray1.x));
}

double GecPluecker(const Pose& pose, const RayPair& rays) {
  const Eigen::Vector3d& x_i = rays.ray1.x;
  const Eigen::Vector3d& x_j = rays.ray2.x;
  return x_j.dot(pose.R * rays.ray1.Moment()) + rays.ray2.Moment().dot(pose.R * x_i) +
         x_j.dot(pose.t.cross(pose.R * x_i));
}

Eigen::Vector3d TranslationFromDepths(const Eigen::Matrix3d& R, const RayPair& reference, double l1,
                                      double l2) {
  return reference.ray2.Foot() + l2 * reference.ray2.x -
         R * (reference.ray1.Foot() + l1 * reference.ray1.x);
}

Eigen::Vector3d GecDepthCoefficients(const Eigen::Matrix3d& R, const RayPair& reference,
                                     const RayPair& rays) {
  const Eigen::Vector3d& x_i = rays.ray1.x;
  const Eigen::Vector3d& x_j = rays.ray2.x;
  const Eigen::Vector3d Rx_i = R * x_i;
  const Eigen::Vector3d m1 = reference.ray1.Foot();
  const Eigen::Vector3d m2 = reference.ray2.Foot();
  return {-x_j.dot(R * reference.ray1.x.cross(x_i)), x_j.dot(reference.ray2.x.cross(Rx_i)),
          x_j.dot(R * rays.ray1.Moment()) + Rx_i.dot(rays.ray2.Moment()) + x_j.dot(m2.cross(Rx_i)) -
              x_j.dot(R * m1.cross(x_i))};
}

Eigen::Matrix3d EssentialMatrix(const Pose& pose, const RigCamera& camera_i,
                                const RigCamera& camera_j) {
  const Eigen::Vector3d b = Baseline(pose, camera_i.s, camera_j.s);
  return camera_j.Q.transpose() * Skew(b) * pose.R * camera_i.Q;
}

Eigen::Matrix3d EssentialMatrixFromDepths(const Eigen::Matrix3d& R, const RayPair& reference,
                                          double l1, double l2, const RigCamera& camera_i,
                                          const RigCamera& camera_j) {
  const Ray& ray1 = reference.ray1;
  const Ray& ray2 = reference.ray2;
  const Eigen::Matrix3d E = -l1 * R * Skew(ray1.x) + l2 * Skew(ray2.x) * R +
                            R * Skew(camera_i.s - ray1.Foot()) + Skew(ray2.Foot() - camera_j.s) * R;
  return camera_j.Q.transpose() * E * camera_i.Q;
}

double SampsonError(const Eigen::Matrix3d& F, const Eigen::Vector3d& p_i,
                    const Eigen::Vector3d& p_j) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = F;
  const SampsonTerms terms = TermsOf(rows.data(), p_i.x(), p_i.y(), p_j.x(), p_j.y());
  if (terms.gradient2 > 0) return terms.C / std::sqrt(terms.gradient2);
  return F.isZero(0) || terms.C != 0 ? std::numeric_limits<double>::infinity() : 0.0;
}

double SampsonError(const Eigen::Matrix3d& F, const RowPoint& i, const RowPoint& j) {
  const Eigen::Vector3d Fp = F * i.p;
  const double gradient2 = (j.J.transpose() * Fp).squaredNorm() +
                           (i.J.transpose() * (F.transpose() * j.p)).squaredNorm();
  const double C = j.p.dot(Fp);
  if (gradient2 > 0) return C / std::sqrt(gradient2);
  return F.isZero(0) || C != 0 ? std::numeric_limits<double>::infinity() : 0.0;
}

double SampsonError(const Pose& pose, const Rig& rig, const Match& match) {
  const RigCamera& camera_i = rig.cameras[match.camera1];
  const RigCamera& camera_j = rig.cameras[match.camera2];
  const Eigen::Matrix3d F = Unprojection(camera_j).transpose() *
                            EssentialMatrix(pose, camera_i, camera_j) * Unprojection(camera_i);
  return SampsonError(F, RowPointOf(camera_i, match.pixel1), RowPointOf(camera_j, match.pixel2));
}

}  // namespace rigel
