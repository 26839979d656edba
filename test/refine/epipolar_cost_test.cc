// The cost functions against core's Sampson error, against a twin written with ceres::Jet, and
// against ceres::GradientChecker on the manifolds; and at work in a pose graph.
#include "rigel/refine/epipolar_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include "rigel/core/epipolar.h"
#include "rigel/test/core/lens_rig.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/jet_geometry.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr QuaternionOrder kOrders[] = {QuaternionOrder::kCeres, QuaternionOrder::kEigen};

// One of the four factories.
struct Form {
  bool absolute;
  bool extrinsics;
};
constexpr Form kForms[] = {{false, false}, {true, false}, {false, true}, {true, true}};

std::unique_ptr<ceres::CostFunction> MakeCost(const Form& form, const Rig& rig, const Match& match,
                                              double sigma_px, QuaternionOrder order) {
  const auto factory =
      form.absolute
          ? (form.extrinsics ? MakeAbsoluteEpipolarCostWithExtrinsics : MakeAbsoluteEpipolarCost)
          : (form.extrinsics ? MakeRelativeEpipolarCostWithExtrinsics : MakeRelativeEpipolarCost);
  return std::unique_ptr<ceres::CostFunction>(factory(rig, match, sigma_px, order));
}

std::string Name(const Form& form, const Match& m, QuaternionOrder order) {
  return std::string(form.absolute ? "absolute" : "relative") +
         (form.extrinsics ? ", extrinsics" : "") + (m.IsIntra() ? ", intra" : ", inter") +
         (order == QuaternionOrder::kCeres ? ", w x y z" : ", x y z w");
}

std::unique_ptr<ceres::Manifold> MakeManifold(QuaternionOrder order) {
  if (order == QuaternionOrder::kCeres) return std::make_unique<ceres::QuaternionManifold>();
  return std::make_unique<ceres::EigenQuaternionManifold>();
}

// Parameter blocks of poses, in turns a quaternion and a translation.
class Blocks {
 public:
  explicit Blocks(QuaternionOrder order) : order_(order) {}

  // The quaternion with the norm `norm`, which may be negative.
  void Add(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double norm = 1.0) {
    Eigen::Quaterniond q(R);
    q.normalize();
    q.coeffs() *= norm;
    if (order_ == QuaternionOrder::kCeres) {
      values_.push_back({q.w(), q.x(), q.y(), q.z()});
    } else {
      values_.push_back({q.x(), q.y(), q.z(), q.w()});
    }
    values_.push_back({t.x(), t.y(), t.z()});
  }

  Pose PoseAt(int k) const {
    const std::vector<double>& v = values_[2 * k];
    const std::vector<double>& t = values_[2 * k + 1];
    const Eigen::Quaterniond q = order_ == QuaternionOrder::kCeres
                                     ? Eigen::Quaterniond(v[0], v[1], v[2], v[3])
                                     : Eigen::Quaterniond(v[3], v[0], v[1], v[2]);
    return Pose::FromQuaternion(q, {t[0], t[1], t[2]});
  }

  int size() const { return static_cast<int>(values_.size()); }
  double* data(int block) { return values_[block].data(); }
  int block_size(int block) const { return static_cast<int>(values_[block].size()); }
  std::vector<const double*> Pointers() const {
    std::vector<const double*> pointers;
    for (const std::vector<double>& v : values_) pointers.push_back(v.data());
    return pointers;
  }

 private:
  QuaternionOrder order_;
  std::vector<std::vector<double>> values_;
};

// The blocks of `form` at the motion `pose`. With `random`, quaternions of any length and the world
// anywhere; else of unit length and the world in body 2.
Blocks MakeBlocks(const Form& form, QuaternionOrder order, const Pose& pose, const Rig& rig,
                  const Match& m, Random* random) {
  const auto norm = [&] {
    if (random == nullptr) return 1.0;
    return random->Index(2) == 0 ? 1.0 : -std::pow(10.0, random->Uniform(-1.0, 1.0));
  };
  Blocks blocks(order);
  if (form.absolute) {
    Pose w_b2;
    if (random != nullptr) {
      w_b2.R = ExpSO3(RandomVector3(0.0, kPi, random));
      w_b2.t = RandomVector3(0.0, 10.0, random);
    }
    const Pose w_b1 = w_b2 * pose;
    blocks.Add(w_b1.R, w_b1.t, norm());
    blocks.Add(w_b2.R, w_b2.t, norm());
  } else {
    blocks.Add(pose.R, pose.t, norm());
  }
  if (form.extrinsics) {
    const RigCamera& i = rig.cameras[m.camera1];
    const RigCamera& j = rig.cameras[m.camera2];
    blocks.Add(i.Q, i.s, norm());
    if (!m.IsIntra()) blocks.Add(j.Q, j.s, norm());
  }
  return blocks;
}

