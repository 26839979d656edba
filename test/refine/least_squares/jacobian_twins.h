// Twins for the tests of Jacobians: the chart of the motion and each residual written anew from the
// headers' words as templates, so that ceres::Jet differentiates residual and chart in one; and the
// motions, rigs and matches that they are compared at.
#ifndef RIGEL_TEST_REFINE_LEAST_SQUARES_JACOBIAN_TWINS_H_
#define RIGEL_TEST_REFINE_LEAST_SQUARES_JACOBIAN_TWINS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <Eigen/Core>

#include "rigel/core/alignment.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/refine/least_squares/epipolar_residuals.h"
#include "rigel/refine/least_squares/motion_parameterization.h"
#include "rigel/refine/least_squares/prior_residuals.h"
#include "rigel/refine/least_squares/reprojection_cost.h"
#include "rigel/test/core/random_vector.h"
#include "rigel/test/refine/jet_geometry.h"
#include "rigel/test/refine/least_squares/translation_forms.h"
#include "rigel/test/refine/refine_scene.h"

namespace rigel {

inline constexpr int kPoints = 200;
inline constexpr double kTolerance = 1e-10;        // relative
inline constexpr double kCheckerTolerance = 1e-6;  // relative, of each number

inline constexpr ResidualKind kKinds[] = {ResidualKind::kSampson, ResidualKind::kAngular,
                                          ResidualKind::kAlgebraic};
inline constexpr const char* kKindNames[] = {"Sampson", "angular", "algebraic"};
inline constexpr PriorKind kPriorKinds[] = {PriorKind::kNone, PriorKind::kVertical,
                                            PriorKind::kAxis, PriorKind::kPlanar};

// All forms go with both rotations: Set() takes every pair.
struct Form {
  RotationForm rotation;
  TranslationForm translation;
  const char* name;
  int size;
};
inline constexpr Form kForms[] = {
    {RotationForm::kFree, kFreeTranslation, "free, free", 6},
    {RotationForm::kFree, kSphere, "free, sphere", 5},
    {RotationForm::kFree, kPlane, "free, plane", 5},
    {RotationForm::kFree, kCircle, "free, circle", 4},
    {RotationForm::kFree, kDepths, "free, depths", 5},
    {RotationForm::kFree, kPlanarDepths, "free, planar depths", 4},
    {RotationForm::kAngle, kFreeTranslation, "angle, free", 4},
    {RotationForm::kAngle, kSphere, "angle, sphere", 3},
    {RotationForm::kAngle, kPlane, "angle, plane", 3},
    {RotationForm::kAngle, kCircle, "angle, circle", 2},
    {RotationForm::kAngle, kDepths, "angle, depths", 3},
    {RotationForm::kAngle, kPlanarDepths, "angle, planar depths", 2},
};
inline constexpr int kNumForms = 12;

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
  LengthRange range;
};

