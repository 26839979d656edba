// Every analytic Jacobian of the refinement against automatic differentiation of a twin: the chart
// of the motion and each residual written anew from the headers' words as templates, so that
// ceres::Jet differentiates residual and chart in one. Then the same cost functions through
// ceres::GradientChecker, and where the headers define a value by themselves.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/QR>

#include "rigel/minimal/alignment.h"
#include "rigel/minimal/grouped_matches.h"
#include "rigel/refine/epipolar_residuals.h"
#include "rigel/refine/motion_parameterization.h"
#include "rigel/refine/prior_residuals.h"
#include "rigel/refine/reprojection_cost.h"
#include "rigel/test/refine/jet_geometry.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {
namespace {

constexpr int kPoints = 200;
constexpr double kTolerance = 1e-10;        // relative
constexpr double kCheckerTolerance = 1e-6;  // relative, of each number

constexpr ResidualKind kKinds[] = {ResidualKind::kSampson, ResidualKind::kAngular,
                                   ResidualKind::kAlgebraic};
constexpr const char* kKindNames[] = {"Sampson", "angular", "algebraic"};
constexpr PriorKind kPriorKinds[] = {PriorKind::kNone, PriorKind::kVertical, PriorKind::kAxis,
                                     PriorKind::kPlanar};

// All forms go with both rotations: Set() takes every pair.
struct Form {
  RotationForm rotation;
  TranslationForm translation;
  const char* name;
  int size;
};
constexpr Form kForms[] = {
    {RotationForm::kFree, TranslationForm::kFree, "free, free", 6},
    {RotationForm::kFree, TranslationForm::kSphere, "free, sphere", 5},
    {RotationForm::kFree, TranslationForm::kInverseScale, "free, inverse scale", 6},
    {RotationForm::kFree, TranslationForm::kPlane, "free, plane", 5},
    {RotationForm::kFree, TranslationForm::kCircle, "free, circle", 4},
    {RotationForm::kFree, TranslationForm::kDepths, "free, depths", 5},
    {RotationForm::kFree, TranslationForm::kDepth, "free, depth", 4},
    {RotationForm::kFree, TranslationForm::kPlanarDepths, "free, planar depths", 4},
    {RotationForm::kFree, TranslationForm::kPlanarDepth, "free, planar depth", 3},
    {RotationForm::kAngle, TranslationForm::kFree, "angle, free", 4},
    {RotationForm::kAngle, TranslationForm::kSphere, "angle, sphere", 3},
    {RotationForm::kAngle, TranslationForm::kInverseScale, "angle, inverse scale", 4},
    {RotationForm::kAngle, TranslationForm::kPlane, "angle, plane", 3},
    {RotationForm::kAngle, TranslationForm::kCircle, "angle, circle", 2},
    {RotationForm::kAngle, TranslationForm::kDepths, "angle, depths", 3},
    {RotationForm::kAngle, TranslationForm::kDepth, "angle, depth", 2},
    {RotationForm::kAngle, TranslationForm::kPlanarDepths, "angle, planar depths", 2},
    {RotationForm::kAngle, TranslationForm::kPlanarDepth, "angle, planar depth", 1},
};

// The power series of the matrix exponential with halving and squaring: no angle, no quotient,
// nothing special at zero or at a half turn.
template <class T>
Matrix3<T> Exp(const Vector3<T>& w) {
  constexpr int kHalvings = 5;
  const Matrix3<T> W = Cross<T>(w) * T(1.0 / (1 << kHalvings));
  Matrix3<T> R = Matrix3<T>::Identity();
  for (int n = 12; n >= 1; --n) R = (Matrix3<T>::Identity() + W * R * T(1.0 / n)).eval();
  for (int n = 0; n < kHalvings; ++n) R = (R * R).eval();
  return R;
}

template <class T>
struct Motion {
  Matrix3<T> R;
  Vector3<T> t;
};

// Where a chart starts and what it takes as exact.
struct Start {
  Pose pose;
  Eigen::Vector3d n1, n2;  // the known direction in f1 and f2: R n1 = n2, n2 . t = 0
  Alignment alignment;
  RayPair reference;
};

// motion_parameterization.h in other formulas: rotations of t in place of cosines and tangents,
// distances from the cameras in place of depths from the feet.
class ChartTwin {
 public:
  ChartTwin(const Form& form, const Start& start) : form_(form), start_(start) {
    const Eigen::Vector3d& n = start.n2;
    R0_ = start.pose.R;
    if (form.rotation == RotationForm::kAngle) {
      // The largest trace of R0'Exp(a n) M over a, for any M with M n1 = n2.
      const Eigen::Matrix3d M = SmallestRotation(start.n1, n);
      const Eigen::Matrix3d B = M * R0_.transpose();
      const double a = std::atan2((Skew(n) * B).trace(), B.trace() - n.dot(B * n));
      R0_ = Exp<double>(a * n) * M;
    }
    t0_ = start.pose.t;
    switch (form.translation) {
      case TranslationForm::kFree:
        break;
      case TranslationForm::kSphere:
      case TranslationForm::kInverseScale:
        tangent_ = TangentBasis(t0_.normalized());
        break;
      case TranslationForm::kPlane:
        t0_ -= n * n.dot(t0_);
        tangent_ = TangentBasis(n);
        break;
      case TranslationForm::kCircle:
        t0_ = t0_.norm() * (t0_ - n * n.dot(t0_)).normalized();
        break;
      default:
        SetDepths();
    }
  }