// Residual and Jacobian blocks; the test fails if there are none.
struct Row {
  double residual = 0.0;
  std::vector<Eigen::VectorXd> blocks;

  double norm() const {
    double squared = 0.0;
    for (const Eigen::VectorXd& b : blocks) squared += b.squaredNorm();
    return std::sqrt(squared);
  }
};

Row Evaluate(const ceres::CostFunction& cost, const Blocks& blocks) {
  Row row;
  std::vector<double*> jacobians;
  row.blocks.resize(blocks.size());
  for (int k = 0; k < blocks.size(); ++k) {
    row.blocks[k].setConstant(blocks.block_size(k), 7.0);
    jacobians.push_back(row.blocks[k].data());
  }
  EXPECT_TRUE(cost.Evaluate(blocks.Pointers().data(), &row.residual, jacobians.data()));
  return row;
}

// The residual from the header's words: uncentred calibration matrices, rotation matrices as
// quadratic forms of q over |q|^2. Nothing of the library's own route.
struct Twin {
  Form form;
  QuaternionOrder order;
  Rig rig;
  Match match;
  double sigma_px;

  template <class T>
  Matrix3<T> Rotation(const T* x) const {
    const bool ceres_order = order == QuaternionOrder::kCeres;
    const T w = ceres_order ? x[0] : x[3];
    const Vector3<T> v = ceres_order ? Vector3<T>(x[1], x[2], x[3]) : Vector3<T>(x[0], x[1], x[2]);
    const T vv = v.squaredNorm();
    const Matrix3<T> quadratic = Matrix3<T>::Identity() * (w * w - vv) +
                                 v * v.transpose() * T(2.0) + Cross<T>(v) * (T(2.0) * w);
    return quadratic / (w * w + vv);
  }

  template <class T>
  bool operator()(T const* const* x, T* residual) const {
    using std::sqrt;
    Matrix3<T> R = Rotation(x[0]);
    Vector3<T> t(x[1][0], x[1][1], x[1][2]);
    int block = 2;
    if (form.absolute) {
      const Matrix3<T> R_2w = Rotation(x[2]).transpose();
      R = (R_2w * R).eval();
      t = (R_2w * (t - Vector3<T>(x[3][0], x[3][1], x[3][2]))).eval();
      block = 4;
    }
    const RigCamera& i = rig.cameras[match.camera1];
    const RigCamera& j = rig.cameras[match.camera2];
    Matrix3<T> Q_i = i.Q.cast<T>(), Q_j = j.Q.cast<T>();
    Vector3<T> s_i = i.s.cast<T>(), s_j = j.s.cast<T>();
    if (form.extrinsics) {
      Q_i = Rotation(x[block]);
      s_i = Vector3<T>(x[block + 1][0], x[block + 1][1], x[block + 1][2]);
      if (!match.IsIntra()) block += 2;
      Q_j = Rotation(x[block]);
      s_j = Vector3<T>(x[block + 1][0], x[block + 1][1], x[block + 1][2]);
    }
    const Vector3<T> b = R * s_i + t - s_j;
    const Matrix3<T> E = Q_j.transpose() * Cross<T>(b) * R * Q_i;
    const Camera& ci = i.intrinsics;
    const Camera& cj = j.intrinsics;
    Matrix3<T> Ki_inverse, Kj_inverse;
    Ki_inverse << T(1 / ci.fx()), T(0), T(-ci.cx() / ci.fx()), T(0), T(1 / ci.fy()),
        T(-ci.cy() / ci.fy()), T(0), T(0), T(1);
    Kj_inverse << T(1 / cj.fx()), T(0), T(-cj.cx() / cj.fx()), T(0), T(1 / cj.fy()),
        T(-cj.cy() / cj.fy()), T(0), T(0), T(1);
    const Matrix3<T> F = Kj_inverse.transpose() * E * Ki_inverse;
    const Vector3<T> p = match.pixel1.homogeneous().cast<T>();
    const Vector3<T> q = match.pixel2.homogeneous().cast<T>();
    const Vector3<T> Fp = F * p;
    const Vector3<T> Ftq = F.transpose() * q;
    const T gradient2 = Fp.template head<2>().squaredNorm() + Ftq.template head<2>().squaredNorm();
    residual[0] = q.dot(Fp) / sqrt(gradient2) / sigma_px;
    return true;
  }
};

