#include "rigel/core/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "rigel/test/core/camera_cases.h"
#include "rigel/test/core/pinhole.h"

namespace rigel {
namespace {

constexpr int kNumModels = 14;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// In the plane of x and z.
Eigen::Vector3d RayAt(double angle) { return {std::sin(angle), 0.0, std::cos(angle)}; }

// The largest angle in the plane of x and z that is projected, by bisection.
double WidestAngle(const Camera& camera) {
  double in = 0;
  double out = 180.0 * kRadiansPerDegree;
  for (int k = 0; k < 60; ++k) {
    const double angle = 0.5 * (in + out);
    Pixel pixel;
    (Project(camera, RayAt(angle), &pixel, nullptr) ? in : out) = angle;
  }
  return in;
}

class CameraModels : public testing::TestWithParam<CameraCase> {};

TEST_P(CameraModels, UnprojectInvertsProject) {
  const Camera& camera = GetParam().camera;
  std::string error;
  ASSERT_TRUE(camera.IsValid(&error)) << error;
  Random random(1);
  int num_beyond_90 = 0;
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d X = RandomRay(GetParam(), &random);
    Pixel pixel;
    Eigen::Vector3d ray;
    ASSERT_TRUE(Project(camera, X, &pixel, nullptr)) << X.transpose();
    ASSERT_TRUE(Unproject(camera, pixel, &ray, nullptr)) << X.transpose();
    EXPECT_LT(AngleBetween(ray, X), 1e-9) << X.transpose();
    EXPECT_NEAR(ray.norm(), 1.0, 1e-14);
    num_beyond_90 += X.z() < 0 ? 1 : 0;
  }
  EXPECT_EQ(num_beyond_90 > 0, GetParam().half_view_deg > 90);
}

// Central differences, with the error of two steps extrapolated to none.
TEST_P(CameraModels, JacobianOfProjectIsItsDerivative) {
  const Camera& camera = GetParam().camera;
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d X = RandomRay(GetParam(), &random);
    Pixel pixel, plus, minus;
    Matrix2x3d J;
    ASSERT_TRUE(Project(camera, X, &pixel, &J));
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector2d slope[2];
      for (int half : {0, 1}) {
        const double step = 1e-3 * X.norm() / (1 + half);
        const Eigen::Vector3d move = step * Eigen::Vector3d::Unit(i);
        if (!Project(camera, X + move, &plus, nullptr)) return;
        if (!Project(camera, X - move, &minus, nullptr)) return;
        slope[half] = (plus - minus) / (2 * step);
      }
      const Eigen::Vector2d numeric = (4 * slope[1] - slope[0]) / 3;
      EXPECT_LT((J.col(i) - numeric).norm(), 1e-6 * J.norm()) << X.transpose();
    }
  }
}

TEST_P(CameraModels, JacobianOfUnprojectIsItsDerivative) {
  const Camera& camera = GetParam().camera;
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d X = RandomRay(GetParam(), &random);
    Pixel pixel;
    Eigen::Vector3d ray, plus, minus;
    Matrix2x3d P;
    Matrix3x2d J;
    ASSERT_TRUE(Project(camera, X.normalized(), &pixel, &P));
    ASSERT_TRUE(Unproject(camera, pixel, &ray, &J));
    EXPECT_LT((P * J - Eigen::Matrix2d::Identity()).norm(), 1e-9) << X.transpose();
    EXPECT_LT((ray.transpose() * J).norm(), 1e-12 * J.norm());
    for (int i = 0; i < 2; ++i) {
      Eigen::Vector3d slope[2];
      for (int half : {0, 1}) {
        const double step = 0.1 / (1 + half);
        const Eigen::Vector2d move = step * Eigen::Vector2d::Unit(i);
        ASSERT_TRUE(Unproject(camera, pixel + move, &plus, nullptr));
        ASSERT_TRUE(Unproject(camera, pixel - move, &minus, nullptr));
        slope[half] = (plus - minus) / (2 * step);
      }
      const Eigen::Vector3d numeric = (4 * slope[1] - slope[0]) / 3;
      EXPECT_LT((J.col(i) - numeric).norm(), 1e-6 * J.norm()) << X.transpose();
    }
  }
}

