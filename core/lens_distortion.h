// Lens distortion: a map of the plane that points are projected to, and its inverse.
//
// For m = (u, v) and t = u^2 + v^2:
//   distorted = m N(t) / D(t) + (2 p1 u v + p2 (t + 2 u^2) + s1 t,
//                                p1 (t + 2 v^2) + 2 p2 u v + s2 t)
//   N(t) = 1 + n1 t + .. + n4 t^4,  D(t) = 1 + d1 t + d2 t^2 + d3 t^3
// That is the radial and tangential terms of Brown, "Decentering Distortion of Lenses",
// Photogrammetric Engineering 32(3), 1966, with the denominator and the names of OpenCV's calib3d.
// The thin prism terms s1, s2 are those of Weng, Cohen, Herniou, "Camera Calibration with
// Distortion Models and Accuracy Evaluation", PAMI 14(10), 1992.
//
// The domain is a disc around 0. It ends where the radial part r N/D stops growing, where D has a
// zero, or at kWidestRadius. Let G(r) = d(r N/D)/dr be the growth at the radius r. In the domain
//   G(r) > kLeastGrowth + (7 |p| + 2.5 |s|) r,  there and at each smaller r.
// The mean of G up to r is N/D, so that this bounds N/D as well. Then the symmetric part of the
// Jacobian is positive definite, by kLeastGrowth at least. Along and across m its tangential
// part is 2 |p| r (3 cos a, -sin a; -sin a, cos a) for some angle a. Its prism part is
// 2 |s| r (cos b, sin b / 2; sin b / 2, 0) for some b. A disc is convex, so no two of its points
// have the same image.
#ifndef RIGEL_CORE_LENS_DISTORTION_H_
#define RIGEL_CORE_LENS_DISTORTION_H_

#include <Eigen/Core>

namespace rigel {

// Of the image's growth with the point, relative to the centre. At this value errors of a pixel,
// and those of rounding, move its ray 10,000 times as far as at the centre.
inline constexpr double kLeastGrowth = 1e-4;

struct LensDistortion {
  // Focal lengths: tan of 89.94 degrees for a perspective lens. A bound for searches.
  static constexpr double kWidestRadius = 1000.0;

  double n[4] = {};
  double d[3] = {};
  double p1 = 0, p2 = 0;
  double s1 = 0, s2 = 0;

  // Whether it moves any point.
  bool IsIdentity() const;

  bool InDomain(const Eigen::Vector2d& m) const;

  // The formula, wherever m is. `J` may be null: d distorted / d m.
  Eigen::Vector2d Distort(const Eigen::Vector2d& m, Eigen::Matrix2d* J) const;

  // The point of the domain with this image. False if there is none; also if it is so close to the
  // domain's end that the search did not end.
  bool Undistort(const Eigen::Vector2d& distorted, Eigen::Vector2d* m) const;

 private:
  struct Radial {
    double factor;      // N / D
    double derivative;  // d factor / d t
  };

  bool IsRadial() const;
  Radial RadialAt(double t) const;
  double DomainRadius(double most) const;
  bool UndistortByNewton(const Eigen::Vector2d& distorted, Eigen::Vector2d* m) const;
  bool UndistortRadius(double distorted, double* r) const;
  double SafeRadius(double distorted) const;
  bool UndistortSafely(const Eigen::Vector2d& distorted, Eigen::Vector2d* m) const;
};

}  // namespace rigel

#endif  // RIGEL_CORE_LENS_DISTORTION_H_