std::unique_ptr<ceres::CostFunction> MakeTwin(const Twin& twin, const Blocks& blocks) {
  auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<Twin, 4>>(new Twin(twin));
  for (int k = 0; k < blocks.size(); ++k) cost->AddParameterBlock(blocks.block_size(k));
  cost->SetNumResiduals(1);
  return cost;
}

// Near zero, near a half turn and in between.
Pose RandomPose(int number, Random* random) {
  const double angle = number % 3 == 0   ? std::pow(10.0, random->Uniform(-9.0, -2.0))
                       : number % 3 == 1 ? kPi - std::pow(10.0, random->Uniform(-9.0, -2.0))
                                         : random->Uniform(0.0, kPi);
  Pose pose;
  pose.R = ExpSO3(angle * random->UnitVector3());
  pose.t = RandomVector3(0.2, 3.0, random);
  return pose;
}

TEST(EpipolarCost, HasTheBlocksOfItsHeader) {
  Random random(1);
  const Rig rig = MixedRig(&random);
  for (const Match& m : UnrelatedMatches(rig, 9, &random)) {
    for (const Form& form : kForms) {
      const auto cost = MakeCost(form, rig, m, 1.0, QuaternionOrder::kCeres);
      ASSERT_NE(cost, nullptr);
      const int poses = (form.absolute ? 2 : 1) + (form.extrinsics ? (m.IsIntra() ? 1 : 2) : 0);
      std::vector<int32_t> sizes;
      for (int k = 0; k < poses; ++k) sizes.insert(sizes.end(), {4, 3});
      EXPECT_EQ(cost->num_residuals(), 1);
      EXPECT_EQ(cost->parameter_block_sizes(), sizes) << Name(form, m, QuaternionOrder::kCeres);
    }
  }
}

TEST(EpipolarCost, IsTheErrorOfCoreInSigmas) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Rig rig = MixedRig(&random);
    const Pose pose = RandomPose(i, &random);
    const double sigma_px = random.Uniform(0.1, 3.0);
    for (const Match& m : UnrelatedMatches(rig, 9, &random)) {
      const double expected = SampsonError(pose, rig, m) / sigma_px;
      for (const Form& form : kForms) {
        for (const QuaternionOrder order : kOrders) {
          const auto cost = MakeCost(form, rig, m, sigma_px, order);
          const Blocks blocks = MakeBlocks(form, order, pose, rig, m, &random);
          double r = 0.0;
          ASSERT_TRUE(cost->Evaluate(blocks.Pointers().data(), &r, nullptr));
          EXPECT_NEAR(r, expected, 1e-9 * (1 + std::abs(expected))) << Name(form, m, order);
        }
      }
    }
  }
}

// Each block relative to itself. The position of the camera of an intra-camera match is the
// exception: with little rotation its derivative is the small difference of those at the two times,
// and is held against these.
TEST(EpipolarCost, JacobianMatchesAutomaticDifferentiation) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Rig rig = MixedRig(&random);
    const Pose pose = RandomPose(i, &random);
    const double sigma_px = random.Uniform(0.1, 3.0);
    for (const Match& m : UnrelatedMatches(rig, 9, &random)) {
      for (const Form& form : kForms) {
        for (const QuaternionOrder order : kOrders) {
          const Blocks blocks = MakeBlocks(form, order, pose, rig, m, &random);
          const Row row = Evaluate(*MakeCost(form, rig, m, sigma_px, order), blocks);
          const Row twin = Evaluate(*MakeTwin({form, order, rig, m, sigma_px}, blocks), blocks);
          EXPECT_NEAR(row.residual, twin.residual, 1e-9 * (1 + std::abs(twin.residual)));
          for (int k = 0; k < blocks.size(); ++k) {
            const bool difference = form.extrinsics && m.IsIntra() && k == blocks.size() - 1;
            const double size = difference ? twin.blocks[1].norm() : twin.blocks[k].norm();
            const double error = (row.blocks[k] - twin.blocks[k]).norm() / size;
            EXPECT_LT(error, 1e-10) << Name(form, m, order) << ", pose " << i << ", block " << k;
          }
        }
      }
    }
  }
}