inline MotionParameterization MakeChart(const Form& form, const Start& start) {
  MotionParameterization chart;
  EXPECT_TRUE(chart.Set(form.rotation, form.translation, start.pose, start.alignment,
                        start.reference, start.range));
  return chart;
}

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
    if (form.translation.depths) {
      SetDepths();
    } else if (form.translation.planar) {
      t0_ -= n * n.dot(t0_);
      if (form.translation.holds_length) t0_ *= start.pose.t.norm() / t0_.norm();
    } else {
      tangent_ = TangentBasis(t0_.normalized());
    }
  }

  template <class T>
  Motion<T> operator()(const T* x) const {
    using std::exp;
    Motion<T> motion;
    const Vector3<T> n = start_.n2.cast<T>();
    if (form_.rotation == RotationForm::kFree) {
      motion.R = Exp<T>(Vector3<T>(x[0], x[1], x[2])) * R0_.cast<T>();
      x += 3;
    } else {
      motion.R = Exp<T>(n * x[0]) * R0_.cast<T>();
      x += 1;
    }
    if (form_.translation.depths) {
      SetFromDepths(x, &motion);
      return motion;
    }
    const Vector3<T> t0 = t0_.cast<T>();
    if (form_.translation.planar) {
      motion.t = Exp<T>(n * x[0]) * t0;
      x += 1;
    } else {
      // Turned towards the tangent by its length.
      const Vector3<T> tangent =
          tangent_.col(0).cast<T>() * x[0] + tangent_.col(1).cast<T>() * x[1];
      const Vector3<T> direction = t0_.normalized().cast<T>();
      motion.t = Exp<T>(direction.cross(tangent)) * t0;
      x += 2;
    }
    if (form_.translation.holds_length) return motion;
    T length = T(t0_.norm()) * exp(x[0]);
    if (length < T(start_.range.min)) length = T(start_.range.min);
    if (length > T(start_.range.max)) length = T(start_.range.max);
    motion.t *= length / T(t0_.norm());
    return motion;
  }

 private:
  template <class T>
  void SetFromDepths(const T* x, Motion<T>* motion) const {
    using std::sqrt;
    T d1 = T(distance_.x());
    T d2 = T(distance_.y());
    if (form_.translation.planar && !form_.translation.holds_length) {
      d1 += x[0] * T(along_line_.x());
      d2 += x[0] * T(along_line_.y());
    } else if (!form_.translation.planar && form_.translation.holds_length) {
      // Along the level line of |t|.
      d1 += x[0] * T(across_.y());
      d2 -= x[0] * T(across_.x());
    } else if (!form_.translation.planar) {
      d1 += x[0];
      d2 += x[1];
    }
    const Ray& ray1 = start_.reference.ray1;
    const Ray& ray2 = start_.reference.ray2;
    const Vector3<T> X1 = ray1.s.cast<T>() + ray1.x.cast<T>() * d1;
    const Vector3<T> X2 = ray2.s.cast<T>() + ray2.x.cast<T>() * d2;
    motion->t = X2 - motion->R * X1;
    if (!form_.translation.holds_length) return;
    // |t + q v| = |t0|.
    const Vector3<T> v =
        ray2.x.cast<T>() * T(across_.y()) - motion->R * (ray1.x.cast<T>() * T(across_.x()));
    const T b = motion->t.dot(v);
    const T c = motion->t.squaredNorm() - T(t0_.squaredNorm());
    motion->t += v * ((sqrt(b * b - v.squaredNorm() * c) - b) / v.squaredNorm());
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
    if (!form_.translation.planar) {
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
  const Eigen::Vector3d u_i = AlongRay(i.intrinsics, m.pixel1);
  const Eigen::Vector3d u_j = AlongRay(j.intrinsics, m.pixel2);
  const Eigen::Vector3d v_i = pixels ? u_i : u_i.normalized();
  const Eigen::Vector3d v_j = pixels ? u_j : u_j.normalized();
  const Vector3<T> y = motion.R * (i.Q * v_i).cast<T>();
  const Vector3<T> z = (j.Q * v_j).cast<T>();
  const T C = z.dot(b.cross(y));
  if (kind == ResidualKind::kAlgebraic) return C;
  const Vector3<T> by_j = j.Q.transpose().cast<T>() * b.cross(y);
  const Vector3<T> by_i = i.Q.transpose().cast<T>() * (motion.R.transpose() * z.cross(b));
  if (pixels) {
    const T gradient2 = by_i.x() * by_i.x() / T(i.intrinsics.fx() * i.intrinsics.fx()) +
                        by_i.y() * by_i.y() / T(i.intrinsics.fy() * i.intrinsics.fy()) +
                        by_j.x() * by_j.x() / T(j.intrinsics.fx() * j.intrinsics.fx()) +
                        by_j.y() * by_j.y() / T(j.intrinsics.fy() * j.intrinsics.fy());
    return C / sqrt(gradient2);
  }
  // On the sphere: the parts of the derivatives across the rays.
  const Vector3<T> across_i = v_i.cast<T>().cross(by_i);
  const Vector3<T> across_j = v_j.cast<T>().cross(by_j);
  const double focal =
      (i.intrinsics.fx() + i.intrinsics.fy() + j.intrinsics.fx() + j.intrinsics.fy()) / 4.0;
  return C / sqrt(across_i.squaredNorm() + across_j.squaredNorm()) * T(focal);
}

// prior_residuals.h: the direction's, the normal's, the distance's, the length's; a part without
// sigma is none.
template <class T>
std::vector<T> PriorTwin(const MotionPrior& prior, const PriorParts& parts, const Pose& start,
                         const Motion<T>& motion) {
  using std::log;
  using std::sqrt;
  const PriorKind kind = parts.direction;
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
  if (parts.distance && prior.distance_sigma > 0) {
    // The body's origin lies at -c from the point c: it moves as the point does, and turns about
    // it.
    const Vector3<T> origin = Eigen::Vector3d(-Eigen::Vector3d::Map(parts.point.data())).cast<T>();
    const Vector3<T> moved = motion.R * origin + motion.t - origin;
    residuals.push_back((sqrt(moved.squaredNorm()) - T(*prior.distance)) / T(prior.distance_sigma));
  }
  if (parts.typical_length > 0) {
    const T ratio2 = motion.t.squaredNorm() / T(parts.typical_length * parts.typical_length);
    residuals.push_back(log(ratio2) / T(2.0 * kLengthSigma));
  }
  return residuals;
}

// Bit 0 of `lengths`: the distance, of a point of the body. Bit 1: the weak length.
inline PriorParts RandomParts(PriorKind kind, int lengths, Random* random) {
  PriorParts parts;
  parts.direction = kind;
  parts.distance = lengths % 2 == 1;
  if (lengths >= 2) parts.typical_length = random->Uniform(0.3, 3.0);
  Eigen::Vector3d::Map(parts.point.data()) = RandomVector3(0.0, 2.0, random);
  return parts;
}

// reprojection_cost.h: the point as homogeneous coordinates (X, rho) in each frame in turn.
template <class T>
Eigen::Matrix<T, 4, 1> ReprojectionTwin(const Rig& rig, const Match& m, double weight,
                                        const Motion<T>& motion, const Vector3<T>& point) {
  const RigCamera& i = rig.cameras[m.camera1];
  const RigCamera& j = rig.cameras[m.camera2];
  const Camera& a = i.intrinsics;
  const Camera& b = j.intrinsics;
  const T& rho = point.z();
  const Vector3<T> in_camera1((point.x() + T(m.pixel1.x() - a.cx())) / T(a.fx()),
                              (point.y() + T(m.pixel1.y() - a.cy())) / T(a.fy()), T(1.0));
  const Vector3<T> in_f1 = i.Q.cast<T>() * in_camera1 + i.s.cast<T>() * rho;
  const Vector3<T> in_f2 = motion.R * in_f1 + motion.t * rho;
  const Vector3<T> in_camera2 = j.Q.transpose().cast<T>() * (in_f2 - j.s.cast<T>() * rho);
  Eigen::Matrix<T, 4, 1> r;
  r << point.x(), point.y(), in_camera2.x() / in_camera2.z() * T(b.fx()) + T(b.cx() - m.pixel2.x()),
      in_camera2.y() / in_camera2.z() * T(b.fy()) + T(b.cy() - m.pixel2.y());
  return r * T(weight);
}

// 0: near zero, 1: near a half turn, 2: in between.
inline double Angle(int regime, Random* random) {
  const double near = std::pow(10.0, random->Uniform(-9.0, -2.0));
  return regime == 0 ? near : regime == 1 ? kPi - near : random->Uniform(0.1, 3.0);
}

inline Eigen::Matrix3d RandomRotation(int regime, Random* random) {
  const double angle = Angle(regime, random);
  return ExpSO3(angle * random->UnitVector3());
}

struct Point {
  int number = 0;
  Rig rig;
  std::vector<Match> matches;  // one of each camera pair
  Start start;
};

// Rotations of all three sizes in turn; a start off the prior, the plane and the reference. With
// `limits_length` some have a range of |t|.
inline Point MakePoint(int number, bool limits_length = false) {
  Random random = Random::Stream(131, number);
  Point p;
  p.number = number;
  p.rig = MixedRig(&random);
  p.matches = UnrelatedMatches(p.rig, 9, &random);
  Pose exact;
  exact.R = RandomRotation(number % 3, &random);
  exact.t = RandomVector3(0.3, 3.0, &random);
  p.start.pose = StartNear(exact, 3.0, 0.1, &random);
  if (number % 3 != 2) p.start.pose.R = exact.R;
  if (limits_length && number % 10 == 7) {
    p.start.range = {0.25 * p.start.pose.t.norm(), 10.0 * p.start.pose.t.norm()};
  }
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
    if (parallax > 0.15 && std::abs(p.start.n1.dot(reference.ray1.x)) > 0.15) return p;
  }
  ADD_FAILURE() << "no reference";
  return p;
}

