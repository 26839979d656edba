#include "rigel/minimal/solvers/depth_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "rigel/core/angles.h"
#include "rigel/core/epipolar.h"
#include "rigel/core/metrics.h"
#include "rigel/core/random.h"
#include "rigel/minimal/numerics/polynomial.h"
#include "rigel/minimal/solvers/three_point.h"
#include "rigel/problems/scenes/synthetic.h"
#include "rigel/test/core/pinhole.h"

namespace rigel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kSample[] = {0, 1, 2, 3};

enum class Cameras { kIntra, kInter, kMixed, kSingle };

FramePair MakePair(int seed, Cameras cameras, RotationAxisPattern axis = RotationAxisPattern::kY,
                   MotionPattern motion = MotionPattern::kPlanar) {
  SceneOptions options;
  options.num_matches = 4;
  options.noise_px = 0.0;
  options.rotation_deg = 3.0;
  options.rotation_axis = axis;
  options.motion = motion;
  options.num_cameras = cameras == Cameras::kSingle ? 1 : 2;
  if (cameras == Cameras::kInter) options.inter_share = 1.0;
  // The last of four.
  if (cameras == Cameras::kMixed) options.inter_share = 0.25;
  FramePair pair;
  std::string error;
  EXPECT_TRUE(MakeScenePair(options, seed, &pair, &error)) << error;
  return pair;
}

PreparedMatches Prepare(const FramePair& pair, PriorKind kind) {
  Alignment alignment;
  std::string error;
  EXPECT_TRUE(MakeAlignment(pair.prior, kind, &alignment, &error)) << error;
  return PreparedMatches(pair.rig, pair.matches, alignment);
}

// det F by core's coefficients, from the feet of the reference of largest parallax and without any
// table; R may be the linearized rotation.
double DirectDeterminant(const PreparedMatches& matches, int sample_size, const Matrix3d& R) {
  int best = 0;
  for (int k = 1; k < sample_size; ++k) {
    if (matches[k].parallax2 > matches[best].parallax2) best = k;
  }
  const RayPair& reference = matches.rays(best);
  Matrix3d F;
  int row = 0;
  for (int k = 0; k < sample_size; ++k) {
    if (k != best) F.row(row++) = GecDepthCoefficients(R, reference, matches.rays(k));
  }
  if (sample_size == 3) {
    const Alignment& alignment = matches.alignment();
    F.row(2) << -(alignment.A1 * reference.ray1.x).y(), (alignment.A2 * reference.ray2.x).y(),
        (alignment.A2 * reference.ray2.Foot()).y() - (alignment.A1 * reference.ray1.Foot()).y();
  }
  return F.determinant();
}

template <RotationModel kModel>
int Determinant(const PreparedMatches& matches, int sample_size, std::vector<double>* c) {
  DepthSystem<kModel> system;
  if (sample_size == 4) {
    system.SetFourPoint(matches, kSample);
  } else {
    system.SetPlanar(matches, kSample);
  }
  c->assign(7, -1.0);
  return system.Determinant(c->data());
}

double Value(const std::vector<double>& c, int degree, double z) {
  double value = 0.0;
  for (int k = degree; k >= 0; --k) value = value * z + c[k];
  return value;
}

// The size of det F's terms, for tolerances.
double LargestCoefficient(const std::vector<double>& c, int degree) {
  double largest = 0.0;
  for (int k = 0; k <= degree; ++k) largest = std::max(largest, std::abs(c[k]));
  return largest;
}

struct Case {
  PriorKind prior;
  RotationAxisPattern axis;
  Cameras cameras;
  bool deflated;
};

constexpr RotationAxisPattern kY = RotationAxisPattern::kY;
constexpr RotationAxisPattern kRandom = RotationAxisPattern::kRandom;
constexpr Case kFourPointCases[] = {
    {PriorKind::kVertical, kY, Cameras::kIntra, true},
    {PriorKind::kVertical, kRandom, Cameras::kIntra, false},  // R = I is not in the family
    {PriorKind::kVertical, kY, Cameras::kInter, false},
    {PriorKind::kVertical, kRandom, Cameras::kMixed, false},
    {PriorKind::kAxis, kY, Cameras::kIntra, true},
    {PriorKind::kAxis, kRandom, Cameras::kIntra, true},
    {PriorKind::kAxis, kRandom, Cameras::kMixed, false},
    {PriorKind::kAxis, kRandom, Cameras::kInter, false},
};

