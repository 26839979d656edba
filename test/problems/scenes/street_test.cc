// The street: its surfaces, what its cameras see, its motion, its cars.
#include "rigel/problems/scenes/street.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rigel/core/angles.h"
#include "rigel/core/cheirality.h"
#include "rigel/core/epipolar.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/scenes/driven_motion.h"

namespace rigel {
namespace {

using testing::HasSubstr;

// Cameras of 65 degrees at equal angles, 1.7 m above the ground, on a body with x forward and z up.
StreetOptions Surround(int num_cameras) {
  StreetOptions options;
  options.axes.down = -Eigen::Vector3d::UnitZ();
  options.axes.forward = Eigen::Vector3d::UnitX();
  for (int k = 0; k < num_cameras; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(1000.0, 1000.0, 640.0, 480.0, 1280, 960);
    const Eigen::Matrix3d turn = ExpSO3(2.0 * kPi * k / num_cameras * Eigen::Vector3d::UnitZ());
    camera.Q << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // its axes in the body, looking ahead
    camera.Q = turn * camera.Q;
    camera.s = turn * Eigen::Vector3d(0.5, 0.0, 0.0) + Eigen::Vector3d(1.4, 0.0, 1.35);
    options.rig.cameras.push_back(camera);
  }
  return options;
}

FramePair Street(const StreetOptions& options, int index) {
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeStreetPair(options, index, &pair, &error)) << error;
  EXPECT_TRUE(pair.IsValid(&error)) << error;
  return pair;
}

// The point of a match by its exact pixels, in the body frame of time 1.
Eigen::Vector3d PointOf(const FramePair& pair, size_t k, Depths* depths) {
  Match match = pair.matches[k];
  const std::array<double, 4>& exact = pair.columns.exact[k];
  match.pixel1 = {exact[0], exact[1]};
  match.pixel2 = {exact[2], exact[3]};
  const RayPair rays = MakeRayPair(pair.rig, match);
  EXPECT_NEAR(GecTripleProduct(*pair.truth, rays), 0.0, 1e-11);
  EXPECT_TRUE(TriangulateDepths(*pair.truth, rays, depths));
  const RigCamera& camera = pair.rig.cameras[match.camera1];
  const Eigen::Vector3d ray = camera.Q * AlongRay(camera.intrinsics, match.pixel1);
  return camera.s + depths->d1 * ray.normalized();
}

TEST(Street, PointsAreOnItsSurfacesOrNearer) {
  StreetOptions options = Surround(6);
  options.num_matches = 2000;
  options.inter_share = 0.1;
  options.distance_m = 2.0;
  int ground = 0, facade = 0, far = 0, well_known = 0;
  for (int index = 0; index < 3; ++index) {
    const FramePair pair = Street(options, index);
    ASSERT_EQ(pair.columns.exact.size(), 2000u);
    double left = 0, right = 0;
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      const Match& m = pair.matches[k];
      const std::array<double, 4>& exact = pair.columns.exact[k];
      EXPECT_TRUE(pair.rig.cameras[m.camera1].intrinsics.InImage({exact[0], exact[1]}));
      EXPECT_TRUE(pair.rig.cameras[m.camera2].intrinsics.InImage({exact[2], exact[3]}));
      Depths depths;
      const Eigen::Vector3d X = PointOf(pair, k, &depths);
      if (!(depths.d1 < 100)) continue;  // near the epipole a depth has few digits
      ++well_known;
      EXPECT_TRUE(depths.BothPositive());
      EXPECT_GT(X.z(), -0.35 - 1e-3);
      if (X.z() < -0.35 + 1e-3) ++ground;
      if (X.z() < 11.65 && X.head<2>().norm() < 30) {
        left = std::max(left, X.y());
        right = std::max(right, -X.y());
      }
      far += depths.d1 > 30;
    }
    EXPECT_GT(left, 6.9);
    EXPECT_LT(left, 13.1);
    EXPECT_GT(right, 6.9);
    EXPECT_LT(right, 13.1);
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      Depths depths;
      const double y = PointOf(pair, k, &depths).y();
      facade += std::abs(y - left) < 1e-3 || std::abs(y + right) < 1e-3;
    }
  }
  EXPECT_GT(ground, well_known / 20);
  EXPECT_GT(facade, well_known / 10);
  EXPECT_GT(far, well_known / 50);
}