TEST(EpipolarCost, JacobianPassesGradientChecker) {
  Random random(4);
  // The first step is 32 times this number: with Ceres' own, 0.32, too long for a quaternion.
  ceres::NumericDiffOptions numeric;
  numeric.ridders_relative_initial_step_size = 1e-4;
  for (int i = 0; i < 200; ++i) {
    const Rig rig = MixedRig(&random);
    const Pose pose = RandomPose(i, &random);
    std::vector<Match> matches = UnrelatedMatches(rig, 9, &random);
    for (const Match& m : {matches[i % 3 * 4], matches[1 + i % 2]}) {
      for (const Form& form : kForms) {
        for (const QuaternionOrder order : kOrders) {
          // With little rotation the derivative by the position of an intra-camera match's camera
          // is a small difference, which numeric differentiation does not resolve: left to the test
          // above.
          if (form.extrinsics && m.IsIntra() && i % 3 == 0) continue;
          const Blocks blocks = MakeBlocks(form, order, pose, rig, m, &random);
          const auto cost = MakeCost(form, rig, m, 0.5, order);
          const auto manifold = MakeManifold(order);
          std::vector<const ceres::Manifold*> manifolds(blocks.size(), nullptr);
          for (int k = 0; k < blocks.size(); k += 2) manifolds[k] = manifold.get();
          const ceres::GradientChecker checker(cost.get(), &manifolds, numeric);
          // Without its results: Eigen memory of Ceres' library is not to be freed by a program
          // under AddressSanitizer, where Eigen allocates in another way.
          EXPECT_TRUE(checker.Probe(blocks.Pointers().data(), 1e-6, nullptr))
              << Name(form, m, order) << ", pose " << i;
        }
      }
    }
  }
}

TEST(EpipolarCost, WorksWithAnyLens) {
  Random random(14);
  ceres::NumericDiffOptions numeric;
  numeric.ridders_relative_initial_step_size = 1e-4;
  for (int number = 0; number < 18; ++number) {
    const LensRig lenses = MakeLensRig(number, &random);
    const Pose pose = RandomPose(2, &random);
    for (const Match& m : UnrelatedLensMatches(lenses, 9, &random)) {
      const double expected = SampsonError(pose, lenses.rig, m) / 0.5;
      for (const Form& form : kForms) {
        const QuaternionOrder order = kOrders[number % 2];
        const Blocks blocks = MakeBlocks(form, order, pose, lenses.rig, m, &random);
        const auto cost = MakeCost(form, lenses.rig, m, 0.5, order);
        ASSERT_NE(cost, nullptr);
        double r = 0.0;
        ASSERT_TRUE(cost->Evaluate(blocks.Pointers().data(), &r, nullptr));
        EXPECT_NEAR(r, expected, 1e-9 * (1 + std::abs(expected)));
        const auto manifold = MakeManifold(order);
        std::vector<const ceres::Manifold*> manifolds(blocks.size(), nullptr);
        for (int k = 0; k < blocks.size(); k += 2) manifolds[k] = manifold.get();
        const ceres::GradientChecker checker(cost.get(), &manifolds, numeric);
        EXPECT_TRUE(checker.Probe(blocks.Pointers().data(), 1e-5, nullptr))
            << Name(form, m, order) << ", rig " << number;
      }
    }
  }
}

TEST(EpipolarCost, APixelWithoutARayHasNone) {
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].intrinsics = {CameraModel::kOpencvFisheye, {300, 300, 320, 240}, 640, 480};
  Match m;
  m.pixel1 = m.pixel2 = {320, 240};
  EXPECT_NE(MakeCost(kForms[0], rig, m, 1.0, QuaternionOrder::kCeres), nullptr);
  m.pixel2.x() += 300 * 3.2;
  EXPECT_EQ(MakeCost(kForms[0], rig, m, 1.0, QuaternionOrder::kCeres), nullptr);
}