  template <class T>
  Motion<T> operator()(const T* x) const {
    Motion<T> motion;
    const Vector3<T> n = start_.n2.cast<T>();
    if (form_.rotation == RotationForm::kFree) {
      motion.R = Exp<T>(Vector3<T>(x[0], x[1], x[2])) * R0_.cast<T>();
      x += 3;
    } else {
      motion.R = Exp<T>(n * x[0]) * R0_.cast<T>();
      x += 1;
    }
    const Vector3<T> t0 = t0_.cast<T>();
    switch (form_.translation) {
      case TranslationForm::kFree:
        motion.t = t0 + Vector3<T>(x[0], x[1], x[2]);
        break;
      case TranslationForm::kSphere:
      case TranslationForm::kInverseScale: {
        // Turned towards the tangent by its length.
        const Vector3<T> tangent = Along(x[0], x[1]);
        const Vector3<T> direction = t0_.normalized().cast<T>();
        motion.t = Exp<T>(direction.cross(tangent)) * t0;
        if (form_.translation == TranslationForm::kInverseScale) {
          T inverse = x[2] + T(1.0);
          if (inverse < T(1e-3)) inverse = T(1e-3);
          if (inverse > T(4.0)) inverse = T(4.0);
          motion.t = (motion.t / inverse).eval();
        }
        break;
      }
      case TranslationForm::kPlane:
        motion.t = t0 + Along(x[0], x[1]);
        break;
      case TranslationForm::kCircle:
        motion.t = Exp<T>(n * x[0]) * t0;
        break;
      default: {
        T d1 = T(distance_.x());
        T d2 = T(distance_.y());
        if (form_.translation == TranslationForm::kDepths) {
          d1 += x[0];
          d2 += x[1];
        } else if (form_.translation == TranslationForm::kDepth) {
          d2 += x[0];
        } else if (form_.translation == TranslationForm::kDepthsOnSphere) {
          // Along the level line of |t|.
          d1 += x[0] * T(across_.y());
          d2 -= x[0] * T(across_.x());
        } else if (form_.translation == TranslationForm::kPlanarDepths) {
          d1 += x[0] * T(along_line_.x());
          d2 += x[0] * T(along_line_.y());
        }
        const Ray& ray1 = start_.reference.ray1;
        const Ray& ray2 = start_.reference.ray2;
        const Vector3<T> X1 = ray1.s.cast<T>() + ray1.x.cast<T>() * d1;
        const Vector3<T> X2 = ray2.s.cast<T>() + ray2.x.cast<T>() * d2;
        motion.t = X2 - motion.R * X1;
        if (form_.translation == TranslationForm::kDepthsOnSphere ||
            form_.translation == TranslationForm::kPlanarDepthsOnSphere) {
          // |t + q v| = |t0|.
          const Vector3<T> v =
              ray2.x.cast<T>() * T(across_.y()) - motion.R * (ray1.x.cast<T>() * T(across_.x()));
          const T b = motion.t.dot(v);
          const T c = motion.t.squaredNorm() - T(t0_.squaredNorm());
          motion.t += v * ((sqrt(b * b - v.squaredNorm() * c) - b) / v.squaredNorm());
        }
      }
    }
    return motion;
  }

 private:
  template <class T>
  Vector3<T> Along(const T& a, const T& b) const {
    return tangent_.col(0).cast<T>() * a + tangent_.col(1).cast<T>() * b;
  }

  void SetDepths() {
    const Ray& ray1 = start_.reference.ray1;
    const Ray& ray2 = start_.reference.ray2;
    Eigen::Matrix<double, 3, 2> A;
    A << R0_ * ray1.x, -ray2.x;
    distance_ = A.colPivHouseholderQr().solve(ray2.s - R0_ * ray1.s - t0_);
    Eigen::Matrix<double, 3, 2> by_depth;
    by_depth << -(R0_ * ray1.x), ray2.x;
    const auto gradient = [&]() -> Eigen::Vector2d {
      const Eigen::Vector3d t = ray2.s - R0_ * ray1.s + by_depth * distance_;
      return by_depth.transpose() * t;
    };
    if (form_.translation != TranslationForm::kPlanarDepths &&
        form_.translation != TranslationForm::kPlanarDepth &&
        form_.translation != TranslationForm::kPlanarDepthsOnSphere) {
      across_ = gradient().normalized();
      return;
    }
    // The heights of the point over the plane at the two times are the same.
    const Eigen::Vector2d line(-start_.n1.dot(ray1.x), start_.n2.dot(ray2.x));
    const double difference = start_.n2.dot(ray2.s + distance_.y() * ray2.x) -
                              start_.n1.dot(ray1.s + distance_.x() * ray1.x);
    distance_ -= line * difference / line.squaredNorm();
    along_line_ = Eigen::Vector2d(line.y(), -line.x()).normalized();
    across_ = gradient().dot(along_line_) < 0 ? -along_line_ : along_line_;
  }

