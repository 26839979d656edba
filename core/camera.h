// Camera models: raw pixels <-> rays of any lens.
//
// The camera frame has +z forward, +x right, +y down. Pixel (0, 0) is the centre of the top left
// pixel. A point X is mapped to a plane (core/lens_plane.h), distorted there
// (core/lens_distortion.h) and scaled: pixel = (fx u + cx, fy v + cy).
//
//   model                  parameters                              plane          distortion
//   pinhole                fx fy cx cy                             perspective
//   simple_pinhole         f cx cy                                 perspective
//   simple_radial          f cx cy k                               perspective    n
//   radial                 f cx cy k1 k2                           perspective    n
//   opencv                 fx fy cx cy k1 k2 p1 p2                 perspective    n, p
//   full_opencv            fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6     perspective    n, p, d = k4..k6
//   opencv_fisheye         fx fy cx cy k1 k2 k3 k4                 angle          n
//   simple_radial_fisheye  f cx cy k                               angle          n
//   radial_fisheye         f cx cy k1 k2                           angle          n
//   thin_prism_fisheye     fx fy cx cy k1 k2 p1 p2 k3 k4 sx1 sy1   angle          n, p, s
//   fov                    fx fy cx cy omega                       angle
//   omni                   xi fx fy cx cy k1 k2 p1 p2              sphere         n, p
//   double_sphere          xi alpha fx fy cx cy                    double sphere
//   eucm                   alpha beta fx fy cx cy                  enhanced
//
// Names and orders of the first eleven are COLMAP's (sensor/models of 4.2.0.dev0, and the same in
// 3.8), in lower case. COLMAP's pixels, and with them cx and cy, are larger by 0.5. It refuses rays
// beyond 90 degrees; here they go on along the same formula. The last three are Kalibr's
// (aslam_cameras), in its orders; its pinhole-radtan is opencv, its pinhole-equi opencv_fisheye.
//
// Nothing here allocates, throws or logs. Points and pixels outside a model's domain are refused.
// So are numbers that are not finite.
#ifndef RIGEL_CORE_CAMERA_H_
#define RIGEL_CORE_CAMERA_H_

#include <string>
#include <string_view>

#include <Eigen/Core>

#include "rigel/core/eigen_types.h"

namespace rigel {

enum class CameraModel {
  kPinhole,
  kSimplePinhole,
  kSimpleRadial,
  kRadial,
  kOpencv,
  kFullOpencv,
  kOpencvFisheye,
  kSimpleRadialFisheye,
  kRadialFisheye,
  kThinPrismFisheye,
  kFov,
  kOmni,
  kDoubleSphere,
  kEucm
};

const char* CameraModelName(CameraModel model);  // "pinhole", ..; "unknown" if it is none
// Also of the aliases radtan (opencv) and equidistant (opencv_fisheye). False, *model unchanged, if
// no model has this name.
bool ParseCameraModel(std::string_view name, CameraModel* model);

// The names of all, ", " between them.
std::string CameraModelNames();

// "fx fy cx cy" for kPinhole; empty if it is no model. And how many these are.
const char* CameraParameterNames(CameraModel model);
int NumCameraParameters(CameraModel model);

struct Camera {
  static constexpr int kMostParameters = 12;  // of full_opencv and thin_prism_fisheye, in number

  CameraModel model = CameraModel::kPinhole;
  double parameters[kMostParameters] = {1.0, 1.0};  // the model's first, the others are not read
  // Pixels. They tell how often random matches would fit a motion (EstimateStatus::kNoConsensus).
  // If they are 0, the size is guessed from the principal point, the focal length and the matches.
  int width = 0;
  int height = 0;

  static Camera Pinhole(double fx, double fy, double cx, double cy, int width = 0, int height = 0);

  // Of any model, pixels. fx and fy are the same where the model has one focal length.
  double fx() const;
  double fy() const;
  double cx() const;
  double cy() const;

  // kPinhole or kSimplePinhole: no distortion, so that pixels are points of a plane.
  bool IsPinhole() const {
    return model == CameraModel::kPinhole || model == CameraModel::kSimplePinhole;
  }

  // How many pixels an angle is on the optical axis, along u and along v, 1/radians: fx and fy of a
  // pinhole.
  Pixel PixelsPerRadian() const;

  bool InImage(const Pixel& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < width && pixel.y() < height;
  }

  // False with a message if a parameter is not finite or out of its range, or the size is
  // negative. f, fx, fy and beta are positive, alpha is 0 to 1, omega is between 0 and pi. xi is
  // not negative, of double_sphere more than -1 and at most 1.
  bool IsValid(std::string* error) const;
};
static_assert(kSameLayoutEverywhere<Camera>, "no member of Camera may be aligned");

// Of a valid camera. X in the camera frame, of any length (1e-100 to 1e100); its z may be negative
// where the model has rays beyond 90 degrees. `J` may be null: d pixel / d X. False, and nothing
// written, outside the domain: behind the camera, beyond where the image folds over, or where the
// model's formula ends.
bool Project(const Camera& camera, const Eigen::Vector3d& X, Pixel* pixel, Matrix2x3d* J = nullptr);

// Of a valid camera. `ray` has unit length; the pixel may lie outside the image. `J` may be null: d
// ray / d pixel, perpendicular to the ray. False, and nothing written, if no ray of the domain has
// this pixel.
bool Unproject(const Camera& camera, const Pixel& pixel, Eigen::Vector3d* ray,
               Matrix3x2d* J = nullptr);

// A vector along that ray: (x, y, 1) of a pinhole, the unit ray of other models. NaN if no ray of
// the domain has this pixel.
Eigen::Vector3d AlongRay(const Camera& camera, const Pixel& pixel);

// Whether the models and their parameters are the same.
bool SameLens(const Camera& a, const Camera& b);

}  // namespace rigel

#endif  // RIGEL_CORE_CAMERA_H_