// The residual does not depend on the length of q, so along q its derivative is zero.
TEST(EpipolarCost, JacobianIsZeroAlongTheQuaternion) {
  Random random(5);
  const Rig rig = MixedRig(&random);
  const Form form = {true, true};
  for (const Match& m : UnrelatedMatches(rig, 9, &random)) {
    for (const QuaternionOrder order : kOrders) {
      const Blocks blocks = MakeBlocks(form, order, RandomPose(2, &random), rig, m, &random);
      const Row row = Evaluate(*MakeCost(form, rig, m, 1.0, order), blocks);
      for (int k = 0; k < blocks.size(); k += 2) {
        const Eigen::Map<const Eigen::Vector4d> q(blocks.Pointers()[k]);
        EXPECT_LT(std::abs(row.blocks[k].dot(q)), 1e-13 * row.blocks[k].norm() * q.norm());
      }
    }
  }
}

// Ceres asks for the blocks that are not constant only.
TEST(EpipolarCost, WritesTheBlocksThatAreAskedForOnly) {
  Random random(6);
  const Rig rig = MixedRig(&random);
  const Match m = UnrelatedMatches(rig, 9, &random)[1];
  const Form form = {true, true};
  const Blocks blocks =
      MakeBlocks(form, QuaternionOrder::kCeres, RandomPose(2, &random), rig, m, &random);
  const auto cost = MakeCost(form, rig, m, 1.0, QuaternionOrder::kCeres);
  const Row row = Evaluate(*cost, blocks);
  for (int k = 0; k < blocks.size(); ++k) {
    std::vector<double*> jacobians(blocks.size(), nullptr);
    Eigen::VectorXd alone(blocks.block_size(k));
    jacobians[k] = alone.data();
    double r = 0.0;
    ASSERT_TRUE(cost->Evaluate(blocks.Pointers().data(), &r, jacobians.data()));
    EXPECT_EQ(r, row.residual);
    EXPECT_EQ(alone, row.blocks[k]);
  }
}

void ExpectZero(const Rig& rig, const Match& m, const Pose& pose, Random* random) {
  for (const Form& form : kForms) {
    for (const QuaternionOrder order : kOrders) {
      const Row row = Evaluate(*MakeCost(form, rig, m, 0.5, order),
                               MakeBlocks(form, order, pose, rig, m, random));
      EXPECT_EQ(row.residual, 0.0) << Name(form, m, order);
      EXPECT_EQ(row.norm(), 0.0) << Name(form, m, order);
    }
  }
}

// Anywhere in the world, where the motion is what rounding leaves of it.
TEST(EpipolarCost, IsZeroAtTheEpipoles) {
  Random random(7);
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].intrinsics = Camera::Pinhole(400, 420, 320, 240, 640, 480);
  rig.cameras[1].intrinsics = Camera::Pinhole(500, 450, 310, 250, 640, 480);
  Pose forward;
  forward.t = {0, 0, -1};
  Match intra, inter;
  intra.pixel1 = intra.pixel2 = inter.pixel1 = {320, 240};
  inter.camera2 = 1;
  inter.pixel2 = {310, 250};
  for (const Match& m : {intra, inter}) {
    ExpectZero(rig, m, forward, nullptr);
    for (int i = 0; i < 100; ++i) ExpectZero(rig, m, forward, &random);
  }
}

// There is no residual, and a problem that starts there must not end as converged.
TEST(EpipolarCost, FailsToEvaluateWhereEVanishes) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    const Rig rig = MixedRig(&random);
    for (const Match& m : UnrelatedMatches(rig, 9, &random)) {
      // The zero motion; for inter-camera matches a turn that takes camera j to where i was.
      Pose pose;
      if (!m.IsIntra()) {
        pose.R = ExpSO3(RandomVector3(0.0, kPi, &random));
        pose.t = rig.cameras[m.camera2].s - pose.R * rig.cameras[m.camera1].s;
      }
      for (Random* world : {static_cast<Random*>(nullptr), &random}) {
        for (const Form& form : kForms) {
          for (const QuaternionOrder order : kOrders) {
            const auto cost = MakeCost(form, rig, m, 0.5, order);
            const Blocks blocks = MakeBlocks(form, order, pose, rig, m, world);
            double residual = 0.0;
            EXPECT_FALSE(cost->Evaluate(blocks.Pointers().data(), &residual, nullptr))
                << Name(form, m, order);
          }
        }
      }
    }
  }
}