TEST(DepthSystem, ExactFourPointDeterminantIsThatOfTheCoreRows) {
  for (const Case& test : kFourPointCases) {
    for (int seed = 0; seed < 50; ++seed) {
      const FramePair pair = MakePair(seed, test.cameras, test.axis, MotionPattern::kForward);
      const PreparedMatches matches = Prepare(pair, test.prior);
      std::vector<double> c;
      const int degree = Determinant<RotationModel::kExact>(matches, 4, &c);
      ASSERT_EQ(degree, test.deflated ? 5 : 6);
      const double size = LargestCoefficient(c, degree);
      if (test.deflated) {
        EXPECT_EQ(c[6], 0.0) << "above the degree";
      }
      for (const double z : {-2.0, -0.3, -0.01, 0.0, 0.02, 0.5, 1.0}) {
        const double angle = 2.0 * std::atan(z);
        const Matrix3d R = matches.alignment().Rotation(std::cos(angle), std::sin(angle));
        const double expected = std::pow(1 + z * z, 3) * DirectDeterminant(matches, 4, R);
        EXPECT_NEAR(Value(c, degree, z) * (test.deflated ? z : 1.0), expected,
                    1e-11 * size * std::max(1.0, std::pow(std::abs(z), 6)))
            << "z " << z << " seed " << seed;
      }
    }
  }
}

TEST(DepthSystem, FirstOrderFourPointDeterminantIsThatOfTheLinearizedRows) {
  for (const Case& test : kFourPointCases) {
    for (int seed = 0; seed < 50; ++seed) {
      const FramePair pair = MakePair(seed, test.cameras, test.axis, MotionPattern::kForward);
      const PreparedMatches matches = Prepare(pair, test.prior);
      std::vector<double> c;
      const int degree = Determinant<RotationModel::kFirstOrder>(matches, 4, &c);
      ASSERT_EQ(degree, test.deflated ? 2 : 3);
      const double size = LargestCoefficient(c, degree);
      for (const double a : {-1.0, -0.01, 0.0, 0.05, 0.5}) {
        const double expected = DirectDeterminant(matches, 4, matches.alignment().Rotation(1.0, a));
        EXPECT_NEAR(Value(c, degree, a) * (test.deflated ? a : 1.0), expected, 1e-11 * size)
            << "a " << a << " seed " << seed;
      }
    }
  }
}

TEST(DepthSystem, PlanarDeterminants) {
  for (const Cameras cameras : {Cameras::kIntra, Cameras::kInter}) {
    const bool deflated = cameras == Cameras::kIntra;
    for (int seed = 0; seed < 100; ++seed) {
      const PreparedMatches matches = Prepare(MakePair(seed, cameras), PriorKind::kPlanar);
      std::vector<double> c;
      // Quartic, cubic; the row of t . n = 0 is not multiplied by 1 + z^2.
      const int degree = Determinant<RotationModel::kExact>(matches, 3, &c);
      ASSERT_EQ(degree, deflated ? 3 : 4);
      double size = LargestCoefficient(c, degree);
      for (const double z : {-1.5, -0.01, 0.0, 0.02, 0.5}) {
        const double angle = 2.0 * std::atan(z);
        const Matrix3d R = matches.alignment().Rotation(std::cos(angle), std::sin(angle));
        EXPECT_NEAR(Value(c, degree, z) * (deflated ? z : 1.0),
                    std::pow(1 + z * z, 2) * DirectDeterminant(matches, 3, R), 1e-10 * size)
            << "z " << z << " seed " << seed;
      }
      // Quadratic and not the paper's quartic; linear.
      const int first_order_degree = Determinant<RotationModel::kFirstOrder>(matches, 3, &c);
      ASSERT_EQ(first_order_degree, deflated ? 1 : 2);
      size = LargestCoefficient(c, first_order_degree);
      for (const double a : {-1.0, -0.01, 0.0, 0.05, 0.5}) {
        EXPECT_NEAR(Value(c, first_order_degree, a) * (deflated ? a : 1.0),
                    DirectDeterminant(matches, 3, matches.alignment().Rotation(1.0, a)),
                    1e-11 * size)
            << "a " << a << " seed " << seed;
      }
    }
  }
}

TEST(DepthSystem, TheDegreeIsReached) {
  // The leading coefficients are not rounding: a solver of a lower degree would lose a root.
  for (const Case& test : kFourPointCases) {
    const PreparedMatches matches =
        Prepare(MakePair(7, test.cameras, test.axis, MotionPattern::kForward), test.prior);
    std::vector<double> c;
    int degree = Determinant<RotationModel::kExact>(matches, 4, &c);
    EXPECT_GT(std::abs(c[degree]), 1e-9 * LargestCoefficient(c, degree));
    degree = Determinant<RotationModel::kFirstOrder>(matches, 4, &c);
    EXPECT_GT(std::abs(c[degree]), 1e-9 * LargestCoefficient(c, degree));
  }
}