  Form form_;
  Start start_;
  Eigen::Matrix3d R0_;
  Eigen::Vector3d t0_;
  Eigen::Matrix<double, 3, 2> tangent_ = Eigen::Matrix<double, 3, 2>::Zero();
  Eigen::Vector2d distance_ = Eigen::Vector2d::Zero();  // from the cameras
  Eigen::Vector2d along_line_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d across_ = Eigen::Vector2d::Zero();
};

// epipolar_residuals.h.
template <class T>
T EpipolarTwin(ResidualKind kind, const Motion<T>& motion, const Rig& rig, const Match& m) {
  using std::sqrt;
  const RigCamera& i = rig.cameras[m.camera1];
  const RigCamera& j = rig.cameras[m.camera2];
  // C as a triple product in f2, its derivatives by the two directions in the camera frames.
  const Vector3<T> b = motion.R * i.s.cast<T>() + motion.t - j.s.cast<T>();
  const bool pixels = kind == ResidualKind::kSampson;
  const Eigen::Vector3d u_i = i.intrinsics.Normalize(m.pixel1);
  const Eigen::Vector3d u_j = j.intrinsics.Normalize(m.pixel2);
  const Eigen::Vector3d v_i = pixels ? u_i : u_i.normalized();
  const Eigen::Vector3d v_j = pixels ? u_j : u_j.normalized();
  const Vector3<T> y = motion.R * (i.Q * v_i).cast<T>();
  const Vector3<T> z = (j.Q * v_j).cast<T>();
  const T C = z.dot(b.cross(y));
  if (kind == ResidualKind::kAlgebraic) return C;
  const Vector3<T> by_j = j.Q.transpose().cast<T>() * b.cross(y);
  const Vector3<T> by_i = i.Q.transpose().cast<T>() * (motion.R.transpose() * z.cross(b));
  if (pixels) {
    const T gradient2 = by_i.x() * by_i.x() / T(i.intrinsics.fx * i.intrinsics.fx) +
                        by_i.y() * by_i.y() / T(i.intrinsics.fy * i.intrinsics.fy) +
                        by_j.x() * by_j.x() / T(j.intrinsics.fx * j.intrinsics.fx) +
                        by_j.y() * by_j.y() / T(j.intrinsics.fy * j.intrinsics.fy);
    return C / sqrt(gradient2);
  }
  // On the sphere: the parts of the derivatives across the rays.
  const Vector3<T> across_i = v_i.cast<T>().cross(by_i);
  const Vector3<T> across_j = v_j.cast<T>().cross(by_j);
  const double focal =
      (i.intrinsics.fx + i.intrinsics.fy + j.intrinsics.fx + j.intrinsics.fy) / 4.0;
  return C / sqrt(across_i.squaredNorm() + across_j.squaredNorm()) * T(focal);
}

// prior_residuals.h: the direction's, the normal's, the distance's; a part without sigma is none.
template <class T>
std::vector<T> PriorTwin(const MotionPrior& prior, PriorKind kind, const Pose& start,
                         const Motion<T>& motion) {
  using std::sqrt;
  std::vector<T> residuals;
  // The library goes on with the chord of 3 radians beyond it, which the header does not say.
  const double angle = std::clamp(Eigen::AngleAxisd(start.R).angle(), kMinAxisAngle, 3.0);
  const double chord = 2.0 * std::sin(angle / 2.0);
  const auto direction = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, double sigma) {
    const Vector3<T> off = motion.R * from.cast<T>() - to.cast<T>();
    const Eigen::Matrix<double, 3, 2> across = TangentBasis(to);
    for (int k = 0; k < 2; ++k) residuals.push_back(across.col(k).cast<T>().dot(off) / T(sigma));
  };
  if (kind == PriorKind::kVertical) {
    direction(*prior.gravity1, *prior.gravity2, std::sqrt(2.0) * *prior.gravity_sigma);
  } else if (kind == PriorKind::kAxis) {
    direction(*prior.axis, *prior.axis, chord * *prior.axis_sigma);
  } else if (kind == PriorKind::kPlanar) {
    direction(*prior.normal, *prior.normal, chord * *prior.normal_sigma);
    if (start.t.norm() > 0) {
      residuals.push_back(prior.normal->cast<T>().dot(motion.t) /
                          T(start.t.norm() * *prior.normal_sigma));
    }
  }
  if (prior.distance_sigma > 0) {
    residuals.push_back((sqrt(motion.t.squaredNorm()) - T(*prior.distance)) /
                        T(prior.distance_sigma));
  }
  return residuals;
}

// reprojection_cost.h: the point as homogeneous coordinates (X, rho) in each frame in turn.
template <class T>
Eigen::Matrix<T, 4, 1> ReprojectionTwin(const Rig& rig, const Match& m, double weight,
                                        const Motion<T>& motion, const Vector3<T>& point) {
  const RigCamera& i = rig.cameras[m.camera1];
  const RigCamera& j = rig.cameras[m.camera2];
  const PinholeCamera& a = i.intrinsics;
  const PinholeCamera& b = j.intrinsics;
  const T& rho = point.z();
  const Vector3<T> in_camera1((point.x() + T(m.pixel1.x() - a.cx)) / T(a.fx),
                              (point.y() + T(m.pixel1.y() - a.cy)) / T(a.fy), T(1.0));
  const Vector3<T> in_f1 = i.Q.cast<T>() * in_camera1 + i.s.cast<T>() * rho;
  const Vector3<T> in_f2 = motion.R * in_f1 + motion.t * rho;
  const Vector3<T> in_camera2 = j.Q.transpose().cast<T>() * (in_f2 - j.s.cast<T>() * rho);
  Eigen::Matrix<T, 4, 1> r;
  r << point.x(), point.y(), in_camera2.x() / in_camera2.z() * T(b.fx) + T(b.cx - m.pixel2.x()),
      in_camera2.y() / in_camera2.z() * T(b.fy) + T(b.cy - m.pixel2.y());
  return r * T(weight);
}

