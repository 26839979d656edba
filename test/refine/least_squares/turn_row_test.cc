// Rows of a rotation alone: derivatives against numeric ones, and residuals of unit variance.
#include "rigel/refine/least_squares/turn_row.h"

#include <gtest/gtest.h>

#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

// A match of one camera at a depth, seen after the motion (R, shift of the camera in the body frame
// of time 2 over the depth).
struct Case {
  RigCamera camera;
  Eigen::Matrix3d R;
  Pixel pixel1, pixel2;

  Case(bool fisheye, int index) {
    Random random = Random::Stream(23, index);
    camera.intrinsics = Camera::Pinhole(500, 450, 320, 240, 640, 480);
    if (fisheye) {
      camera.intrinsics = {CameraModel::kOpencvFisheye, {250, 260, 320, 240, 0.01}, 640, 480};
    }
    camera.Q = ExpSO3(RandomVector3(0.0, 3.0, &random));
    R = ExpSO3(RandomVector3(0.0, 0.02, &random));
    const double u = random.Uniform(100, 540), v = random.Uniform(80, 400);
    pixel1 = {u, v};
    EXPECT_TRUE(PixelOf(pixel1, R, Eigen::Vector3d::Zero(), &pixel2));
  }

  bool PixelOf(const Pixel& from, const Eigen::Matrix3d& turn, const Eigen::Vector3d& shift,
               Pixel* pixel) const {
    const Eigen::Vector3d x = camera.Q * AlongRay(camera.intrinsics, from).normalized();
    return Project(camera.intrinsics, camera.Q.transpose() * (turn * x + shift), pixel);
  }
  TurnRow Row(const Pixel& at1, const Pixel& at2, const Eigen::Matrix3d& turn) const {
    TurnRow row;
    EXPECT_TRUE(MakeTurnRow(camera.Q * Unprojection(camera), RowPointOf(camera, at1),
                            RowPointOf(camera, at2), turn, 0.5, &row));
    return row;
  }
};

TEST(TurnRow, DerivativesAreThoseOfTheResidual) {
  for (int index = 0; index < 200; ++index) {
    const Case c(index % 2 == 1, index);
    const TurnRow row = c.Row(c.pixel1, c.pixel2, c.R);
    EXPECT_LT(row.z.norm(), 1e-8);
    for (int k = 0; k < 3; ++k) {
      const auto turned = [&](double h) {
        return c.Row(c.pixel1, c.pixel2, ExpSO3(h * Eigen::Vector3d::Unit(k)) * c.R).z;
      };
      const Eigen::Vector2d by_turn = CentralDifference(turned, 1e-4);
      EXPECT_LT((row.by_turn.col(k) - by_turn).norm(), 1e-5 * by_turn.norm() + 1e-5) << index;
      // The point seen from a camera that moved: the second pixel moves against the residual.
      const auto shifted = [&](double h) {
        Pixel moved;
        EXPECT_TRUE(c.PixelOf(c.pixel1, c.R, h * Eigen::Vector3d::Unit(k), &moved));
        return c.Row(c.pixel1, moved, c.R).z;
      };
      const Eigen::Vector2d by_shift = -CentralDifference(shifted, 1e-4);
      EXPECT_LT((row.by_shift.col(k) - by_shift).norm(), 1e-4 * by_shift.norm() + 1e-3) << index;
    }
  }
}

TEST(TurnRow, NoiseOfThePixelsGivesUnitVariance) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  constexpr int kDraws = 20000;
  Random random = Random::Stream(29, 0);
  const Case cases[2] = {Case(false, 0), Case(true, 1)};
  for (int k = 0; k < kDraws; ++k) {
    const Case& c = cases[k % 2];
    const auto noisy = [&](const Pixel& p) {
      const double u = 0.5 * random.Normal(), v = 0.5 * random.Normal();
      return Pixel(p.x() + u, p.y() + v);
    };
    const Pixel p1 = noisy(c.pixel1), p2 = noisy(c.pixel2);
    const TurnRow row = c.Row(p1, p2, c.R);
    sum += row.z * row.z.transpose() / kDraws;
  }
  EXPECT_LT((sum - Eigen::Matrix2d::Identity()).norm(), 0.05) << sum;
}

TEST(TurnRow, RaysFarApartAreRefused) {
  const Case c(false, 3);
  TurnRow row;
  EXPECT_FALSE(MakeTurnRow(c.camera.Q * Unprojection(c.camera), RowPointOf(c.camera, c.pixel1),
                           RowPointOf(c.camera, c.pixel2),
                           ExpSO3(2.0 * (c.camera.Q * Eigen::Vector3d::UnitY())) * c.R, 0.5, &row));
}

}  // namespace
}  // namespace rigel
