// A rig that stands: that it is found, that its rotation is on the bound of a rotation alone with
// its true covariance, and that a rig that moves is not taken for one.
#include "rigel/refine/standing.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "rigel/refine/between_factor.h"
#include "rigel/refine/estimate_motion.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr double kNoisePx = 0.5;
constexpr int kPairs = 300;

// Cameras that look forward, left and back from places around a body's origin 1.5 m behind the
// first. With `fisheye` the second is one.
Rig SurroundRig(int num_cameras, bool fisheye) {
  Rig rig;
  const Eigen::Vector3d places[3] = {{0, 0, 1.5}, {-0.8, 0, 0.7}, {0.1, 0, -0.5}};
  for (int k = 0; k < num_cameras; ++k) {
    RigCamera camera;
    camera.intrinsics = Camera::Pinhole(700, 700, 480, 320, 960, 640);
    if (fisheye && k == 1) {
      camera.intrinsics = {CameraModel::kOpencvFisheye, {350, 350, 480, 320}, 960, 640};
    }
    camera.Q = ExpSO3(Eigen::Vector3d(0, -kPi / 2 * k, 0));
    camera.s = places[k];
    rig.cameras.push_back(camera);
  }
  return rig;
}

struct Scene {
  int num_cameras = 3;
  bool fisheye = false;
  int num_matches = 240;
  double outlier_share = 0.15;
  double nearest = 5.0;  // metres
};

// Points that each camera sees itself at both times. *information gets that of the inliers on a
// rotation alone.
FramePair PairOf(const Scene& scene, const Pose& truth, int index, Eigen::Matrix3d* information) {
  Random random = Random::Stream(17, index);
  FramePair pair;
  pair.rig = SurroundRig(scene.num_cameras, scene.fisheye);
  pair.truth = truth;
  information->setZero();
  const auto noisy = [&](const Pixel& p) {
    const double u = kNoisePx * random.Normal(), v = kNoisePx * random.Normal();
    return Pixel(p.x() + u, p.y() + v);
  };
  while (static_cast<int>(pair.matches.size()) < scene.num_matches) {
    Match m;
    m.camera1 = m.camera2 = static_cast<int>(pair.matches.size()) % scene.num_cameras;
    const RigCamera& camera = pair.rig.cameras[m.camera1];
    const double u = random.Uniform(0, 960), v = random.Uniform(0, 640);
    const Eigen::Vector3d ray = AlongRay(camera.intrinsics, Pixel(u, v)).normalized();
    const Eigen::Vector3d X = camera.Q * (random.Uniform(scene.nearest, 40.0) * ray) + camera.s;
    const auto second = [&](const Pose& pose, Pixel* pixel) {
      return Project(camera.intrinsics, camera.Q.transpose() * (pose * X - camera.s), pixel);
    };
    Pixel pixel2;
    if (!second(truth, &pixel2)) continue;
    m.pixel1 = noisy({u, v});
    m.pixel2 = noisy(pixel2);
    if (random.Uniform(0, 1) < scene.outlier_share) {
      const double other_u = random.Uniform(0, 960), other_v = random.Uniform(0, 640);
      m.pixel2 = {other_u, other_v};
    } else {
      Eigen::Matrix<double, 2, 3> J;
      for (int k = 0; k < 3; ++k) {
        constexpr double kStep = 1e-6;
        Pixel moved;
        second({ExpSO3(kStep * Eigen::Vector3d::Unit(k)) * truth.R, truth.t}, &moved);
        J.col(k) = (moved - pixel2) / kStep;
      }
      // The noise of both views.
      *information += J.transpose() * J / (2.0 * kNoisePx * kNoisePx);
    }
    pair.matches.push_back(m);
  }
  return pair;
}

struct Figures {
  int standing = 0, moving_claims = 0;
  double efficiency = 0.0;  // RMS error over RMS bound
  double nees = 0.0;        // over 3
};

Figures Measure(const Scene& scene, const Pose& truth) {
  Figures figures;
  double squares = 0.0, bounds = 0.0;
  for (int index = 0; index < kPairs; ++index) {
    Eigen::Matrix3d information;
    const FramePair pair = PairOf(scene, truth, index, &information);
    const MotionEstimate e = EstimateMotion({}, pair);
    EXPECT_EQ(e.status, EstimateStatus::kSuccess) << e.message;
    if (!e.refine.covariance) continue;
    figures.standing += e.refine.stands;
    figures.moving_claims += e.refine.RigDirectionKnown() || e.refine.scale_observable;
    const Eigen::Vector3d error = LogSO3(e.pose.R * truth.R.transpose());
    squares += error.squaredNorm();
    bounds += information.inverse().trace();
    const Eigen::Matrix3d covariance = e.refine.covariance->topLeftCorner<3, 3>();
    figures.nees += error.dot(covariance.inverse() * error) / (3.0 * kPairs);
  }
  figures.efficiency = std::sqrt(squares / bounds);
  return figures;
}