// 0: near zero, 1: near a half turn, 2: in between.
double Angle(int regime, Random* random) {
  const double near = std::pow(10.0, random->Uniform(-9.0, -2.0));
  return regime == 0 ? near : regime == 1 ? kPi - near : random->Uniform(0.1, 3.0);
}

struct Point {
  int number = 0;
  Rig rig;
  std::vector<Match> matches;  // one of each camera pair
  Start start;
};

// Rotations of all three sizes in turn; a start off the prior, the plane and the reference.
Point MakePoint(int number) {
  Random random = Random::Stream(131, number);
  Point p;
  p.number = number;
  p.rig = MixedRig(&random);
  p.matches = UnrelatedMatches(p.rig, 9, &random);
  Pose exact;
  exact.R = ExpSO3(Angle(number % 3, &random) * random.UnitVector3());
  exact.t = random.Uniform(0.3, 3.0) * random.UnitVector3();
  p.start.pose = StartNear(exact, 3.0, 0.1, &random);
  if (number % 3 != 2) p.start.pose.R = exact.R;
  MotionPrior prior;
  PriorKind kind = PriorKind::kVertical;
  if (number % 2 == 0) {
    p.start.n1 = random.UnitVector3();
    p.start.n2 = ExpSO3(0.05 * random.UnitVector3()) * exact.R * p.start.n1;
    prior.gravity1 = p.start.n1;
    prior.gravity2 = p.start.n2;
  } else {
    kind = PriorKind::kPlanar;
    const Eigen::Vector3d axis = LogSO3(exact.R).normalized();
    p.start.n1 = p.start.n2 = ExpSO3(0.05 * random.UnitVector3()) * axis;
    prior.normal = p.start.n1;
  }
  std::string error;
  EXPECT_TRUE(MakeAlignment(prior, kind, &p.start.alignment, &error)) << error;
  RayPair& reference = p.start.reference;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    reference.ray1.s = p.rig.cameras[random.Index(3)].s;
    reference.ray2.s = p.rig.cameras[random.Index(3)].s;
    reference.ray1.x = random.UnitVector3();
    const Eigen::Vector3d X1 = reference.ray1.s + random.Uniform(2.0, 10.0) * reference.ray1.x;
    reference.ray2.x = (exact * X1 - reference.ray2.s).normalized();
    // Of a parallax and a height that determine its depths.
    const double parallax = (p.start.pose.R * reference.ray1.x).cross(reference.ray2.x).norm();
    if (parallax > 0.1 && std::abs(p.start.n1.dot(reference.ray1.x)) > 0.1) return p;
  }
  ADD_FAILURE() << "no reference";
  return p;
}

using Parameters = std::array<double, 6>;

// Nonzero, and angles of every size; every tenth inverse scale is out of its bounds if `any_scale`.
Parameters RandomParameters(const Form& form, int number, bool any_scale, Random* random) {
  Parameters x{};
  int n = 0;
  const double sign = random->Index(2) == 0 ? 1.0 : -1.0;
  const double turn = sign * Angle((number / 3) % 3, random);
  if (form.rotation == RotationForm::kFree) {
    Eigen::Vector3d::Map(x.data()) = turn * random->UnitVector3();
    n = 3;
  } else {
    x[0] = turn;
    n = 1;
  }
  for (int k = n; k < form.size; ++k) {
    x[k] = (random->Index(2) == 0 ? 1.0 : -1.0) * random->Uniform(0.01, 0.8);
  }
  const double bend = Angle((number / 9) % 3, random);
  switch (form.translation) {
    case TranslationForm::kInverseScale:
      x[n + 2] = random->Uniform(-0.7, 2.5);
      if (any_scale && number % 10 == 7) x[n + 2] = number % 20 == 7 ? 3.5 : -1.5;
      [[fallthrough]];
    case TranslationForm::kSphere: {
      const double at = random->Uniform(0.0, 2.0 * kPi);
      x[n] = bend * std::cos(at);
      x[n + 1] = bend * std::sin(at);
      break;
    }
    case TranslationForm::kCircle:
      x[n] = sign * bend;
      break;
    default:
      break;
  }
  return x;
}

// The parameters as Jets whose derivatives begin at number 0.
template <class Jet>
std::array<Jet, 6> ToJets(const Parameters& x, int size) {
  std::array<Jet, 6> jets;
  for (int k = 0; k < 6; ++k) jets[k] = k < size ? Jet(x[k], k) : Jet(0.0);
  return jets;
}

// The largest error and where it was.
class Worst {
 public:
  template <class Where>
  void Add(double error, const Where& where) {
    ++count_;
    if (!std::isfinite(error)) error = std::numeric_limits<double>::infinity();
    if (error <= value_) return;
    value_ = error;
    where_ = where();
  }

  // Also as a property of the test, for --gtest_output.
  void Expect(const std::string& name, double tolerance, int count) const {
    testing::Test::RecordProperty(
        name, testing::PrintToString(value_) + " of " + std::to_string(count_) + ", " + where_);
    EXPECT_LT(value_, tolerance) << name << ": " << where_;
    EXPECT_EQ(count_, count) << name;
  }

 private:
  int count_ = 0;
  double value_ = 0.0;
  std::string where_;
};

template <class A, class B>
double RelativeError(const A& a, const B& expected) {
  const double error = (a - expected).norm();
  return error == 0.0 ? 0.0 : error / expected.norm();
}