TEST(Street, AllCamerasHaveMatchesAndNeighboursShareThem) {
  StreetOptions options = Surround(6);
  options.num_matches = 1200;
  options.inter_share = 0.25;
  const FramePair pair = Street(options, 0);
  std::map<std::pair<int, int>, int> count;
  int num_inter = 0;
  for (const Match& m : pair.matches) {
    ++count[{m.camera1, m.camera2}];
    num_inter += !m.IsIntra();
    // 65 degrees each, 60 degrees apart.
    const int apart = (m.camera2 - m.camera1 + 6) % 6;
    EXPECT_TRUE(apart == 0 || apart == 1 || apart == 5) << m.camera1 << " " << m.camera2;
  }
  EXPECT_EQ(num_inter, 300);
  for (int k = 0; k < 6; ++k) EXPECT_GT((count[{k, k}]), 50) << k;
}

// Raw pixels, with rays beyond 90 degrees. The image is larger than the circle of the lens, whose
// last pixels have no ray.
TEST(Street, FisheyesSeeWhatTheirModelsSee) {
  StreetOptions options = Surround(4);
  options.outlier_share = 0.3;
  options.inter_share = 0.2;
  options.noise_px = 0.5;
  for (RigCamera& camera : options.rig.cameras) {
    // a - a^3 / 18 has its maximum at 140 degrees, 653 pixels from the centre.
    camera.intrinsics = {CameraModel::kOpencvFisheye, {400, 400, 640, 480, -1.0 / 18.0}, 1280, 960};
  }
  int num_beyond_90 = 0;
  for (int index = 0; index < 5; ++index) {
    const FramePair pair = Street(options, index);
    for (size_t k = 0; k < pair.matches.size(); ++k) {
      const Match& match = pair.matches[k];
      const std::array<double, 4>& exact = pair.columns.exact[k];
      const Eigen::Vector3d ray =
          AlongRay(options.rig.cameras[match.camera2].intrinsics, {exact[2], exact[3]});
      EXPECT_TRUE(ray.allFinite());  // of outliers, too
      if (pair.columns.inlier[k] == 0) continue;
      Match there = match;
      there.pixel1 = {exact[0], exact[1]};
      there.pixel2 = {exact[2], exact[3]};
      EXPECT_LT(std::abs(SampsonError(*pair.truth, pair.rig, there)), 1e-6);
      Depths depths;
      EXPECT_TRUE(TriangulateDepths(*pair.truth, MakeRayPair(pair.rig, there), &depths));
      EXPECT_TRUE(depths.BothPositive());
      EXPECT_TRUE(options.rig.cameras[0].intrinsics.InImage({exact[2], exact[3]}));
      num_beyond_90 += ray.z() < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_beyond_90, 0);
}

TEST(Street, MotionIsOnAnArcWithBumps) {
  StreetOptions options = Surround(2);
  options.num_matches = 5;
  options.rotation_deg = 5.0;
  options.distance_m = 1.5;
  int left = 0;
  double bumps = 0;
  constexpr int kPairs = 200;
  for (int index = 0; index < kPairs; ++index) {
    const FramePair pair = Street(options, index);
    const Pose& truth = *pair.truth;
    EXPECT_NEAR(truth.t.norm(), 1.5, 1e-12);
    // Where the body is at time 2, in the frame of time 1: forward, half the turn aside.
    const Eigen::Vector3d place = -(truth.R.transpose() * truth.t);
    const Eigen::Vector3d turn = -LogSO3(truth.R);
    EXPECT_GT(place.x(), 1.49);
    EXPECT_NEAR(place.z(), 0.0, 1e-12);
    const double sign = turn.z() > 0 ? 1.0 : -1.0;
    EXPECT_NEAR(std::atan2(place.y(), place.x()), sign * DegToRad(2.5), 1e-12);
    EXPECT_NEAR(turn.z(), sign * DegToRad(5.0), DegToRad(0.05));
    left += turn.z() > 0;
    bumps += turn.head<2>().squaredNorm() / 2;
    EXPECT_EQ(pair.prior.gravity1, -Eigen::Vector3d::UnitZ());
    EXPECT_NEAR((truth.R * *pair.prior.gravity1 - *pair.prior.gravity2).norm(), 0.0, 1e-15);
    EXPECT_NEAR((truth.R * *pair.prior.axis - *pair.prior.axis).norm(), 0.0, 1e-12);
    EXPECT_EQ(pair.prior.forward, Eigen::Vector3d::UnitX());
  }
  EXPECT_GT(left, kPairs / 3);
  EXPECT_LT(left, 2 * kPairs / 3);
  EXPECT_NEAR(RadToDeg(std::sqrt(bumps / kPairs)), 0.2, 0.03);
}

// The same street in a body with y down and z forward: the same pixels but for rounding.
TEST(Street, DoesNotDependOnTheAxesOfTheBody) {
  const StreetOptions options = Surround(4);
  StreetOptions other = options;
  other.axes = BodyAxes();
  Eigen::Matrix3d other_from_body;  // x right, y down, z forward
  other_from_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  for (RigCamera& camera : other.rig.cameras) {
    camera.Q = other_from_body * camera.Q;
    camera.s = other_from_body * camera.s;
  }
  const FramePair a = Street(options, 3);
  const FramePair b = Street(other, 3);
  EXPECT_LT((other_from_body * a.truth->t - b.truth->t).norm(), 1e-12);
  for (size_t k = 0; k < a.matches.size(); ++k) {
    EXPECT_LT((a.matches[k].pixel2 - b.matches[k].pixel2).norm(), 1e-8);
  }
}

TEST(Street, OutliersAndCarsAreNoInliers) {
  StreetOptions options = Surround(6);
  options.num_matches = 500;
  options.inter_share = 0.2;
  options.outlier_share = 0.3;
  options.moving_share = 0.1;
  options.match_scores = true;
  const FramePair pair = Street(options, 1);
  int num_inliers = 0, num_inter = 0, on_car = 0;
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    num_inter += !pair.matches[k].IsIntra();
    num_inliers += pair.columns.inlier[k];
    const std::array<double, 4>& exact = pair.columns.exact[k];
    const Match& m = pair.matches[k];
    const double moved = std::hypot(m.pixel1.x() - exact[0], m.pixel1.y() - exact[1]) +
                         std::hypot(m.pixel2.x() - exact[2], m.pixel2.y() - exact[3]);
    if (pair.columns.inlier[k] == 1) {
      Depths depths;
      PointOf(pair, k, &depths);
    } else {
      on_car += moved > 0;  // an outlier's exact pixels are its own
    }
    EXPECT_LT(moved, 8.0);
    EXPECT_GT(m.score, 0.0);
  }
  EXPECT_EQ(num_inliers, 300);
  EXPECT_EQ(on_car, 50);
  EXPECT_EQ(num_inter, 100);
}