TEST_P(CameraModels, AxisIsThePrincipalPoint) {
  const Camera& camera = GetParam().camera;
  Pixel centre, right, below;
  ASSERT_TRUE(Project(camera, {0, 0, 3}, &centre, nullptr));
  Eigen::Vector3d ray;
  Matrix3x2d J;
  ASSERT_TRUE(Unproject(camera, centre, &ray, &J));
  EXPECT_LT(ray.head<2>().norm(), 1e-14);
  ASSERT_TRUE(Project(camera, {0.1, 0, 3}, &right, nullptr));
  ASSERT_TRUE(Project(camera, {0, 0.1, 3}, &below, nullptr));
  EXPECT_GT(right.x(), centre.x());
  EXPECT_GT(below.y(), centre.y());
  EXPECT_GT(J(0, 0), 0);
  EXPECT_GT(J(1, 1), 0);
}

// Over the whole sphere and far around the image: what is not refused is right.
TEST_P(CameraModels, RefusesOrIsRight) {
  const Camera& camera = GetParam().camera;
  Random random(4);
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d X = random.UnitVector3();
    Pixel pixel;
    Eigen::Vector3d ray;
    if (Project(camera, X, &pixel, nullptr)) {
      ASSERT_TRUE(Unproject(camera, pixel, &ray, nullptr)) << X.transpose();
      EXPECT_LT(AngleBetween(ray, X), 1e-8) << X.transpose();
    }
    const double u = random.Uniform(-2.0, 3.0) * camera.width;
    const double v = random.Uniform(-2.0, 3.0) * camera.height;
    if (Unproject(camera, {u, v}, &ray, nullptr)) {
      ASSERT_TRUE(Project(camera, ray, &pixel, nullptr));
      EXPECT_LT((pixel - Pixel(u, v)).norm(), 1e-7);
    }
  }
}

// From the axis to the end of the domain the image moves outwards, and the domain has no gap.
TEST_P(CameraModels, RadiusGrowsUpToTheEndOfTheDomain) {
  const Camera& camera = GetParam().camera;
  const double widest = WidestAngle(camera);
  EXPECT_GE(widest, GetParam().half_view_deg * kRadiansPerDegree);
  Pixel last, pixel;
  ASSERT_TRUE(Project(camera, RayAt(0), &last, nullptr));
  constexpr int kNumSteps = 1000;
  for (int k = 1; k < kNumSteps; ++k) {
    ASSERT_TRUE(Project(camera, RayAt(k * widest / kNumSteps), &pixel, nullptr));
    ASSERT_GT(pixel.x(), last.x());
    last = pixel;
    const double outside = widest + 1e-6 + k * (180 * kRadiansPerDegree - widest) / kNumSteps;
    ASSERT_FALSE(Project(camera, RayAt(outside), &pixel, nullptr)) << outside;
  }
}

TEST_P(CameraModels, RefusesWhatIsNoPointOrPixel) {
  const Camera& camera = GetParam().camera;
  Pixel pixel(-7, -8);
  Matrix2x3d P = Matrix2x3d::Zero();
  for (const Eigen::Vector3d& X :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, kNaN, 1),
        Eigen::Vector3d(kNaN, 0, 1), Eigen::Vector3d(0, 0, kNaN), Eigen::Vector3d(0, 0, kInfinity),
        Eigen::Vector3d(kInfinity, 0, 1), Eigen::Vector3d(1e-160, 0, 1e-160),
        Eigen::Vector3d(1e160, 0, 1e160)}) {
    EXPECT_FALSE(Project(camera, X, &pixel, &P)) << X.transpose();
  }
  Eigen::Vector3d ray(5, 6, 7);
  Matrix3x2d J = Matrix3x2d::Zero();
  for (double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(Unproject(camera, {bad, 0}, &ray, &J));
    EXPECT_FALSE(Unproject(camera, {0, bad}, &ray, &J));
  }
  // Nothing is written then.
  EXPECT_EQ(pixel, Pixel(-7, -8));
  EXPECT_EQ(P, Matrix2x3d::Zero());
  EXPECT_EQ(ray, Eigen::Vector3d(5, 6, 7));
  EXPECT_EQ(J, Matrix3x2d::Zero());
}