std::string At(const Form& form, int point) {
  return std::string(form.name) + ", point " + std::to_string(point);
}

std::string At(const Match& m) {
  return std::string(m.IsIntra() ? ", intra " : ", inter ") + std::to_string(m.camera1) +
         std::to_string(m.camera2);
}

// R <- Exp(d) R, t <- t + e at d = e = 0: derivatives 0 to 5.
template <class Jet>
Motion<Jet> PerturbedJets(const Pose& pose) {
  Motion<Jet> motion;
  Vector3<Jet> d;
  for (int k = 0; k < 3; ++k) {
    d(k) = Jet(0.0, k);
    motion.t(k) = Jet(pose.t(k), 3 + k);
  }
  motion.R = Exp<Jet>(d) * pose.R.cast<Jet>();
  return motion;
}

// Pose and basis of the chart itself, each column relative to itself.
void CompareChart(const MotionParameterization& chart, const Form& form, const Start& start,
                  const Parameters& x, int number, Worst* values, Worst* derivatives) {
  using Jet = ceres::Jet<double, 6>;
  Pose pose;
  MotionBasis basis;
  chart.Evaluate(x.data(), &pose, &basis);
  const Motion<Jet> twin = ChartTwin(form, start)(ToJets<Jet>(x, form.size).data());
  Pose expected;
  for (int r = 0; r < 3; ++r) {
    expected.t(r) = twin.t(r).a;
    for (int c = 0; c < 3; ++c) expected.R(r, c) = twin.R(r, c).a;
  }
  values->Add((pose.R - expected.R).norm() + RelativeError(pose.t, expected.t),
              [&] { return At(form, number); });
  for (int k = 0; k < form.size; ++k) {
    Eigen::Matrix3d dR;
    Vector6d column;
    for (int r = 0; r < 3; ++r) {
      column(3 + r) = twin.t(r).v(k);
      for (int c = 0; c < 3; ++c) dR(r, c) = twin.R(r, c).v(k);
    }
    const Eigen::Matrix3d W = dR * expected.R.transpose();
    column.head<3>() << W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1);
    column.head<3>() *= 0.5;
    derivatives->Add(RelativeError(basis.col(k), column),
                     [&] { return At(form, number) + ", column " + std::to_string(k); });
  }
}

TEST(Jacobian, ChartMatchesAutomaticDifferentiation) {
  Worst values, derivatives;
  int columns = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(132, i);
    for (const Form& form : kForms) {
      MotionParameterization chart;
      ASSERT_TRUE(chart.Set(form.rotation, form.translation, p.start.pose, p.start.alignment,
                            p.start.reference));
      ASSERT_EQ(chart.size(), form.size) << form.name;
      const Parameters x = RandomParameters(form, i, true, &random);
      CompareChart(chart, form, p.start, x, i, &values, &derivatives);
      columns += form.size;
    }
  }
  values.Expect("values", kTolerance, kPoints * 18);
  derivatives.Expect("derivatives", kTolerance, columns);
}

// Where |t| is held there are depths near a start of the form only: its rotation is of any size,
// the way from it is short.
TEST(Jacobian, DepthsOnTheSphereMatchAutomaticDifferentiation) {
  constexpr Form kOnSphere[] = {
      {RotationForm::kFree, TranslationForm::kDepthsOnSphere, "free, depths on the sphere", 4},
      {RotationForm::kAngle, TranslationForm::kDepthsOnSphere, "angle, depths on the sphere", 2},
      {RotationForm::kFree, TranslationForm::kPlanarDepthsOnSphere, "free, planar", 3},
      {RotationForm::kAngle, TranslationForm::kPlanarDepthsOnSphere, "angle, planar", 1}};
  Worst values, derivatives;
  int columns = 0, compared = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(142, i);
    for (const Form& form : kOnSphere) {
      // A start of the form: the reference and, where it is exact, the prior hold.
      const bool planar = form.translation == TranslationForm::kPlanarDepthsOnSphere;
      const auto free_form = planar ? TranslationForm::kPlanarDepths : TranslationForm::kDepths;
      const Parameters zero{};
      Start start = p.start;
      MotionParameterization chart;
      ASSERT_TRUE(
          chart.Set(form.rotation, free_form, start.pose, start.alignment, start.reference));
      chart.Evaluate(zero.data(), &start.pose, nullptr);
      const bool set =
          chart.Set(form.rotation, form.translation, start.pose, start.alignment, start.reference);
      if (!set) continue;
      ASSERT_EQ(chart.size(), form.size) << form.name;
      Parameters x{};
      for (int k = 0; k < form.size; ++k) {
        x[k] = std::pow(10.0, random.Uniform(-9.0, -2.5)) * (k % 2 == 0 ? 1.0 : -1.0);
      }
      Pose at;
      chart.Evaluate(x.data(), &at, nullptr);
      const double length = start.pose.t.norm();
      if (std::abs(at.t.norm() - length) > 1e-9 * length) continue;
      CompareChart(chart, form, start, x, i, &values, &derivatives);
      columns += form.size;
      ++compared;
    }
  }
  EXPECT_GT(compared, kPoints * 4 * 9 / 10);
  values.Expect("values", kTolerance, compared);
  derivatives.Expect("derivatives", kTolerance, columns);
}

