// Residuals and Jacobians where the headers define their values by themselves: at the epipole,
// without a baseline or parallax, at rest.
#include <cmath>
#include <vector>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "rigel/test/core/pinhole.h"
#include "rigel/test/refine/least_squares/jacobian_twins.h"

namespace rigel {
namespace {

// Two cameras of unlike focal lengths whose numbers, and all made of them below, are exact in
// binary.
Rig ExactRig() {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].intrinsics = Camera::Pinhole(512, 256, 320, 240, 640, 480);
  rig.cameras[1].intrinsics = Camera::Pinhole(256, 1024, 300, 200, 640, 480);
  rig.cameras[0].s = {0.5, -0.25, 1.0};
  rig.cameras[1].s = {-1.5, 0.75, 0.25};
  return rig;
}

Match MakeMatch(int camera1, const Eigen::Vector2d& pixel1, int camera2,
                const Eigen::Vector2d& pixel2) {
  Match m;
  m.camera1 = camera1;
  m.pixel1 = pixel1;
  m.camera2 = camera2;
  m.pixel2 = pixel2;
  return m;
}

// Residual and row of one match by the perturbation of the motion.
struct Row {
  double r = 5.0;
  Vector6d J = Vector6d::Constant(5.0);
};

Row EpipolarRow(const Rig& rig, const Match& m, ResidualKind kind, const Pose& pose) {
  const GroupedMatches matches(rig, {m});
  const MotionBasis basis = MotionBasis::Identity(6, 6);
  std::vector<GroupLinearization> groups;
  const EpipolarResiduals residuals(matches, kind);
  residuals.Linearize(pose, &basis, &groups);
  Row row;
  row.r = residuals.Evaluate(groups, 0, 6, row.J.data());
  return row;
}

Row EpipolarRowByJets(const Rig& rig, const Match& m, ResidualKind kind, const Pose& pose) {
  using Jet = ceres::Jet<double, 6>;
  const Jet jet = EpipolarTwin<Jet>(kind, PerturbedJets<Jet>(pose), rig, m);
  return {jet.a, jet.v};
}

TEST(Jacobian, EpipolarResidualsAreZeroAtAnEpipole) {
  const Rig rig = ExactRig();
  Pose pose;  // both cameras look along the baseline
  pose.t = {0, 0, 2};
  const Match intra = MakeMatch(0, {320, 240}, 0, {320, 240});
  Match inter = MakeMatch(0, {320, 240}, 1, {300, 200});
  for (const ResidualKind kind : {ResidualKind::kSampson, ResidualKind::kAngular}) {
    const Row row = EpipolarRow(rig, intra, kind, pose);
    EXPECT_EQ(row.r, 0.0);
    EXPECT_EQ(row.J.norm(), 0.0);
    Pose to_inter;
    to_inter.t = rig.cameras[1].s - rig.cameras[0].s + Eigen::Vector3d(0, 0, 2);
    const Row inter_row = EpipolarRow(rig, inter, kind, to_inter);
    EXPECT_EQ(inter_row.r, 0.0);
    EXPECT_EQ(inter_row.J.norm(), 0.0);
    // With one of the two pixels there only, the gradient is not zero.
    inter.pixel2 = {310, 180};
    const Row beside = EpipolarRow(rig, inter, kind, to_inter);
    const Row expected = EpipolarRowByJets(rig, inter, kind, to_inter);
    EXPECT_EQ(beside.r, 0.0);
    EXPECT_GT(beside.J.norm(), 1e-3);
    EXPECT_LT(RelativeError(beside.J, expected.J), kTolerance);
    inter.pixel2 = {300, 200};
  }
}

// Where the epipoles are pixels of rounding.
TEST(Jacobian, EpipolarResidualsAreFiniteNearAnEpipole) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    for (Match m : p.matches) {
      const RigCamera& c1 = p.rig.cameras[m.camera1];
      const RigCamera& c2 = p.rig.cameras[m.camera2];
      const Pose& pose = p.start.pose;
      const Eigen::Vector3d b = pose.R * c1.s + pose.t - c2.s;
      m.pixel1 = ProjectPinhole(c1.intrinsics, c1.Q.transpose() * (pose.R.transpose() * b));
      m.pixel2 = ProjectPinhole(c2.intrinsics, c2.Q.transpose() * b);
      for (const ResidualKind kind : kKinds) {
        const Row row = EpipolarRow(p.rig, m, kind, pose);
        EXPECT_TRUE(std::isfinite(row.r)) << i << At(m);
        EXPECT_TRUE(row.J.allFinite()) << i << At(m);
      }
    }
  }
}

TEST(Jacobian, EpipolarResidualsAreZeroWithoutABaseline) {
  const Rig rig = ExactRig();
  Random random(139);
  const Pose still;
  Pose onto;  // takes camera 0 to the place of camera 1
  onto.t = rig.cameras[1].s - rig.cameras[0].s;
  for (int i = 0; i < kPoints; ++i) {
    Match m = UnrelatedMatches(rig, 1, &random)[0];
    m.camera2 = i % 2;
    const Pose& pose = m.IsIntra() ? still : onto;
    for (const ResidualKind kind : {ResidualKind::kSampson, ResidualKind::kAngular}) {
      const Row row = EpipolarRow(rig, m, kind, pose);
      EXPECT_EQ(row.r, 0.0);
      EXPECT_EQ(row.J.norm(), 0.0);
    }
    // The algebraic residual is smooth there: zero, but not its derivative.
    const Row row = EpipolarRow(rig, m, ResidualKind::kAlgebraic, pose);
    const Row expected = EpipolarRowByJets(rig, m, ResidualKind::kAlgebraic, pose);
    EXPECT_EQ(row.r, 0.0);
    EXPECT_GT(row.J.norm(), 1e-3);
    EXPECT_LT(RelativeError(row.J, expected.J), kTolerance);
  }
}

