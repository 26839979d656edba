#include "rigel/refine/search/plane_twin.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/refine/search/noise_model.h"

namespace rigel {
namespace {

// A point at s + x / rho on the plane has n'(x + rho s) = rho. Both sides over the standard
// deviation of rho: the noise of the pixels over the baseline that the rays see.
struct PlaneRow {
  Eigen::Vector3d by_n;
  double value;
};

std::vector<PlaneRow> RowsOf(const GroupedMatches& matches, const Pose& pose, double noise_px,
                             Eigen::Vector3d* rays_sum) {
  constexpr double kAcross = 0.1;  // of |b|: nearer to the epipole depths are far from normal
  std::vector<PlaneRow> rows;
  std::vector<double> errors;
  std::vector<char> inliers;
  matches.SelectInliers(pose, kThresholdSigmas * noise_px, &errors, &inliers);
  rays_sum->setZero();
  for (const MatchGroup& group : matches.groups()) {
    const double noise = std::sqrt(2.0) * noise_px * matches.RadiansPerPixel(group);
    for (int k = group.begin; k < group.begin + group.size; ++k) {
      if (!inliers[k]) continue;
      const RayPair rays = matches.rays(k);
      const Eigen::Vector3d b = Baseline(pose, rays.ray1.s, rays.ray2.s);
      // The baseline across the second ray: the parallax is this times the inverse depth.
      const double across = b.cross(rays.ray2.x).norm();
      if (!(across > kAcross * b.norm())) continue;
      Depths depths;
      const double inverse =
          TriangulateDepths(pose, rays, &depths) && depths.d1 != 0 ? 1.0 / depths.d1 : 0.0;
      const double weight = across / noise;
      rows.push_back({weight * (rays.ray1.x + inverse * rays.ray1.s), weight * inverse});
      *rays_sum += rays.ray1.x;
    }
  }
  return rows;
}

// n, the normal over the distance of the plane on which nearly all points lie; or nothing.
std::optional<Eigen::Vector3d> FitPlane(const std::vector<PlaneRow>& rows) {
  constexpr size_t kMinPoints = 8;
  constexpr int kRounds = 10;
  constexpr double kNear = 2.0;    // standard deviations: of a plane 95 percent are nearer
  constexpr double kShare = 0.87;  // of the points: in deep scenes fewer are near
  constexpr int kDeepAfter = 3;    // rounds: the share of planes has grown beyond half by then
  if (rows.size() < kMinPoints) return std::nullopt;
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  size_t num_near = 0;
  for (int round = 0; round < kRounds; ++round) {
    // Cauchy's weights; in the first round all are alike.
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    num_near = 0;
    for (const PlaneRow& row : rows) {
      const double residual = row.by_n.dot(n) - row.value;
      const double weight = round == 0 ? 1.0 : 1.0 / (1.0 + residual * residual);
      A += weight * row.by_n * row.by_n.transpose();
      b += weight * row.value * row.by_n;
      num_near += std::abs(residual) < kNear ? 1 : 0;
    }
    if (round >= kDeepAfter && !(num_near >= 0.5 * rows.size())) return std::nullopt;
    n = A.ldlt().solve(b);
  }
  if (!n.allFinite() || !(num_near >= kShare * rows.size())) return std::nullopt;
  return n;
}

// The decomposition of H whose rotation is not R, with its plane on the side of `rays` and at the
// distance 1.
std::optional<Pose> OtherDecomposition(const Eigen::Matrix3d& H, const Eigen::Matrix3d& R,
                                       const Eigen::Vector3d& rays) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H.transpose() * H);
  // Of H = R + b n' the middle singular value is 1.
  const double low = 1.0 - eigen.eigenvalues()(0), high = eigen.eigenvalues()(2) - 1.0;
  if (!(low > 0) || !(high > 0)) return std::nullopt;
  const Eigen::Vector3d middle = eigen.eigenvectors().col(1);
  std::optional<Pose> other;
  double largest = 0.0;
  for (const double sign : {1.0, -1.0}) {
    // Directions in the plane whose length H keeps.
    const Eigen::Vector3d kept = (std::sqrt(high) * eigen.eigenvectors().col(0) +
                                  sign * std::sqrt(low) * eigen.eigenvectors().col(2)) /
                                 std::sqrt(low + high);
    Eigen::Matrix3d U, W;
    U << middle, kept, middle.cross(kept);
    const Eigen::Vector3d Hm = H * middle, Hk = H * kept;
    W << Hm, Hk, Hm.cross(Hk);
    Pose pose;
    pose.R = W * U.transpose();
    const Eigen::Vector3d normal = U.col(2).dot(rays) > 0 ? U.col(2) : Eigen::Vector3d(-U.col(2));
    pose.t = (H - pose.R) * normal;
    const double turn = (pose.R - R).norm();
    if (!(turn > largest) || !IsRotation(pose.R)) continue;
    largest = turn;
    other = pose;
  }
  return other;
}

}  // namespace

std::optional<Pose> PlaneTwin(const GroupedMatches& matches, const Pose& pose, double noise_px) {
  Eigen::Vector3d rays;
  const std::optional<Eigen::Vector3d> n = FitPlane(RowsOf(matches, pose, noise_px, &rays));
  if (!n.has_value()) return std::nullopt;
  std::optional<Pose> twin = OtherDecomposition(pose.R + pose.t * n->transpose(), pose.R, rays);
  // Of a plane at the same distance.
  if (twin.has_value()) twin->t /= n->norm();
  return twin;
}

}  // namespace rigel