INSTANTIATE_TEST_SUITE_P(Cases, CameraModels, testing::ValuesIn(CameraCases()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CameraModel, EachHasANameThatIsRead) {
  for (int k = 0; k < kNumModels; ++k) {
    const auto model = static_cast<CameraModel>(k);
    CameraModel read = static_cast<CameraModel>(kNumModels);
    ASSERT_TRUE(ParseCameraModel(CameraModelName(model), &read)) << k;
    EXPECT_EQ(read, model);
    const std::vector<CameraCase> cases = CameraCases();
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(),
                            [model](const CameraCase& c) { return c.camera.model == model; }));
  }
  EXPECT_STREQ(CameraModelName(CameraModel::kThinPrismFisheye), "thin_prism_fisheye");
  EXPECT_STREQ(CameraModelName(CameraModel::kOpencv), "opencv");
}

TEST(CameraModel, NamesOfKalibrAreRead) {
  CameraModel model = CameraModel::kFov;
  EXPECT_TRUE(ParseCameraModel("radtan", &model));
  EXPECT_EQ(model, CameraModel::kOpencv);
  EXPECT_TRUE(ParseCameraModel("equidistant", &model));
  EXPECT_EQ(model, CameraModel::kOpencvFisheye);
  for (const char* name : {"", "Pinhole", "PINHOLE", "fisheye624", "pinhole "}) {
    EXPECT_FALSE(ParseCameraModel(name, &model)) << name;
  }
  EXPECT_EQ(model, CameraModel::kOpencvFisheye);
}

TEST(CameraModel, CountsParameters) {
  const int expected[kNumModels] = {4, 3, 4, 5, 8, 12, 8, 4, 5, 12, 5, 9, 6, 6};
  for (int k = 0; k < kNumModels; ++k) {
    EXPECT_EQ(NumCameraParameters(static_cast<CameraModel>(k)), expected[k]) << k;
  }
  EXPECT_STREQ(CameraParameterNames(CameraModel::kOmni), "xi fx fy cx cy k1 k2 p1 p2");
  EXPECT_EQ(NumCameraParameters(static_cast<CameraModel>(kNumModels)), 0);
}

void ExpectInvalid(const Camera& camera, const std::string& message) {
  std::string error;
  EXPECT_FALSE(camera.IsValid(&error)) << message;
  EXPECT_EQ(error, message);
}

TEST(CameraModel, RefusesParametersOutOfTheirRange) {
  using M = CameraModel;
  ExpectInvalid({M::kPinhole, {0, 400, 1, 1}, 9, 9},
                "pinhole: fx is 0.000000, expected a positive number");
  ExpectInvalid({M::kRadial, {-5, 1, 1}, 9, 9},
                "radial: f is -5.000000, expected a positive number");
  ExpectInvalid({M::kOmni, {1, 400, -1, 1, 1}, 9, 9},
                "omni: fy is -1.000000, expected a positive number");
  ExpectInvalid({M::kOmni, {-0.5, 400, 400, 1, 1}, 9, 9},
                "omni: xi is -0.500000, expected 0 or more");
  ExpectInvalid({M::kDoubleSphere, {-1, 0.5, 400, 400, 1, 1}, 9, 9},
                "double_sphere: xi is -1.000000, expected more than -1, at most 1");
  ExpectInvalid({M::kDoubleSphere, {0, 1.5, 400, 400, 1, 1}, 9, 9},
                "double_sphere: alpha is 1.500000, expected 0 to 1");
  ExpectInvalid({M::kEucm, {-0.1, 1, 400, 400, 1, 1}, 9, 9},
                "eucm: alpha is -0.100000, expected 0 to 1");
  ExpectInvalid({M::kEucm, {0.5, 0, 400, 400, 1, 1}, 9, 9},
                "eucm: beta is 0.000000, expected a positive number");
  ExpectInvalid({M::kFov, {400, 400, 1, 1, 0}, 9, 9},
                "fov: omega is 0.000000, expected an angle between 0 and pi");
  ExpectInvalid({M::kFov, {400, 400, 1, 1, 3.2}, 9, 9},
                "fov: omega is 3.200000, expected an angle between 0 and pi");
  ExpectInvalid({M::kPinhole, {400, 400, 1, 1}, -1, 9},
                "pinhole: the image size must not be negative");
  ExpectInvalid({static_cast<M>(kNumModels), {400, 400, 1, 1}, 9, 9},
                "the camera's model is none of CameraModel");
  for (const CameraCase& camera_case : CameraCases()) {
    for (int k = 0; k < NumCameraParameters(camera_case.camera.model); ++k) {
      for (double bad : {kNaN, kInfinity, -kInfinity}) {
        Camera camera = camera_case.camera;
        camera.parameters[k] = bad;
        std::string error;
        EXPECT_FALSE(camera.IsValid(&error)) << camera_case.name << " " << k;
        EXPECT_NE(error.find("expected"), std::string::npos) << error;
      }
    }
  }
}

