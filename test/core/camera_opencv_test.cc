// OpenCV's projections of the same points. In the program of rigel_match's tests, which links
// OpenCV.
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "rigel/test/core/camera_cases.h"

namespace rigel {
namespace {

struct OpencvCamera {
  cv::Matx33d K;
  std::vector<double> distortion;
  bool is_fisheye = false;
};

// False for models that OpenCV does not have.
bool ToOpencv(const Camera& camera, OpencvCamera* opencv) {
  const double* p = camera.parameters;
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
      opencv->distortion = {0, 0, 0, 0};
      break;
    case CameraModel::kSimpleRadial:
      opencv->distortion = {p[3], 0, 0, 0};
      break;
    case CameraModel::kRadial:
      opencv->distortion = {p[3], p[4], 0, 0};
      break;
    case CameraModel::kPinhole:
    case CameraModel::kOpencv:
    case CameraModel::kOpencvFisheye:
      opencv->distortion = {p[4], p[5], p[6], p[7]};
      break;
    case CameraModel::kFullOpencv:
      opencv->distortion = {p + 4, p + 12};
      break;
    default:
      return false;
  }
  opencv->is_fisheye = camera.model == CameraModel::kOpencvFisheye;
  const bool one_focal = NumCameraParameters(camera.model) < 4 ||
                         camera.model == CameraModel::kSimpleRadial ||
                         camera.model == CameraModel::kRadial;
  opencv->K = one_focal ? cv::Matx33d(p[0], 0, p[1], 0, p[0], p[2], 0, 0, 1)
                        : cv::Matx33d(p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1);
  return true;
}

TEST(CameraModel, ProjectsLikeOpencv) {
  int num_compared = 0;
  for (const CameraCase& camera_case : CameraCases()) {
    OpencvCamera opencv;
    if (!ToOpencv(camera_case.camera, &opencv)) continue;
    Random random(9);
    std::vector<cv::Point3d> points;
    while (points.size() < 1000) {
      const Eigen::Vector3d X = RandomRay(camera_case, &random);
      // Beyond 90 degrees OpenCV's fisheye mirrors the ray.
      if (X.z() > 0) points.emplace_back(X.x(), X.y(), X.z());
    }
    std::vector<cv::Point2d> expected;
    const cv::Vec3d none(0, 0, 0);
    if (opencv.is_fisheye) {
      cv::fisheye::projectPoints(points, expected, none, none, opencv.K, opencv.distortion);
    } else {
      cv::projectPoints(points, none, none, opencv.K, opencv.distortion, expected);
    }
    for (size_t k = 0; k < points.size(); ++k) {
      Pixel pixel;
      ASSERT_TRUE(
          Project(camera_case.camera, {points[k].x, points[k].y, points[k].z}, &pixel, nullptr));
      EXPECT_LT((pixel - Pixel(expected[k].x, expected[k].y)).norm(), 1e-6) << camera_case.name;
    }
    ++num_compared;
  }
  EXPECT_EQ(num_compared, 13);
}

}  // namespace
}  // namespace rigel