// Residual and chart in one: relative to the gradient of the match.
TEST(Jacobian, EpipolarResidualsMatchAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 6>;
  Worst values[3], derivatives[3];
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    const GroupedMatches matches(p.rig, p.matches);
    Random random = Random::Stream(133, i);
    for (const Form& form : kForms) {
      MotionParameterization chart;
      ASSERT_TRUE(chart.Set(form.rotation, form.translation, p.start.pose, p.start.alignment,
                            p.start.reference));
      const Parameters x = RandomParameters(form, i, true, &random);
      Pose pose;
      MotionBasis basis;
      chart.Evaluate(x.data(), &pose, &basis);
      const Motion<Jet> twin = ChartTwin(form, p.start)(ToJets<Jet>(x, form.size).data());
      for (int kind = 0; kind < 3; ++kind) {
        const EpipolarResiduals residuals(matches, kKinds[kind]);
        std::vector<GroupLinearization> groups;
        residuals.Linearize(pose, &basis, &groups);
        for (int k = 0; k < residuals.size(); ++k) {
          const Match& m = matches.matches()[k];
          const auto where = [&] { return At(form, i) + At(m); };
          Vector6d row = Vector6d::Zero();
          const double r = residuals.Evaluate(groups, k, form.size, row.data());
          const Jet expected = EpipolarTwin<Jet>(kKinds[kind], twin, p.rig, m);
          values[kind].Add(std::abs(r - expected.a) / (1.0 + std::abs(expected.a)), where);
          derivatives[kind].Add(RelativeError(row, expected.v), where);
        }
      }
    }
  }
  for (int kind = 0; kind < 3; ++kind) {
    values[kind].Expect(std::string(kKindNames[kind]) + "_values", kTolerance, kPoints * 18 * 9);
    derivatives[kind].Expect(std::string(kKindNames[kind]) + "_derivatives", kTolerance,
                             kPoints * 18 * 9);
  }
}

// By the perturbation R <- Exp(d) R, t <- t + e; each row relative to itself.
TEST(Jacobian, PriorResidualsMatchAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 6>;
  Worst values, derivatives;
  int rows = 0;
  for (int i = 0; i < kPoints; ++i) {
    Random random = Random::Stream(134, i);
    for (const PriorKind kind : kPriorKinds) {
      for (const bool distance : {true, false}) {
        MotionPrior prior = FullPrior(&random);
        if (!distance) prior.distance_sigma = 0.0;
        Pose start, pose;
        start.R = ExpSO3(Angle((i / 3) % 3, &random) * random.UnitVector3());
        start.t = random.Uniform(0.2, 3.0) * random.UnitVector3();
        if (i % 10 == 9) start.t.setZero();
        pose.R = ExpSO3(Angle(i % 3, &random) * random.UnitVector3());
        pose.t = random.Uniform(0.2, 3.0) * random.UnitVector3();
        const PriorResiduals residuals(prior, kind, start);
        PriorResiduals::Residuals r;
        PriorResiduals::Jacobian J;
        residuals.Evaluate(pose, &r, &J);
        const std::vector<Jet> twin = PriorTwin<Jet>(prior, kind, start, PerturbedJets<Jet>(pose));
        ASSERT_EQ(residuals.size(), static_cast<int>(twin.size()));
        ASSERT_EQ(J.rows(), residuals.size());
        for (int k = 0; k < residuals.size(); ++k) {
          const auto where = [&] {
            return "kind " + std::to_string(static_cast<int>(kind)) + ", point " +
                   std::to_string(i) + ", row " + std::to_string(k);
          };
          values.Add(std::abs(r(k) - twin[k].a) / (1.0 + std::abs(twin[k].a)), where);
          derivatives.Add(RelativeError(J.row(k).transpose(), twin[k].v), where);
          ++rows;
        }
      }
    }
  }
  EXPECT_GT(rows, kPoints * 16);
  values.Expect("values", kTolerance, rows);
  derivatives.Expect("derivatives", kTolerance, rows);
}

// A point that the second camera sees in its image, near or far, at infinity or beyond it.
// False if none was found.
bool RandomImage(const Rig& rig, const Motion<double>& motion, const Match& m, Random* random,
                 Vector3<double>* point) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    *point << random->Uniform(-2, 2), random->Uniform(-2, 2), random->Uniform(-0.2, 0.8);
    if (attempt % 4 == 0) point->z() *= 1e-6;
    if (attempt % 16 == 0) point->z() = 0.0;
    const Eigen::Vector4d r = ReprojectionTwin<double>(rig, m, 1.0, motion, *point);
    if (r.allFinite() && r.norm() < 2000.0) return true;
  }
  return false;
}

// One cost function of both blocks, its motion on a chart.
class ReprojectionOnChart final : public ceres::CostFunction {
 public:
  ReprojectionOnChart(const MotionParameterization& chart, const Rig& rig, const Match& match,
                      double weight)
      : chart_(chart), cost_(rig, match, pose_, basis_, chart.size(), weight) {
    set_num_residuals(4);
    *mutable_parameter_block_sizes() = {chart.size(), 3};
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    chart_.Evaluate(parameters[0], &pose_, &basis_);
    return cost_.Evaluate(parameters, residuals, jacobians);
  }

 private:
  const MotionParameterization& chart_;
  mutable Pose pose_;
  mutable MotionBasis basis_;
  ReprojectionCost cost_;
};