TEST(EpipolarCost, TwoEqualPosesAreNoUsableStart) {
  SceneOptions scene;
  scene.num_matches = 60;
  FramePair pair;
  std::string error;
  for (const double inter_share : {0.0, 0.5}) {
    scene.inter_share = inter_share;
    ASSERT_TRUE(MakeScenePair(scene, 3, &pair, &error)) << error;
    const auto solve = [&](double apart, double* end) {
      double q[2][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}}, p[2][3] = {{0, 0, 0}, {0, 0, apart}};
      ceres::Problem problem;
      for (double* pose : q) problem.AddParameterBlock(pose, 4, new ceres::QuaternionManifold);
      for (const Match& m : pair.matches) {
        problem.AddResidualBlock(
            MakeAbsoluteEpipolarCost(pair.rig, m, 0.5, QuaternionOrder::kCeres),
            new ceres::CauchyLoss(2.0), q[0], p[0], q[1], p[1]);
      }
      problem.SetParameterBlockConstant(q[0]);
      problem.SetParameterBlockConstant(p[0]);
      ceres::Solver::Options options;
      options.logging_type = ceres::SILENT;
      ceres::Solver::Summary summary;
      ceres::Solve(options, &problem, &summary);
      *end = summary.final_cost;
      return summary.IsSolutionUsable();
    };
    double end = 0.0;
    EXPECT_FALSE(solve(0.0, &end)) << inter_share;
    // A start that is roughly right moves.
    EXPECT_TRUE(solve(-0.8, &end)) << inter_share;
    EXPECT_LT(end, 1.5 * scene.num_matches) << inter_share;
  }
}

// The limits must be reached without overflow on the way.
TEST(EpipolarCost, StaysFiniteBesideTheEpipoleAndBesideZero) {
  Rig rig;
  rig.cameras.resize(1);
  rig.cameras[0].intrinsics = Camera::Pinhole(400, 420, 0, 0, 640, 480);
  const Form form = {false, false};
  for (double size = 1.0; size > 1e-300; size *= 1e-3) {
    Match beside, away;
    beside.pixel1 = {size, 2 * size};
    beside.pixel2 = {-3 * size, size};
    away.pixel1 = {100, 20};
    away.pixel2 = {-30, 50};
    Pose forward, tiny;
    forward.t = {0, 0, 1};
    tiny.t = size * Eigen::Vector3d(1, 2, 3);
    for (const QuaternionOrder order : kOrders) {
      const Row row = Evaluate(*MakeCost(form, rig, beside, 1.0, order),
                               MakeBlocks(form, order, forward, rig, beside, nullptr));
      EXPECT_LE(std::abs(row.residual), 10 * size);  // the nearest exact match is there
      EXPECT_TRUE(std::isfinite(row.norm())) << size;
      // The length of the baseline does not enter.
      const Row zero = Evaluate(*MakeCost(form, rig, away, 1.0, order),
                                MakeBlocks(form, order, tiny, rig, away, nullptr));
      EXPECT_NEAR(zero.residual, SampsonError(Pose{tiny.R, {1, 2, 3}}, rig, away), 1e-9) << size;
      EXPECT_TRUE(zero.blocks[0].allFinite() && zero.blocks[1].allFinite()) << size;
    }
  }
}

TEST(EpipolarCost, RefusesParametersThatAreNoPoses) {
  Random random(9);
  const Rig rig = MixedRig(&random);
  const Pose pose = RandomPose(2, &random);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto accepts = [](const ceres::CostFunction& cost, const Blocks& blocks) {
    double r = 0.0;
    return cost.Evaluate(blocks.Pointers().data(), &r, nullptr);
  };
  const std::vector<Match> matches = UnrelatedMatches(rig, 9, &random);
  for (const Match& m : {matches[0], matches[1]}) {
    for (const Form& form : kForms) {
      for (const QuaternionOrder order : kOrders) {
        const auto cost = MakeCost(form, rig, m, 1.0, order);
        const Blocks good = MakeBlocks(form, order, pose, rig, m, &random);
        EXPECT_TRUE(accepts(*cost, good));
        for (int k = 0; k < good.size(); ++k) {
          for (int n = 0; n < good.block_size(k); ++n) {
            for (const double value : {kNan, kInf, -kInf}) {
              Blocks bad = good;
              bad.data(k)[n] = value;
              EXPECT_FALSE(accepts(*cost, bad)) << Name(form, m, order) << ", block " << k;
            }
          }
          Blocks zero = good;
          std::fill_n(zero.data(k), zero.block_size(k), 0.0);
          EXPECT_EQ(accepts(*cost, zero), k % 2 == 1) << Name(form, m, order) << ", block " << k;
        }
      }
    }
  }
}