// A point at infinity: residuals of zero, derivatives as of any other.
TEST(Jacobian, ZeroParallaxIsNothingSpecial) {
  using Jet = ceres::Jet<double, 9>;
  int count = 0;
  Worst epipolar, by_motion, by_point;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    const Pose& pose = p.start.pose;
    for (Match m : p.matches) {
      const RigCamera& c1 = p.rig.cameras[m.camera1];
      const RigCamera& c2 = p.rig.cameras[m.camera2];
      const Eigen::Vector3d direction =
          c2.Q.transpose() * (pose.R * (c1.Q * AlongRay(c1.intrinsics, m.pixel1)));
      if (std::abs(direction.z()) < 0.1) continue;
      m.pixel2 = ProjectPinhole(c2.intrinsics, direction);
      ++count;
      const auto where = [&] { return std::to_string(i) + At(m); };
      for (const ResidualKind kind : kKinds) {
        const Row row = EpipolarRow(p.rig, m, kind, pose);
        const Row expected = EpipolarRowByJets(p.rig, m, kind, pose);
        EXPECT_LT(std::abs(row.r), 1e-9) << where();
        epipolar.Add(RelativeError(row.J, expected.J), where);
      }
      const ReprojectionCost::Point point = ReprojectionCost::Triangulate(p.rig, m, pose);
      EXPECT_EQ(point, (ReprojectionCost::Point{0.0, 0.0, 0.0})) << where();
      const MotionBasis basis = MotionBasis::Identity(6, 6);
      const double motion[6] = {};
      const double* blocks[2] = {motion, point.data()};
      Eigen::Vector4d r;
      Eigen::Matrix<double, 4, 6, Eigen::RowMajor> J_motion;
      Eigen::Matrix<double, 4, 3, Eigen::RowMajor> J_point;
      double* jacobians[2] = {J_motion.data(), J_point.data()};
      ASSERT_TRUE(
          ReprojectionCost(p.rig, m, pose, basis, 6, 1.0).Evaluate(blocks, r.data(), jacobians));
      const Vector3<Jet> jets(Jet(0.0, 6), Jet(0.0, 7), Jet(0.0, 8));
      const Eigen::Matrix<Jet, 4, 1> twin =
          ReprojectionTwin<Jet>(p.rig, m, 1.0, PerturbedJets<Jet>(pose), jets);
      Eigen::Matrix<double, 4, 9> J;
      for (int k = 0; k < 4; ++k) J.row(k) = twin(k).v.transpose();
      EXPECT_LT(r.norm(), 1e-9) << where();
      EXPECT_EQ(J_motion.rightCols<3>().norm(), 0.0) << where();
      by_motion.Add(RelativeError(J_motion, J.leftCols<6>()), where);
      by_point.Add(RelativeError(J_point, J.rightCols<3>()), where);
    }
  }
  EXPECT_GT(count, kPoints * 6);
  epipolar.Expect("epipolar", kTolerance, count * 3);
  by_motion.Expect("motion", kTolerance, count);
  by_point.Expect("point", kTolerance, count);
}

// At rest the distance has no derivative: its row is zero, the others are not touched.
TEST(Jacobian, DistancePriorHasNoDerivativeAtRest) {
  Random random(140);
  for (const PriorKind kind : kPriorKinds) {
    MotionPrior prior = FullPrior(&random);
    Pose pose = MakePoint(2).start.pose;
    PriorParts parts;
    parts.direction = kind;
    parts.distance = true;
    const PriorResiduals residuals(prior, parts, pose);
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian J, moving;
    residuals.Evaluate(pose, &r, &moving);
    pose.t.setZero();
    residuals.Evaluate(pose, &r, &J);
    const int last = residuals.size() - 1;
    EXPECT_DOUBLE_EQ(r(last), -*prior.distance / prior.distance_sigma);
    EXPECT_EQ(J.row(last).norm(), 0.0);
    EXPECT_EQ((J.topRows(last) - moving.topRows(last)).norm(), 0.0);
  }
}

// The logarithm of no length: finite, far below the typical one, and no derivative.
TEST(Jacobian, WeakLengthIsFiniteAtRest) {
  PriorParts parts;
  parts.typical_length = 0.7;
  const PriorResiduals residuals(MotionPrior(), parts, Pose());
  PriorResiduals::Residuals r;
  PriorResiduals::Jacobian J;
  residuals.Evaluate(Pose(), &r, &J);
  ASSERT_EQ(r.size(), 1);
  EXPECT_TRUE(std::isfinite(r(0)));
  EXPECT_LT(r(0), -20.0);
  EXPECT_EQ(J.norm(), 0.0);
}

}  // namespace
}  // namespace rigel