using Parameters = std::array<double, 6>;

// Nonzero, and angles of every size; every tenth |t| is out of its range if `limits_length`.
inline Parameters RandomParameters(const Form& form, int number, bool limits_length,
                                   Random* random) {
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
    const double size = random->Uniform(0.01, 0.8);
    x[k] = random->Index(2) == 0 ? size : -size;
  }
  const double bend = Angle((number / 9) % 3, random);
  if (form.translation.depths) return x;
  if (form.translation.planar) {
    x[n++] = sign * bend;
  } else {
    const double at = random->Uniform(0.0, 2.0 * kPi);
    x[n++] = bend * std::cos(at);
    x[n++] = bend * std::sin(at);
  }
  if (!form.translation.holds_length) {
    x[n] = random->Uniform(-1.2, 0.5);
    if (limits_length && number % 10 == 7) x[n] = number % 20 == 7 ? 5.0 : -3.5;
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

inline std::string At(const Form& form, int point) {
  return std::string(form.name) + ", point " + std::to_string(point);
}

inline std::string At(const Match& m) {
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
inline void CompareChart(const MotionParameterization& chart, const Form& form, const Start& start,
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

// A point that the second camera sees in its image, near or far, at infinity or beyond it.
// False if none was found.
inline bool RandomImage(const Rig& rig, const Motion<double>& motion, const Match& m,
                        Random* random, Vector3<double>* point) {
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

}  // namespace rigel

#endif  // RIGEL_TEST_REFINE_LEAST_SQUARES_JACOBIAN_TWINS_H_