TEST(CameraModel, SizeMayBeUnknown) {
  std::string error;
  EXPECT_TRUE(Camera().IsValid(&error));
}

// Different fx and fy, centre off the middle: swapped or shared parameters show.
const Camera kCamera = Camera::Pinhole(400.0, 500.0, 310.0, 250.0, 640, 480);

TEST(CameraModel, PinholeProjectsTheOpticalAxisToThePrincipalPoint) {
  Pixel pixel;
  ASSERT_TRUE(Project(kCamera, {0.0, 0.0, 7.0}, &pixel));
  EXPECT_EQ(pixel, Pixel(310.0, 250.0));
}

TEST(CameraModel, XIsToTheRightAndYIsDown) {
  Pixel pixel;
  ASSERT_TRUE(Project(kCamera, {1.0, 0.0, 2.0}, &pixel));
  EXPECT_EQ(pixel, Pixel(510.0, 250.0));
  ASSERT_TRUE(Project(kCamera, {0.0, 1.0, 2.0}, &pixel));
  EXPECT_EQ(pixel, Pixel(310.0, 500.0));
}

TEST(CameraModel, InImageExcludesTheFarBorders) {
  EXPECT_TRUE(kCamera.InImage({0.0, 0.0}));
  EXPECT_TRUE(kCamera.InImage({639.9, 479.9}));
  EXPECT_FALSE(kCamera.InImage({640.0, 100.0}));
  EXPECT_FALSE(kCamera.InImage({100.0, 480.0}));
  EXPECT_FALSE(kCamera.InImage({-0.1, 100.0}));
  EXPECT_FALSE(kCamera.InImage({100.0, -0.1}));
}

TEST_P(CameraModels, KnowsItsFocalLengthsAndScale) {
  const Camera& camera = GetParam().camera;
  // The principal point is the image of the axis.
  Pixel pixel;
  Matrix2x3d J;
  ASSERT_TRUE(Project(camera, Eigen::Vector3d::UnitZ(), &pixel, &J));
  EXPECT_LT((pixel - Pixel(camera.cx(), camera.cy())).norm(), 1e-12);
  const Pixel scale = camera.PixelsPerRadian();
  EXPECT_NEAR(scale.x(), J(0, 0), 1e-12 * J(0, 0));
  EXPECT_NEAR(scale.y(), J(1, 1), 1e-12 * J(1, 1));
  EXPECT_NEAR(scale.x() / scale.y(), camera.fx() / camera.fy(), 1e-12);
  EXPECT_EQ(camera.IsPinhole(),
            camera.model == CameraModel::kPinhole || camera.model == CameraModel::kSimplePinhole);
  EXPECT_TRUE(SameLens(camera, camera));
  Camera other = camera;
  other.parameters[NumCameraParameters(camera.model) - 1] += 1e-9;
  EXPECT_FALSE(SameLens(camera, other));
}

TEST_P(CameraModels, AlongRayIsAlongTheRay) {
  const Camera& camera = GetParam().camera;
  Random random(9);
  for (int k = 0; k < 100; ++k) {
    Pixel pixel;
    const Eigen::Vector3d X = RandomRay(GetParam(), &random);
    ASSERT_TRUE(Project(camera, X, &pixel));
    const Eigen::Vector3d along = AlongRay(camera, pixel);
    EXPECT_LT(AngleBetween(along, X), 1e-9);
    if (camera.IsPinhole()) {
      EXPECT_EQ(along.z(), 1.0);
    } else {
      EXPECT_NEAR(along.norm(), 1.0, 1e-14);
    }
  }
}