TEST(EpipolarCost, BadArgumentsGiveNull) {
  Random random(10);
  const Rig rig = MixedRig(&random);
  const Match good = UnrelatedMatches(rig, 2, &random)[1];
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr QuaternionOrder kOrder = QuaternionOrder::kEigen;
  for (const Form& form : kForms) {
    EXPECT_NE(MakeCost(form, rig, good, 1.0, kOrder), nullptr);
    for (const double sigma : {0.0, -0.0, -1.0, 1e-320, kNan, kInf, -kInf}) {
      EXPECT_EQ(MakeCost(form, rig, good, sigma, kOrder), nullptr) << sigma;
    }
    for (const int camera : {-1, 3, std::numeric_limits<int>::min()}) {
      Match first = good, second = good;
      first.camera1 = camera;
      second.camera2 = camera;
      EXPECT_EQ(MakeCost(form, rig, first, 1.0, kOrder), nullptr) << camera;
      EXPECT_EQ(MakeCost(form, rig, second, 1.0, kOrder), nullptr) << camera;
    }
    for (const double value : {kNan, kInf}) {
      for (int n = 0; n < 2; ++n) {
        Match first = good, second = good;
        first.pixel1(n) = value;
        second.pixel2(n) = value;
        EXPECT_EQ(MakeCost(form, rig, first, 1.0, kOrder), nullptr);
        EXPECT_EQ(MakeCost(form, rig, second, 1.0, kOrder), nullptr);
      }
    }
    Rig focal = rig, rotation = rig;
    focal.cameras[0].intrinsics.parameters[0] = 0.0;
    rotation.cameras[0].Q *= 2.0;
    EXPECT_EQ(MakeCost(form, focal, good, 1.0, kOrder), nullptr);
    EXPECT_EQ(MakeCost(form, rotation, good, 1.0, kOrder), nullptr);
    EXPECT_EQ(MakeCost(form, Rig(), Match(), 1.0, kOrder), nullptr);
    EXPECT_EQ(MakeCost(form, rig, good, 1.0, static_cast<QuaternionOrder>(7)), nullptr);
  }
}

// Three body poses and the noise-free matches, intra- and inter-camera, of each two of them.
struct Graph {
  Rig rig;
  std::vector<Pose> w_b;
  struct Edge {
    int from, to;
    std::vector<Match> matches;
  };
  std::vector<Edge> edges;
};

Graph MakeGraph(int number, Random* random) {
  Graph graph;
  graph.w_b.resize(3);
  graph.w_b[0].R = ExpSO3(RandomVector3(0.0, kPi, random));
  graph.w_b[0].t = RandomVector3(0.0, 100.0, random);
  for (int k = 1; k < 3; ++k) {
    Pose step;  // pose k in the frame of pose k - 1: a metre forwards
    step.R = ExpSO3(RandomVector3(DegToRad(0.5), DegToRad(3.0), random));
    step.t = Eigen::Vector3d(0, 0, 1) + 0.1 * random->UnitVector3();
    graph.w_b[k] = graph.w_b[k - 1] * step;
  }
  SceneOptions options;
  options.noise_px = 0.0;
  options.num_matches = 60;
  options.inter_share = 0.5;
  for (const auto& [from, to] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 2)}) {
    const Pose truth = graph.w_b[to].Inverse() * graph.w_b[from];
    FramePair pair = ScenePair(options, number, truth);
    // The rig is that of the scene's number, whatever the motion.
    if (graph.rig.size() > 0) {
      EXPECT_EQ(pair.rig.cameras[1].s, graph.rig.cameras[1].s);
    }
    graph.rig = pair.rig;
    graph.edges.push_back({from, to, pair.matches});
  }
  return graph;
}