TEST(Street, NoiseOfEachCamera) {
  StreetOptions options = Surround(4);
  options.num_matches = 4000;
  options.camera_noise_px = {0.2, 0.5, 0.5, 1.0};
  const FramePair pair = Street(options, 0);
  EXPECT_NEAR(*pair.noise_px, std::sqrt((0.04 + 0.25 + 0.25 + 1.0) / 4), 1e-12);
  std::array<double, 4> squares{};
  std::array<int, 4> count{};
  for (size_t k = 0; k < pair.matches.size(); ++k) {
    const int camera = pair.matches[k].camera1;
    EXPECT_EQ(pair.columns.sigma1[k], options.camera_noise_px[camera]);
    EXPECT_EQ(pair.columns.sigma2[k], options.camera_noise_px[pair.matches[k].camera2]);
    const std::array<double, 4>& exact = pair.columns.exact[k];
    squares[camera] += (pair.matches[k].pixel1 - Pixel(exact[0], exact[1])).squaredNorm() / 2;
    ++count[camera];
  }
  for (int camera = 0; camera < 4; ++camera) {
    ASSERT_GT(count[camera], 200);
    const double sigma = options.camera_noise_px[camera];
    EXPECT_NEAR(std::sqrt(squares[camera] / count[camera]) / sigma, 1.0, 0.1);
  }
}