TEST(CameraModel, AlongRayIsNanWithoutARay) {
  const Camera camera = {CameraModel::kOpencvFisheye, {300, 300, 320, 240}, 640, 480};
  EXPECT_TRUE(AlongRay(camera, {-300, 240}).array().isNaN().all() == false);
  EXPECT_TRUE(AlongRay(camera, {2000, 240}).array().isNaN().all());
}

TEST(CameraModel, PinholeHasTheUsualFormula) {
  const Camera& camera = kCamera;
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    Eigen::Vector3d X = random.UnitVector3();
    X.z() = std::abs(X.z()) + 0.01;
    Pixel pixel;
    Eigen::Vector3d ray;
    ASSERT_TRUE(Project(camera, X, &pixel, nullptr));
    EXPECT_LT((pixel - ProjectPinhole(camera, X)).norm(), 1e-10);
    ASSERT_TRUE(Unproject(camera, pixel, &ray, nullptr));
    EXPECT_LT((ray - AlongRay(camera, pixel).normalized()).norm(), 1e-14);
  }
}

// With nothing of their own each model is one of two.
TEST(CameraModel, SpecialCasesArePinholeOrEquidistant) {
  using M = CameraModel;
  const Camera pinhole = {M::kPinhole, {400, 400, 320, 240}, 640, 480};
  const Camera like_pinhole[] = {
      {M::kSimplePinhole, {400, 320, 240}, 640, 480},
      {M::kSimpleRadial, {400, 320, 240}, 640, 480},
      {M::kRadial, {400, 320, 240}, 640, 480},
      {M::kOpencv, {400, 400, 320, 240}, 640, 480},
      {M::kFullOpencv, {400, 400, 320, 240}, 640, 480},
      // The radial parts of numerator and denominator cancel.
      {M::kFullOpencv, {400, 400, 320, 240, 0.1, 0.2, 0, 0, 0.3, 0.1, 0.2, 0.3}, 640, 480},
      {M::kOmni, {0, 400, 400, 320, 240}, 640, 480},
      {M::kDoubleSphere, {0, 0, 400, 400, 320, 240}, 640, 480},
      {M::kEucm, {0, 1, 400, 400, 320, 240}, 640, 480},
      {M::kFov, {400, 400, 320, 240, 1e-9}, 640, 480}};
  const Camera equidistant = {M::kOpencvFisheye, {400, 400, 320, 240}, 640, 480};
  const double half_turn = 180 * kRadiansPerDegree;
  const Camera like_equidistant[] = {
      {M::kSimpleRadialFisheye, {400, 320, 240}, 640, 480},
      {M::kRadialFisheye, {400, 320, 240}, 640, 480},
      {M::kThinPrismFisheye, {400, 400, 320, 240}, 640, 480},
      // 2 tan(w / 2) = 1
      {M::kFov,
       {400 * 2 * std::atan(0.5), 400 * 2 * std::atan(0.5), 320, 240, 2 * std::atan(0.5)},
       640,
       480}};
  Random random(6);
  for (int k = 0; k < 100; ++k) {
    Eigen::Vector3d X = random.UnitVector3();
    Pixel expected, pixel;
    ASSERT_TRUE(Project(equidistant, X, &expected, nullptr));
    const double angle = AngleBetween(X, Eigen::Vector3d::UnitZ());
    EXPECT_NEAR((expected - Pixel(320, 240)).norm(), 400 * angle, 1e-9);
    EXPECT_LT(angle, half_turn);
    for (const Camera& camera : like_equidistant) {
      ASSERT_TRUE(Project(camera, X, &pixel, nullptr)) << CameraModelName(camera.model);
      EXPECT_LT((pixel - expected).norm(), 1e-9) << CameraModelName(camera.model);
    }
    X.z() = std::abs(X.z()) + 0.01;
    ASSERT_TRUE(Project(pinhole, X, &expected, nullptr));
    for (const Camera& camera : like_pinhole) {
      ASSERT_TRUE(Project(camera, X, &pixel, nullptr)) << CameraModelName(camera.model);
      EXPECT_LT((pixel - expected).norm(), 1e-7) << CameraModelName(camera.model);
    }
  }
}