// Each block relative to itself.
TEST(Jacobian, ReprojectionCostMatchesAutomaticDifferentiation) {
  using Jet = ceres::Jet<double, 9>;
  Worst values, by_motion, by_point;
  int count = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(135, i);
    for (const Form& form : kForms) {
      MotionParameterization chart;
      ASSERT_TRUE(chart.Set(form.rotation, form.translation, p.start.pose, p.start.alignment,
                            p.start.reference));
      const Parameters x = RandomParameters(form, i, true, &random);
      const ChartTwin chart_twin(form, p.start);
      for (const Match& m : p.matches) {
        Vector3<double> point;
        if (!RandomImage(p.rig, chart_twin(x.data()), m, &random, &point)) continue;
        ++count;
        const double weight = random.Uniform(0.2, 3.0);
        Eigen::Vector4d r;
        Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::RowMajor> motion(4, form.size);
        Eigen::Matrix<double, 4, 3, Eigen::RowMajor> inverse_depth;
        const double* blocks[2] = {x.data(), point.data()};
        double* jacobians[2] = {motion.data(), inverse_depth.data()};
        ASSERT_TRUE(
            ReprojectionOnChart(chart, p.rig, m, weight).Evaluate(blocks, r.data(), jacobians));
        const Vector3<Jet> jets(Jet(point.x(), 6), Jet(point.y(), 7), Jet(point.z(), 8));
        const Eigen::Matrix<Jet, 4, 1> twin = ReprojectionTwin<Jet>(
            p.rig, m, weight, chart_twin(ToJets<Jet>(x, form.size).data()), jets);
        Eigen::Vector4d expected;
        Eigen::Matrix<double, 4, 9> J;
        for (int k = 0; k < 4; ++k) {
          expected(k) = twin(k).a;
          J.row(k) = twin(k).v.transpose();
        }
        const auto where = [&] { return At(form, i) + At(m); };
        values.Add((r - expected).norm() / (1.0 + expected.norm()), where);
        by_motion.Add(RelativeError(motion, J.leftCols(form.size)), where);
        by_point.Add(RelativeError(inverse_depth, J.rightCols<3>()), where);
      }
    }
  }
  EXPECT_GT(count, kPoints * 18 * 8);
  values.Expect("values", kTolerance, count);
  by_motion.Expect("motion", kTolerance, count);
  by_point.Expect("point", kTolerance, count);
}

// A cost function in turned parameters, x = M y with an orthogonal M for each block. The checker
// holds each number against itself, so a parameter that a residual does not depend on, such as |t|
// of an intra-camera match without rotation, would be rounding against rounding; turned, each
// number is a sum over the whole row.
class Turned final : public ceres::CostFunction {
 public:
  Turned(const ceres::CostFunction& cost, Random* random) : cost_(cost) {
    set_num_residuals(cost.num_residuals());
    *mutable_parameter_block_sizes() = cost.parameter_block_sizes();
    for (const int size : parameter_block_sizes()) {
      Eigen::MatrixXd A(size, size);
      for (double& a : A.reshaped()) a = random->Normal();
      M_.push_back(A.householderQr().householderQ());
    }
  }

  // y of the block's x.
  Eigen::VectorXd Turn(int block, const double* x) const {
    return M_[block].transpose() * Eigen::VectorXd::Map(x, M_[block].rows());
  }

  bool Evaluate(double const* const* y, double* residuals, double** jacobians) const override {
    std::vector<Eigen::VectorXd> x;
    std::vector<const double*> blocks;
    for (size_t k = 0; k < M_.size(); ++k) {
      x.push_back(M_[k] * Eigen::VectorXd::Map(y[k], M_[k].rows()));
    }
    for (const Eigen::VectorXd& v : x) blocks.push_back(v.data());
    if (!cost_.Evaluate(blocks.data(), residuals, jacobians)) return false;
    for (size_t k = 0; k < M_.size() && jacobians != nullptr; ++k) {
      if (jacobians[k] == nullptr) continue;
      for (int r = 0; r < num_residuals(); ++r) {
        Eigen::Map<Eigen::RowVectorXd> row(jacobians[k] + r * M_[k].rows(), M_[k].rows());
        row = (row * M_[k]).eval();
      }
    }
    return true;
  }

 private:
  const ceres::CostFunction& cost_;
  std::vector<Eigen::MatrixXd> M_;
};

// At x, without manifolds: the chart's parameters are plain numbers. The first step is 32 times the
// number given here; Ceres' own is too long for an angle.
bool Probe(const ceres::CostFunction& cost, const std::vector<const double*>& x, Random* random) {
  const Turned turned(cost, random);
  std::vector<Eigen::VectorXd> y;
  std::vector<const double*> blocks;
  for (size_t k = 0; k < x.size(); ++k) y.push_back(turned.Turn(static_cast<int>(k), x[k]));
  for (const Eigen::VectorXd& v : y) blocks.push_back(v.data());
  ceres::NumericDiffOptions numeric;
  numeric.ridders_relative_initial_step_size = 1e-4;
  const std::vector<const ceres::Manifold*> manifolds(blocks.size(), nullptr);
  const ceres::GradientChecker checker(&turned, &manifolds, numeric);
  // Without its results: Eigen memory of Ceres' library is not to be freed by a program under
  // AddressSanitizer, where Eigen allocates in another way.
  return checker.Probe(blocks.data(), kCheckerTolerance, nullptr);
}