TEST(Street, SameSeedAndIndexSamePair) {
  StreetOptions options = Surround(3);
  options.moving_share = 0.1;
  const std::string text = FormatMatches(Street(options, 7));
  EXPECT_EQ(text, FormatMatches(Street(options, 7)));
  EXPECT_NE(text, FormatMatches(Street(options, 8)));
  options.seed = 2;
  EXPECT_NE(text, FormatMatches(Street(options, 7)));
}

TEST(Street, DrivesAsRecorded) {
  const StreetOptions options = Surround(4);
  DrivenMotion motion;
  motion.sequence = "05";
  motion.world_from_body1.R = ExpSO3(Eigen::Vector3d(0.01, 0.3, 0.02));
  motion.world_from_body2.R = motion.world_from_body1.R * ExpSO3(Eigen::Vector3d(0, 0.05, 0));
  motion.world_from_body1.t = {3, 0, 5};
  // Half a metre ahead in the frame of time 1: KITTI's z.
  motion.world_from_body2.t = motion.world_from_body1 * Eigen::Vector3d(0, 0, 0.5);
  FramePair pair;
  std::string error;
  ASSERT_TRUE(MakeDrivenPair(options, 0, motion, &pair, &error)) << error;
  EXPECT_EQ(pair.sequence, "05");
  const Eigen::Vector3d place = -(pair.truth->R.transpose() * pair.truth->t);
  EXPECT_LT((place - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-12);
  // A turn about KITTI's y, down, by 0.05.
  EXPECT_LT((LogSO3(pair.truth->R) - Eigen::Vector3d(0, 0, 0.05)).norm(), 1e-12);
  EXPECT_LT((pair.truth->R * *pair.prior.gravity1 - *pair.prior.gravity2).norm(), 1e-12);
  EXPECT_LT(pair.prior.gravity1->z(), -0.99);
}

TEST(Street, WhatCannotBeMadeIsRefused) {
  const auto refusal = [](const StreetOptions& options) {
    FramePair pair;
    std::string error;
    EXPECT_FALSE(MakeStreetPair(options, 0, &pair, &error));
    EXPECT_TRUE(pair.matches.empty());
    return error;
  };
  StreetOptions options = Surround(2);
  options.inter_share = 0.2;  // back to back
  EXPECT_THAT(refusal(options), HasSubstr("no two cameras of the rig share enough of their views"));
  options = Surround(1);
  options.inter_share = 0.2;
  EXPECT_THAT(refusal(options), HasSubstr("inter_share needs two cameras"));
  options = Surround(1);
  options.rotation_deg = 180;
  EXPECT_THAT(refusal(options), HasSubstr("hardly any point in the view"));
  options = Surround(3);
  options.ground_m = -1.35;
  EXPECT_THAT(refusal(options), HasSubstr("ground_m must put the ground below all cameras"));
  options = Surround(3);
  options.rig.cameras[0].s.y() = 30;
  EXPECT_THAT(refusal(options), HasSubstr("rig: camera 0 is farther from the middle"));
  options = Surround(3);
  options.camera_noise_px = {1, 2};
  EXPECT_THAT(refusal(options), HasSubstr("a number for each of the 3 cameras"));
  options.camera_noise_px = {1, 0, 2};
  EXPECT_THAT(refusal(options), HasSubstr("camera_noise_px must be positive"));
  options = StreetOptions();
  EXPECT_THAT(refusal(options), HasSubstr("rig: no camera"));
  options = Surround(1);
  options.distance_m = -1;
  EXPECT_THAT(refusal(options), HasSubstr("distance_m"));
}

}  // namespace
}  // namespace rigel