TEST(EpipolarCost, APoseGraphFindsTheTruth) {
  Random random(11);
  for (int number = 0; number < 10; ++number) {
    const Graph graph = MakeGraph(number, &random);
    for (const QuaternionOrder order : kOrders) {
      Blocks poses(order);
      for (int k = 0; k < 3; ++k) {
        const Pose start = k == 0 ? graph.w_b[0] : StartNear(graph.w_b[k], 1.0, 0.0, &random);
        const double off = k == 0 ? 0.0 : 0.1;
        poses.Add(start.R, start.t + off * random.UnitVector3());
      }
      ceres::Problem problem;
      for (int k = 0; k < 6; k += 2) {
        problem.AddParameterBlock(poses.data(k), 4, MakeManifold(order).release());
        problem.AddParameterBlock(poses.data(k + 1), 3);
      }
      for (const Graph::Edge& edge : graph.edges) {
        for (const Match& m : edge.matches) {
          ceres::CostFunction* cost = MakeAbsoluteEpipolarCost(graph.rig, m, 0.5, order);
          ASSERT_NE(cost, nullptr);
          problem.AddResidualBlock(cost, new ceres::HuberLoss(1.0), poses.data(2 * edge.from),
                                   poses.data(2 * edge.from + 1), poses.data(2 * edge.to),
                                   poses.data(2 * edge.to + 1));
        }
      }
      problem.SetParameterBlockConstant(poses.data(0));
      problem.SetParameterBlockConstant(poses.data(1));
      ceres::Solver::Options options;
      options.num_threads = 2;
      options.logging_type = ceres::SILENT;
      options.max_num_iterations = 100;
      options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-14;
      ceres::Solver::Summary summary;
      ceres::Solve(options, &problem, &summary);
      EXPECT_TRUE(summary.IsSolutionUsable()) << summary.BriefReport();
      for (int k = 1; k < 3; ++k) {
        const Pose found = poses.PoseAt(k);
        EXPECT_LT(RotationError(graph.w_b[k].R, found.R), 1e-9) << "graph " << number;
        EXPECT_LT((graph.w_b[k].t - found.t).norm(), 1e-8) << "graph " << number;
      }
    }
  }
}

// The pose of camera 1 on the body from the matches of known motions; camera 0 and the poses fixed.
TEST(EpipolarCost, ACalibrationFindsTheTruth) {
  Random random(12);
  for (int number = 0; number < 10; ++number) {
    const Graph graph = MakeGraph(number, &random);
    const RigCamera& truth = graph.rig.cameras[1];
    const QuaternionOrder order = kOrders[number % 2];
    Blocks poses(order);
    for (const Pose& pose : graph.w_b) poses.Add(pose.R, pose.t);
    poses.Add(graph.rig.cameras[0].Q, graph.rig.cameras[0].s);
    const Eigen::Matrix3d turn = ExpSO3(DegToRad(1.0) * random.UnitVector3());
    poses.Add(turn * truth.Q, truth.s + 0.05 * random.UnitVector3());
    ceres::Problem problem;
    for (int k = 0; k < poses.size(); k += 2) {
      problem.AddParameterBlock(poses.data(k), 4, MakeManifold(order).release());
      problem.AddParameterBlock(poses.data(k + 1), 3);
      if (k < 8) {
        problem.SetParameterBlockConstant(poses.data(k));
        problem.SetParameterBlockConstant(poses.data(k + 1));
      }
    }
    for (const Graph::Edge& edge : graph.edges) {
      for (const Match& m : edge.matches) {
        std::vector<double*> blocks;
        for (const int node : {edge.from, edge.to, 3 + m.camera1, 3 + m.camera2}) {
          blocks.push_back(poses.data(2 * node));
          blocks.push_back(poses.data(2 * node + 1));
        }
        if (m.IsIntra()) blocks.resize(6);
        ceres::CostFunction* cost =
            MakeAbsoluteEpipolarCostWithExtrinsics(graph.rig, m, 0.5, order);
        ASSERT_NE(cost, nullptr);
        problem.AddResidualBlock(cost, nullptr, blocks);
      }
    }
    ceres::Solver::Options options;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 100;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-14;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    const Pose found = poses.PoseAt(4);
    EXPECT_LT(RotationError(truth.Q, found.R), 1e-9) << summary.BriefReport();
    EXPECT_LT((truth.s - found.t).norm(), 1e-8) << summary.BriefReport();
  }
}

// A residual and its derivatives must not overflow.
TEST(EpipolarCost, SigmasOfNoMeaningAreRefused) {
  Random random(5);
  const Rig rig = MixedRig(&random);
  const Match match = UnrelatedMatches(rig, 9, &random)[0];
  for (const double sigma : {1e-308, 1e-13, 1e13, 1e308}) {
    EXPECT_EQ(MakeCost(kForms[0], rig, match, sigma, QuaternionOrder::kCeres), nullptr) << sigma;
  }
  EXPECT_NE(MakeCost(kForms[0], rig, match, 1e-12, QuaternionOrder::kCeres), nullptr);
}

}  // namespace
}  // namespace rigel