// All matches as residuals of one block.
class EpipolarOnChart final : public ceres::CostFunction {
 public:
  EpipolarOnChart(const MotionParameterization& chart, const GroupedMatches& matches,
                  ResidualKind kind)
      : chart_(chart), residuals_(matches, kind) {
    set_num_residuals(residuals_.size());
    mutable_parameter_block_sizes()->push_back(chart.size());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const bool with_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    Pose pose;
    MotionBasis basis;
    std::vector<GroupLinearization> groups;
    chart_.Evaluate(parameters[0], &pose, &basis);
    residuals_.Linearize(pose, with_jacobian ? &basis : nullptr, &groups);
    for (int k = 0; k < residuals_.size(); ++k) {
      double* row = with_jacobian ? jacobians[0] + k * chart_.size() : nullptr;
      residuals[k] = residuals_.Evaluate(groups, k, chart_.size(), row);
    }
    return true;
  }

 private:
  const MotionParameterization& chart_;
  EpipolarResiduals residuals_;
};

class PriorOnChart final : public ceres::CostFunction {
 public:
  PriorOnChart(const MotionParameterization& chart, const PriorResiduals& prior)
      : chart_(chart), prior_(prior) {
    set_num_residuals(prior.size());
    mutable_parameter_block_sizes()->push_back(chart.size());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Pose pose;
    MotionBasis basis;
    PriorResiduals::Residuals r;
    PriorResiduals::Jacobian J;
    chart_.Evaluate(parameters[0], &pose, &basis);
    prior_.Evaluate(pose, &r, &J);
    Eigen::VectorXd::Map(residuals, r.size()) = r;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          jacobians[0], r.size(), chart_.size()) = J * basis;
    }
    return true;
  }

 private:
  const MotionParameterization& chart_;
  const PriorResiduals& prior_;
};

TEST(Jacobian, EpipolarResidualsPassGradientChecker) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(136, i);
    for (const Form& form : kForms) {
      MotionParameterization chart;
      ASSERT_TRUE(chart.Set(form.rotation, form.translation, p.start.pose, p.start.alignment,
                            p.start.reference));
      const Parameters x = RandomParameters(form, i, false, &random);
      for (const Match& m : {p.matches[i % 3 * 4], p.matches[1 + i % 3]}) {
        const GroupedMatches matches(p.rig, {m});
        for (int kind = 0; kind < 3; ++kind) {
          EXPECT_TRUE(Probe(EpipolarOnChart(chart, matches, kKinds[kind]), {x.data()}, &random))
              << kKindNames[kind] << ", " << At(form, i) << At(m);
        }
      }
    }
  }
}

TEST(Jacobian, PriorResidualsPassGradientChecker) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(137, i);
    const MotionPrior prior = FullPrior(&random);
    for (const PriorKind kind : kPriorKinds) {
      const PriorResiduals residuals(prior, kind, p.start.pose);
      for (const Form& form : kForms) {
        // Where |t| stays, the distance is a constant: its row is rounding against rounding.
        if (form.translation == TranslationForm::kSphere ||
            form.translation == TranslationForm::kCircle) {
          continue;
        }
        MotionParameterization chart;
        ASSERT_TRUE(chart.Set(form.rotation, form.translation, p.start.pose, p.start.alignment,
                              p.start.reference));
        const Parameters x = RandomParameters(form, i, false, &random);
        EXPECT_TRUE(Probe(PriorOnChart(chart, residuals), {x.data()}, &random))
            << "kind " << static_cast<int>(kind) << ", " << At(form, i);
      }
    }
  }
}

TEST(Jacobian, ReprojectionCostPassesGradientChecker) {
  for (int i = 0; i < kPoints; ++i) {
    const Point p = MakePoint(i);
    Random random = Random::Stream(138, i);
    for (const Form& form : kForms) {
      MotionParameterization chart;
      ASSERT_TRUE(chart.Set(form.rotation, form.translation, p.start.pose, p.start.alignment,
                            p.start.reference));
      const Parameters x = RandomParameters(form, i, false, &random);
      const Motion<double> motion = ChartTwin(form, p.start)(x.data());
      for (const Match& m : {p.matches[i % 3 * 4], p.matches[1 + i % 3]}) {
        Vector3<double> point;
        if (!RandomImage(p.rig, motion, m, &random, &point)) continue;
        EXPECT_TRUE(
            Probe(ReprojectionOnChart(chart, p.rig, m, 0.7), {x.data(), point.data()}, &random))
            << At(form, i) << At(m);
      }
    }
  }
}

// Two cameras of unlike focal lengths whose numbers, and all made of them below, are exact in
// binary.
Rig ExactRig() {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].intrinsics = {512, 256, 320, 240, 640, 480};
  rig.cameras[1].intrinsics = {256, 1024, 300, 200, 640, 480};
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
      m.pixel1 = c1.intrinsics.Project(c1.Q.transpose() * (pose.R.transpose() * b));
      m.pixel2 = c2.intrinsics.Project(c2.Q.transpose() * b);
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
          c2.Q.transpose() * (pose.R * (c1.Q * c1.intrinsics.Normalize(m.pixel1)));
      if (std::abs(direction.z()) < 0.1) continue;
      m.pixel2 = c2.intrinsics.Project(direction);
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

// At t = 0 the distance has no derivative: its row is zero, the others are not touched.
TEST(Jacobian, DistancePriorHasNoDerivativeAtRest) {
  Random random(140);
  for (const PriorKind kind : kPriorKinds) {
    MotionPrior prior = FullPrior(&random);
    Pose pose = MakePoint(2).start.pose;
    const PriorResiduals residuals(prior, kind, pose);
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

}  // namespace
}  // namespace rigel