TEST(Standing, IsOnTheBoundOfARotationAlone) {
  for (const bool fisheye : {false, true}) {
    Scene scene;
    scene.fisheye = fisheye;
    const Figures figures = Measure(scene, {});
    EXPECT_GE(figures.standing, 295) << fisheye;
    EXPECT_EQ(figures.moving_claims, 0) << fisheye;
    EXPECT_LT(figures.efficiency, 1.1) << fisheye;
    EXPECT_GT(figures.nees, 0.8) << fisheye;
    EXPECT_LT(figures.nees, 1.25) << fisheye;
  }
}

// One camera at the body's origin may turn as far as it likes.
TEST(Standing, ACameraThatPansStands) {
  Scene scene;
  scene.num_cameras = 1;
  const Eigen::Vector3d s(0, 0, 1.5);
  const Eigen::Matrix3d R = ExpSO3(DegToRad(3.0) * Eigen::Vector3d(0.2, 1.0, 0.1).normalized());
  int standing = 0;
  double squares = 0.0, bounds = 0.0;
  for (int index = 0; index < kPairs; ++index) {
    Eigen::Matrix3d information;
    FramePair pair = PairOf(scene, {R, s - R * s}, index, &information);
    pair.rig.cameras[0].s.setZero();
    const MotionEstimate e = EstimateMotion({}, pair);
    standing += e.refine.stands;
    squares += std::pow(RotationError(R, e.pose.R), 2);
    bounds += information.inverse().trace();
  }
  EXPECT_GE(standing, 290);
  EXPECT_LT(std::sqrt(squares / bounds), 1.1);
}

TEST(Standing, SaysHowFarTheBodyCanHaveMoved) {
  Eigen::Matrix3d information;
  const FramePair pair = PairOf({}, {}, 0, &information);
  const MotionEstimate e = EstimateMotion({}, pair);
  ASSERT_TRUE(e.refine.stands);
  EXPECT_LT(e.pose.t.norm(), 1e-15);
  EXPECT_TRUE(e.refine.covariance_valid);
  EXPECT_NE(e.refine.ObservabilityReport().find("|t| is consistent with zero"), std::string::npos)
      << e.refine.ObservabilityReport();
  // Half a pixel of 700, 200 times, at 50 m: some millimetres.
  const Eigen::Matrix3d of_t = e.refine.covariance->bottomRightCorner<3, 3>();
  EXPECT_GT(std::sqrt(of_t.trace()), 1e-3);
  EXPECT_LT(std::sqrt(of_t.trace()), 5e-2);
  // The edge has all of it.
  const BetweenFactor factor = GtsamBetweenFactor(e.pose, e.refine);
  EXPECT_GT(factor.information.bottomRightCorner(3, 3).determinant(), 0.0);
  EXPECT_GT(factor.information.topLeftCorner(3, 3).determinant(), 0.0);
}

// A body that turns on the spot: its cameras move a little. The covariance knows.
TEST(Standing, TheCovarianceCoversSmallMotionsOfTheCameras) {
  for (const double degrees : {0.05, 0.2}) {
    const Figures figures =
        Measure({}, {ExpSO3(DegToRad(degrees) * Eigen::Vector3d::UnitY()), {0, 0, 0}});
    EXPECT_EQ(figures.moving_claims, 0) << degrees;
    EXPECT_LT(figures.nees, 1.5) << degrees;
  }
}

TEST(Standing, ARigThatMovesIsNotTakenForOne) {
  Scene scene;
  for (const double length : {0.05, 0.1, 1.0}) {
    const Figures figures = Measure(scene, {ExpSO3({0, 2e-3, 0}), {0, 0, -length}});
    EXPECT_EQ(figures.standing, 0) << length;
  }
}

TEST(Standing, TheOriginOfTheBodyMayBeFarAway) {
  Eigen::Matrix3d information;
  FramePair pair = PairOf({}, {}, 0, &information);
  const MotionEstimate near = EstimateMotion({}, pair);
  ASSERT_TRUE(near.refine.stands);
  const Eigen::Vector3d far(4e5, 5e6, 100.0);
  for (RigCamera& camera : pair.rig.cameras) camera.s += far;
  const MotionEstimate e = EstimateMotion({}, pair);
  ASSERT_TRUE(e.refine.stands);
  EXPECT_LT(RotationErrorDeg(near.pose, e.pose), 0.2 * RadToDeg(near.refine.rotation_sigma));
  const Eigen::Vector3d c = e.refine.rig_center;
  EXPECT_LT((e.pose.R * c + e.pose.t - c).norm(), 1e-6);
}

TEST(Standing, AStatedDistanceThatIsNotZeroIsBelieved) {
  Eigen::Matrix3d information;
  FramePair pair = PairOf({}, {}, 0, &information);
  pair.prior.distance = 0.5;
  pair.prior.distance_sigma = 0.1;
  EXPECT_FALSE(EstimateMotion({}, pair).refine.stands);
  pair.prior.distance = 0.05;
  EXPECT_TRUE(EstimateMotion({}, pair).refine.stands);
}

}  // namespace
}  // namespace rigel