struct Ending {
  Camera camera;
  double widest;  // radians, the end of the domain
};

TEST(CameraModel, DomainEndsWhereTheFormulaFoldsOrEnds) {
  using M = CameraModel;
  const double half_turn = 180 * kRadiansPerDegree;
  const Ending endings[] = {
      {{M::kPinhole, {400, 400, 320, 240}, 640, 480}, half_turn / 2},
      // 1 + 3 k r^2 = 0
      {{M::kSimpleRadial, {400, 320, 240, -0.3}, 640, 480}, std::atan(std::sqrt(1 / 0.9))},
      {{M::kOpencv, {400, 400, 320, 240, -0.3}, 640, 480}, std::atan(std::sqrt(1 / 0.9))},
      // 1 - 0.9 r^2 + 0.25 r^4 has no zero, 1 - 0.9 r^2 + 0.2 r^4 has two: the first
      {{M::kRadial, {400, 320, 240, -0.3, 0.05}, 640, 480}, std::atan(kInfinity)},
      {{M::kRadial, {400, 320, 240, -0.3, 0.04}, 640, 480}, std::atan(std::sqrt(2.0))},
      // The denominator 1 - 0.25 r^2 is zero; without a numerator the radius grows up to there.
      {{M::kFullOpencv, {400, 400, 320, 240, 0, 0, 0, 0, 0, -0.25}, 640, 480}, std::atan(2.0)},
      // r / (1 + r^2) grows up to 1.
      {{M::kFullOpencv, {400, 400, 320, 240, 0, 0, 0, 0, 0, 1.0}, 640, 480}, half_turn / 4},
      {{M::kSimpleRadialFisheye, {400, 320, 240, -0.1}, 640, 480}, std::sqrt(1 / 0.3)},
      {{M::kOpencvFisheye, {400, 400, 320, 240, 0.01}, 640, 480}, half_turn},
      {{M::kFov, {400, 400, 320, 240, 0.9}, 640, 480}, half_turn},
      {{M::kOmni, {0.8, 400, 400, 320, 240}, 640, 480}, std::acos(-0.8)},
      {{M::kOmni, {1.25, 400, 400, 320, 240}, 640, 480}, std::acos(-0.8)},
      // alpha = 2/3: the angle at the second sphere is 120 degrees, as it is for alpha = 1/3.
      {{M::kEucm, {2 / 3.0, 1, 400, 400, 320, 240}, 640, 480}, half_turn * 2 / 3},
      {{M::kEucm, {1 / 3.0, 1, 400, 400, 320, 240}, 640, 480}, half_turn * 2 / 3},
      // beta = 4 doubles the tangent of that.
      {{M::kEucm, {2 / 3.0, 4, 400, 400, 320, 240}, 640, 480},
       half_turn - std::atan(std::sqrt(3.0) / 2)},
      {{M::kDoubleSphere, {0, 2 / 3.0, 400, 400, 320, 240}, 640, 480}, half_turn * 2 / 3},
      // The ray from the second centre, 1/2 behind the first sphere's centre, at 120 degrees, meets
      // the unit sphere at (x, -x / sqrt(3) - 1/2).
      {{M::kDoubleSphere, {0.5, 2 / 3.0, 400, 400, 320, 240}, 640, 480},
       2 * half_turn / 3 + std::asin(0.5 * std::sin(half_turn / 3))},
  };
  for (const Ending& ending : endings) {
    const double widest = WidestAngle(ending.camera);
    const std::string name = CameraModelName(ending.camera.model);
    EXPECT_LT(widest, ending.widest + 1e-12) << name;
    EXPECT_GT(widest, ending.widest - 2e-3) << name;
    // Just inside, the ray is the right one.
    Pixel pixel;
    Eigen::Vector3d ray;
    const double inside = widest - 1e-5;
    ASSERT_TRUE(Project(ending.camera, RayAt(inside), &pixel, nullptr)) << name;
    ASSERT_TRUE(Unproject(ending.camera, pixel, &ray, nullptr)) << name;
    EXPECT_LT(AngleBetween(ray, RayAt(inside)), 1e-8) << name;
    // Its image's end: no ray has a pixel beyond, where there is one.
    if (pixel.x() > 1e5) continue;
    EXPECT_FALSE(
        Unproject(ending.camera, {pixel.x() + 0.01 * (pixel.x() - 320), 240}, &ray, nullptr))
        << name;
  }
}

