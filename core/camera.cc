#include "rigel/core/camera.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "rigel/core/enum_names.h"
#include "rigel/core/lens_distortion.h"
#include "rigel/core/lens_plane.h"

namespace rigel {
namespace {

constexpr double kPi = 3.14159265358979323846;

constexpr EnumName<CameraModel> kModelNames[] = {
    {CameraModel::kPinhole, "pinhole"},
    {CameraModel::kSimplePinhole, "simple_pinhole"},
    {CameraModel::kSimpleRadial, "simple_radial"},
    {CameraModel::kRadial, "radial"},
    {CameraModel::kOpencv, "opencv"},
    {CameraModel::kFullOpencv, "full_opencv"},
    {CameraModel::kOpencvFisheye, "opencv_fisheye"},
    {CameraModel::kSimpleRadialFisheye, "simple_radial_fisheye"},
    {CameraModel::kRadialFisheye, "radial_fisheye"},
    {CameraModel::kThinPrismFisheye, "thin_prism_fisheye"},
    {CameraModel::kFov, "fov"},
    {CameraModel::kOmni, "omni"},
    {CameraModel::kDoubleSphere, "double_sphere"},
    {CameraModel::kEucm, "eucm"},
    // Kalibr's names, found after the ones above.
    {CameraModel::kOpencv, "radtan"},
    {CameraModel::kOpencvFisheye, "equidistant"}};

constexpr EnumName<CameraModel> kParameterNames[] = {
    {CameraModel::kPinhole, "fx fy cx cy"},
    {CameraModel::kSimplePinhole, "f cx cy"},
    {CameraModel::kSimpleRadial, "f cx cy k"},
    {CameraModel::kRadial, "f cx cy k1 k2"},
    {CameraModel::kOpencv, "fx fy cx cy k1 k2 p1 p2"},
    {CameraModel::kFullOpencv, "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6"},
    {CameraModel::kOpencvFisheye, "fx fy cx cy k1 k2 k3 k4"},
    {CameraModel::kSimpleRadialFisheye, "f cx cy k"},
    {CameraModel::kRadialFisheye, "f cx cy k1 k2"},
    {CameraModel::kThinPrismFisheye, "fx fy cx cy k1 k2 p1 p2 k3 k4 sx1 sy1"},
    {CameraModel::kFov, "fx fy cx cy omega"},
    {CameraModel::kOmni, "xi fx fy cx cy k1 k2 p1 p2"},
    {CameraModel::kDoubleSphere, "xi alpha fx fy cx cy"},
    {CameraModel::kEucm, "alpha beta fx fy cx cy"}};

// What the parameters of any model come to.
struct Lens {
  LensPlane plane;
  LensDistortion distortion;
  Eigen::Vector2d focal;
  Eigen::Vector2d centre;
};

void SetFocal(double fx, double fy, const double* centre, Lens* lens) {
  lens->focal << fx, fy;
  lens->centre << centre[0], centre[1];
}

// k1 k2 p1 p2
void SetRadialTangential(const double* k, LensDistortion* distortion) {
  std::copy(k, k + 2, distortion->n);
  distortion->p1 = k[2];
  distortion->p2 = k[3];
}

bool HasOneFocalLength(CameraModel model) {
  return model == CameraModel::kSimplePinhole || model == CameraModel::kSimpleRadial ||
         model == CameraModel::kRadial || model == CameraModel::kSimpleRadialFisheye ||
         model == CameraModel::kRadialFisheye;
}

// How many parameters stand before the focal lengths.
int NumShapeParameters(CameraModel model) {
  if (model == CameraModel::kOmni) return 1;
  return model == CameraModel::kDoubleSphere || model == CameraModel::kEucm ? 2 : 0;
}

Lens MakeLens(const Camera& camera) {
  Lens lens;
  const CameraModel model = camera.model;
  const double* p = camera.parameters + NumShapeParameters(model);
  const double* k = p;  // of the distortion
  if (HasOneFocalLength(model)) {
    SetFocal(p[0], p[0], p + 1, &lens);
    k += 3;
  } else {
    SetFocal(p[0], p[1], p + 2, &lens);
    k += 4;
  }
  LensPlane& plane = lens.plane;
  LensDistortion& distortion = lens.distortion;
  switch (model) {
    case CameraModel::kPinhole:
    case CameraModel::kSimplePinhole:
      break;
    case CameraModel::kSimpleRadialFisheye:
      plane.kind = LensPlane::Kind::kAngle;
      [[fallthrough]];
    case CameraModel::kSimpleRadial:
      distortion.n[0] = k[0];
      break;
    case CameraModel::kRadialFisheye:
      plane.kind = LensPlane::Kind::kAngle;
      [[fallthrough]];
    case CameraModel::kRadial:
      std::copy(k, k + 2, distortion.n);
      break;
    case CameraModel::kOpencv:
      SetRadialTangential(k, &distortion);
      break;
    case CameraModel::kFullOpencv:
      SetRadialTangential(k, &distortion);
      distortion.n[2] = k[4];
      std::copy(k + 5, k + 8, distortion.d);
      break;
    case CameraModel::kOpencvFisheye:
      plane.kind = LensPlane::Kind::kAngle;
      std::copy(k, k + 4, distortion.n);
      break;
    case CameraModel::kThinPrismFisheye:
      plane.kind = LensPlane::Kind::kAngle;
      SetRadialTangential(k, &distortion);
      std::copy(k + 4, k + 6, distortion.n + 2);
      distortion.s1 = k[6];
      distortion.s2 = k[7];
      break;
    case CameraModel::kFov:
      plane = {LensPlane::Kind::kAngle, 2 * std::tan(0.5 * k[0]), k[0]};
      break;
    case CameraModel::kOmni:
      plane = {LensPlane::Kind::kSphere, camera.parameters[0], 0};
      SetRadialTangential(k, &distortion);
      break;
    case CameraModel::kDoubleSphere:
      plane = {LensPlane::Kind::kDoubleSphere, camera.parameters[0], camera.parameters[1]};
      break;
    case CameraModel::kEucm:
      plane = {LensPlane::Kind::kEnhanced, camera.parameters[0], camera.parameters[1]};
      break;
  }
  return lens;
}

bool ProjectThrough(const Lens& lens, const Eigen::Vector3d& X, Pixel* pixel, Matrix2x3d* J) {
  // Metres squared: lengths whose squares neither overflow nor vanish. Also false for NaN.
  constexpr double kLeastSquare = 1e-200, kMostSquare = 1e200;
  const double square = X.squaredNorm();
  if (!(square >= kLeastSquare && square <= kMostSquare)) return false;

  Eigen::Vector2d m;
  Matrix2x3d J_plane;
  if (!lens.plane.FromRay(X, &m, J == nullptr ? nullptr : &J_plane)) return false;
  if (!lens.distortion.IsIdentity()) {
    if (!lens.distortion.InDomain(m)) return false;
    Eigen::Matrix2d J_distortion;
    m = lens.distortion.Distort(m, J == nullptr ? nullptr : &J_distortion);
    if (J != nullptr) J_plane = (J_distortion * J_plane).eval();
  }
  const Eigen::Vector2d found = lens.focal.cwiseProduct(m) + lens.centre;
  if (!found.allFinite()) return false;
  if (J != nullptr) *J = lens.focal.asDiagonal() * J_plane;
  *pixel = found;
  return true;
}

bool CheckRange(CameraModel model, std::string_view name, double value, std::string* error) {
  const char* expected = nullptr;
  if (name == "f" || name == "fx" || name == "fy" || name == "beta") {
    if (!(value > 0)) expected = "a positive number";
  } else if (name == "omega") {
    if (!(value > 0 && value < kPi)) expected = "an angle between 0 and pi";
  } else if (name == "alpha") {
    if (!(value >= 0 && value <= 1)) expected = "0 to 1";
  } else if (name == "xi" && model == CameraModel::kDoubleSphere) {
    if (!(value > -1 && value <= 1)) expected = "more than -1, at most 1";
  } else if (name == "xi") {
    if (!(value >= 0)) expected = "0 or more";
  }
  if (!std::isfinite(value)) expected = "a finite number";
  if (expected == nullptr) return true;
  *error = std::string(CameraModelName(model)) + ": " + std::string(name) + " is " +
           std::to_string(value) + ", expected " + expected;
  return false;
}

}  // namespace

const char* CameraModelName(CameraModel model) { return NameOf(kModelNames, model); }

bool ParseCameraModel(std::string_view name, CameraModel* model) {
  return FindValue(kModelNames, name, model);
}

std::string CameraModelNames() {
  std::string names;
  for (const EnumName<CameraModel>& entry : kParameterNames) {
    names += (names.empty() ? "" : ", ") + std::string(CameraModelName(entry.value));
  }
  return names;
}

const char* CameraParameterNames(CameraModel model) {
  const auto* entry = std::find_if(std::begin(kParameterNames), std::end(kParameterNames),
                                   [model](const auto& e) { return e.value == model; });
  return entry == std::end(kParameterNames) ? "" : entry->name;
}

int NumCameraParameters(CameraModel model) {
  const std::string_view names = CameraParameterNames(model);
  if (names.empty()) return 0;
  return 1 + static_cast<int>(std::count(names.begin(), names.end(), ' '));
}

Camera Camera::Pinhole(double fx, double fy, double cx, double cy, int width, int height) {
  return {CameraModel::kPinhole, {fx, fy, cx, cy}, width, height};
}

double Camera::fx() const { return parameters[NumShapeParameters(model)]; }

double Camera::fy() const {
  return parameters[NumShapeParameters(model) + (HasOneFocalLength(model) ? 0 : 1)];
}

double Camera::cx() const {
  return parameters[NumShapeParameters(model) + (HasOneFocalLength(model) ? 1 : 2)];
}

double Camera::cy() const {
  return parameters[NumShapeParameters(model) + (HasOneFocalLength(model) ? 2 : 3)];
}

Pixel Camera::PixelsPerRadian() const {
  if (IsPinhole()) return {fx(), fy()};
  const Lens lens = MakeLens(*this);
  Eigen::Vector2d m;
  Matrix2x3d J;
  // The distortion leaves the axis as it is.
  lens.plane.FromRay(Eigen::Vector3d::UnitZ(), &m, &J);
  return {fx() * J(0, 0), fy() * J(1, 1)};
}

bool Camera::IsValid(std::string* error) const {
  std::string_view names = CameraParameterNames(model);
  if (names.empty()) {
    *error = "the camera's model is none of CameraModel";
    return false;
  }
  for (int k = 0; !names.empty(); ++k) {
    const std::string_view name = names.substr(0, names.find(' '));
    if (!CheckRange(model, name, parameters[k], error)) return false;
    names.remove_prefix(std::min(name.size() + 1, names.size()));
  }
  if (width < 0 || height < 0) {
    *error = std::string(CameraModelName(model)) + ": the image size must not be negative";
    return false;
  }
  return true;
}

bool Project(const Camera& camera, const Eigen::Vector3d& X, Pixel* pixel, Matrix2x3d* J) {
  return ProjectThrough(MakeLens(camera), X, pixel, J);
}

bool Unproject(const Camera& camera, const Pixel& pixel, Eigen::Vector3d* ray, Matrix3x2d* J) {
  const Lens lens = MakeLens(camera);
  const Eigen::Vector2d distorted = (pixel - lens.centre).cwiseQuotient(lens.focal);
  Eigen::Vector2d m;
  Eigen::Vector3d found;
  if (!distorted.allFinite() || !lens.distortion.Undistort(distorted, &m) ||
      !lens.plane.ToRay(m, &found)) {
    return false;
  }
  // Is the ray in the domain?
  Pixel again;
  Matrix2x3d P;
  if (!ProjectThrough(lens, found, &again, J == nullptr ? nullptr : &P)) return false;
  if (J != nullptr) {
    // The two columns are perpendicular to the ray, and P times them is I.
    const Eigen::Vector3d p1 = P.row(0);
    const Eigen::Vector3d p2 = P.row(1);
    const double area = found.dot(p1.cross(p2));
    J->col(0) = p2.cross(found) / area;
    J->col(1) = found.cross(p1) / area;
  }
  *ray = found;
  return true;
}

Eigen::Vector3d AlongRay(const Camera& camera, const Pixel& pixel) {
  if (camera.IsPinhole()) {
    return {(pixel.x() - camera.cx()) / camera.fx(), (pixel.y() - camera.cy()) / camera.fy(), 1.0};
  }
  Eigen::Vector3d ray;
  if (Unproject(camera, pixel, &ray, nullptr)) return ray;
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

bool SameLens(const Camera& a, const Camera& b) {
  return a.model == b.model &&
         std::equal(a.parameters, a.parameters + NumCameraParameters(a.model), b.parameters);
}

}  // namespace rigel