TEST(DepthSystem, CentralSamplesLoseTheConstantColumn) {
  for (int seed = 0; seed < 50; ++seed) {
    const FramePair pair = MakePair(seed, Cameras::kSingle);
    const PreparedMatches matches = Prepare(pair, PriorKind::kAxis);
    std::vector<double> c;
    EXPECT_EQ(Determinant<RotationModel::kExact>(matches, 4, &c), 4);
    // The truth is a root.
    const double truth = std::tan(0.5 * matches.alignment().NearestAngle(pair.truth->R));
    EXPECT_LT(std::abs(Value(c, 4, truth)), 1e-10 * LargestCoefficient(c, 4));
    EXPECT_EQ(Determinant<RotationModel::kFirstOrder>(matches, 4, &c), 2);
    const PreparedMatches planar = Prepare(pair, PriorKind::kPlanar);
    EXPECT_EQ(Determinant<RotationModel::kExact>(planar, 3, &c), 2);
    EXPECT_LT(std::abs(Value(c, 2, truth)), 1e-10 * LargestCoefficient(c, 2));
    EXPECT_EQ(Determinant<RotationModel::kFirstOrder>(planar, 3, &c), 1);
  }
}

TEST(DepthSystem, TheTruthIsARootAndSolvesToTheMotion) {
  for (const Case& test : kFourPointCases) {
    for (int seed = 0; seed < 50; ++seed) {
      const FramePair pair = MakePair(seed, test.cameras, test.axis, MotionPattern::kForward);
      const PreparedMatches matches = Prepare(pair, test.prior);
      DepthSystem<RotationModel::kExact> system;
      system.SetFourPoint(matches, kSample);
      const double angle = matches.alignment().NearestAngle(pair.truth->R);
      Solutions solutions;
      system.AddSolution(matches, std::tan(0.5 * angle), &solutions);
      ASSERT_EQ(solutions.size(), 1);
      EXPECT_LT(RotationError(pair.truth->R, solutions[0].R), 1e-12);
      EXPECT_LT((solutions[0].t - pair.truth->t).norm(), 1e-5) << "seed " << seed;
      EXPECT_TRUE(solutions[0].has_scale);
    }
  }
}

TEST(DepthSystem, AddsNothingForARootThatIsNotFinite) {
  const PreparedMatches matches = Prepare(MakePair(1, Cameras::kInter), PriorKind::kAxis);
  DepthSystem<RotationModel::kExact> system;
  system.SetFourPoint(matches, kSample);
  Solutions solutions;
  system.AddSolution(matches, std::numeric_limits<double>::quiet_NaN(), &solutions);
  system.AddSolution(matches, std::numeric_limits<double>::infinity(), &solutions);
  EXPECT_EQ(solutions.size(), 0);
}

// A reference on the horizon at time 2, (x2)_y = 0 exactly: elimination of l2 would divide by it.
TEST(DepthSystem, PlanarReferenceOnTheHorizon) {
  int found = 0;
  const int kSeeds = 100;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Random random = Random::Stream(1, seed);
    FramePair pair;
    pair.rig.cameras.resize(2);
    for (int k = 0; k < 2; ++k) {
      pair.rig.cameras[k].intrinsics = Camera::Pinhole(400.0, 400.0, 320.0, 240.0, 640, 480);
      // At different heights, so that the point is on the horizon of one of them only.
      pair.rig.cameras[k].s = Vector3d(k - 0.5, 0.4 * k, 0.0);
    }
    Pose truth;
    truth.R = ExpSO3(DegToRad(2.0) * Vector3d::UnitY());
    truth.t = Vector3d(0.1, 0.0, 1.0);
    pair.prior.normal = Vector3d::UnitY();
    for (int k = 0; k < 3; ++k) {
      const int i = k % 2;
      const int j = 1 - i;
      const double depth = k == 0 ? 3.0 : random.Uniform(20.0, 30.0);
      const double x = random.Uniform(-0.5, 0.5);
      const double y = random.Uniform(-0.4, 0.4);
      Vector3d X2(x * depth, y * depth, depth);
      X2 += pair.rig.cameras[j].s;
      if (k == 0) X2.y() = pair.rig.cameras[j].s.y();
      Match match;
      match.camera1 = i;
      match.camera2 = j;
      match.pixel1 = ProjectPinhole(pair.rig.cameras[i].intrinsics,
                                    truth.Inverse() * X2 - pair.rig.cameras[i].s);
      match.pixel2 = ProjectPinhole(pair.rig.cameras[j].intrinsics, X2 - pair.rig.cameras[j].s);
      pair.matches.push_back(match);
    }
    const PreparedMatches matches = Prepare(pair, PriorKind::kPlanar);
    ASSERT_EQ(matches[0].x2[1], 0.0);
    // Nearest by far: the reference.
    ASSERT_GT(matches[0].parallax2, matches[1].parallax2);
    ASSERT_GT(matches[0].parallax2, matches[2].parallax2);
    Solutions solutions;
    Solve3pt(matches, kSample, &solutions);
    for (const Solution& solution : solutions) {
      EXPECT_LT(std::abs(solution.t.y()), 1e-9) << "planar";
      if (RotationError(truth.R, solution.R) < 1e-8 && (solution.t - truth.t).norm() < 1e-6) {
        ++found;
        break;
      }
    }
  }
  EXPECT_EQ(found, kSeeds);
}

}  // namespace
}  // namespace rigel