// r (1 - 0.3 r^2) at r = 1.5 is the image of r = 0.51 as well.
TEST(CameraModel, RefusesWhatIsFoldedOver) {
  const Camera camera = {CameraModel::kSimpleRadial, {400, 320, 240, -0.3}, 640, 480};
  Pixel pixel;
  EXPECT_TRUE(Project(camera, {1.0, 0, 1}, &pixel, nullptr));
  EXPECT_FALSE(Project(camera, {1.1, 0, 1}, &pixel, nullptr));
  EXPECT_FALSE(Project(camera, {1.5, 0, 1}, &pixel, nullptr));
  EXPECT_FALSE(Project(camera, {100, 0, 1}, &pixel, nullptr));
  // The largest radius, at 1.054, is 0.7027 focal lengths.
  Eigen::Vector3d ray;
  EXPECT_TRUE(Unproject(camera, {320 + 400 * 0.7026, 240}, &ray, nullptr));
  EXPECT_LT(ray.x() / ray.z(), 1.0541);
  EXPECT_FALSE(Unproject(camera, {320 + 400 * 0.7028, 240}, &ray, nullptr));
  EXPECT_FALSE(Unproject(camera, {0, -4000}, &ray, nullptr));
}

// The condition of Usenko et al. 2018, eq. 43-45, lies in the domain for xi >= 0.
TEST(CameraModel, DoubleSphereTakesAllPointsThatItsAuthorsTake) {
  for (double xi = 0; xi < 1; xi += 0.1) {
    for (double alpha = 0.05; alpha < 1; alpha += 0.05) {
      const Camera camera = {CameraModel::kDoubleSphere, {xi, alpha, 400, 400, 320, 240}, 640, 480};
      const double w1 = alpha > 0.5 ? (1 - alpha) / alpha : alpha / (1 - alpha);
      const double w2 = (w1 + xi) / std::sqrt(2 * w1 * xi + xi * xi + 1);
      EXPECT_LT(std::cos(WidestAngle(camera)), -w2 + 1e-3) << xi << " " << alpha;
    }
  }
}

// Distortions that no lens has, with tangential and prism terms that fold before the radial part.
TEST(CameraModel, AnyDistortionIsRefusedOrInverted) {
  using M = CameraModel;
  const M models[] = {M::kOpencv, M::kFullOpencv, M::kOpencvFisheye, M::kThinPrismFisheye,
                      M::kOmni};
  Random random(7);
  int num_projected = 0;
  int num_lost = 0;
  for (int k = 0; k < 2000; ++k) {
    Camera camera = {models[k % 5], {300, 300, 320, 240}, 640, 480};
    double* p = camera.parameters + 4;
    if (camera.model == M::kOmni) {
      camera = {M::kOmni, {random.Uniform(0, 2), 300, 300, 320, 240}, 640, 480};
      p = camera.parameters + 5;
    }
    const double size = random.Uniform(0, 1);
    while (p < camera.parameters + NumCameraParameters(camera.model)) {
      *p++ = size * random.Uniform(-1, 1);
    }
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d X = random.UnitVector3();
      Pixel pixel;
      Eigen::Vector3d ray;
      if (!Project(camera, X, &pixel, nullptr)) continue;
      ++num_projected;
      if (!Unproject(camera, pixel, &ray, nullptr)) {
        ++num_lost;
        continue;
      }
      ASSERT_LT(AngleBetween(ray, X), 1e-6) << CameraModelName(camera.model) << " " << k;
    }
  }
  EXPECT_GT(num_projected, 5000);
  EXPECT_EQ(num_lost, 0);
}

}  // namespace
}  // namespace rigel
