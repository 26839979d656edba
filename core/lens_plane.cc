#include "rigel/core/lens_plane.h"

#include <algorithm>
#include <cmath>

#include "rigel/core/lens_distortion.h"

namespace rigel {
namespace {

// Radians: the direction of a ray about the axis is lost at 180 degrees.
constexpr double kWidestAngle = 3.14159;

// The bound on -cos of the angle at the second sphere, or in the stretched space of kEnhanced.
double AlphaBound(double alpha) {
  return (alpha <= 0.5 ? alpha / (1 - alpha) : (1 - alpha) / alpha) - kLeastGrowth;
}

// m = (x, y) / divisor.
struct Quotient {
  double divisor = 0;
  Eigen::Vector3d gradient;  // d divisor / d X
};

bool SphereQuotient(double xi, const Eigen::Vector3d& X, Quotient* q) {
  const double d = X.norm();
  if (!(X.z() > -(std::min(xi, 1 / xi) - kLeastGrowth) * d)) return false;
  q->divisor = X.z() + xi * d;
  q->gradient = xi / d * X;
  q->gradient.z() += 1;
  return true;
}

bool DoubleSphereQuotient(double xi, double alpha, const Eigen::Vector3d& X, Quotient* q) {
  const double d1 = X.norm();
  const Eigen::Vector3d shifted(X.x(), X.y(), X.z() + xi * d1);
  const double d2 = shifted.norm();
  if (!(shifted.z() > -AlphaBound(alpha) * d2)) return false;
  q->divisor = alpha * d2 + (1 - alpha) * shifted.z();
  Eigen::Vector3d z1_gradient = xi / d1 * X;
  z1_gradient.z() += 1;
  const double per_z1 = alpha * shifted.z() / d2 + (1 - alpha);
  q->gradient = per_z1 * z1_gradient;
  q->gradient.head<2>() += alpha / d2 * X.head<2>();
  return true;
}

bool EnhancedQuotient(double alpha, double beta, const Eigen::Vector3d& X, Quotient* q) {
  const double d = std::sqrt(beta * X.head<2>().squaredNorm() + X.z() * X.z());
  if (!(X.z() > -AlphaBound(alpha) * d)) return false;
  q->divisor = alpha * d + (1 - alpha) * X.z();
  q->gradient = alpha / d * Eigen::Vector3d(beta * X.x(), beta * X.y(), X.z());
  q->gradient.z() += 1 - alpha;
  return true;
}

bool MakeQuotient(const LensPlane& plane, const Eigen::Vector3d& X, Quotient* q) {
  switch (plane.kind) {
    case LensPlane::Kind::kSphere:
      return SphereQuotient(plane.a, X, q);
    case LensPlane::Kind::kDoubleSphere:
      return DoubleSphereQuotient(plane.a, plane.b, X, q);
    case LensPlane::Kind::kEnhanced:
      return EnhancedQuotient(plane.a, plane.b, X, q);
    default:
      *q = {X.z(), Eigen::Vector3d::UnitZ()};
      return X.z() > 0;
  }
}

bool AngleFromRay(double a, double b, const Eigen::Vector3d& X, Eigen::Vector2d* m, Matrix2x3d* J) {
  const Eigen::Vector2d xy = X.head<2>();
  const double r = xy.norm();
  const double angle = std::atan2(a * r, X.z());
  if (!(angle <= kWidestAngle)) return false;
  const double across = r > 0 ? angle / (b * r) : a / (b * X.z());
  *m = across * xy;
  if (J != nullptr) {
    const double scale = a / (b * (a * a * r * r + X.z() * X.z()));
    const Eigen::Vector2d e = r > 0 ? Eigen::Vector2d(xy / r) : Eigen::Vector2d::UnitX();
    J->leftCols<2>() = (scale * X.z() - across) * e * e.transpose();
    J->leftCols<2>().diagonal().array() += across;
    J->col(2) = -scale * xy;
  }
  return true;
}

}  // namespace

bool LensPlane::FromRay(const Eigen::Vector3d& X, Eigen::Vector2d* m, Matrix2x3d* J) const {
  if (kind == Kind::kAngle) return AngleFromRay(a, b, X, m, J);
  Quotient q;
  if (!MakeQuotient(*this, X, &q)) return false;
  *m = X.head<2>() / q.divisor;
  if (J != nullptr) {
    *J = -*m * q.gradient.transpose();
    J->leftCols<2>().diagonal().array() += 1;
    *J /= q.divisor;
  }
  return true;
}

bool LensPlane::ToRay(const Eigen::Vector2d& m, Eigen::Vector3d* ray) const {
  const double t = m.squaredNorm();
  switch (kind) {
    case Kind::kAngle: {
      const double length = std::sqrt(t);
      const double angle = b * length;
      const double across = length > 0 ? std::sin(angle) / length : b;
      *ray << across * m, a * std::cos(angle);
      ray->normalize();
      return angle <= kWidestAngle;
    }
    case Kind::kSphere: {  // the sphere's point, seen from (0, 0, -xi)
      const double root = 1 + (1 - a * a) * t;
      const double scale = (a + std::sqrt(root)) / (1 + t);
      *ray << scale * m, scale - a;
      return root >= 0;
    }
    case Kind::kDoubleSphere: {  // Usenko et al. 2018, eq. 46-50
      const double root = 1 - (2 * b - 1) * t;
      const double z = (1 - b * b * t) / (b * std::sqrt(root) + 1 - b);
      const double scale = (z * a + std::sqrt(z * z + (1 - a * a) * t)) / (z * z + t);
      *ray << scale * m, scale * z - a;
      return root >= 0;
    }
    case Kind::kEnhanced: {  // Khomutenko et al. 2016
      const double root = 1 - (2 * a - 1) * b * t;
      *ray << m, (1 - b * a * a * t) / (a * std::sqrt(root) + 1 - a);
      ray->normalize();
      return root >= 0;
    }
    default:
      *ray << m, 1;
      ray->normalize();
      return true;
  }
}

}  // namespace rigel
