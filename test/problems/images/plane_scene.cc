#include "rigel/test/problems/images/plane_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace rigel {
namespace {

namespace fs = std::filesystem;

constexpr int kTextureSize = 1200;  // px
constexpr double kPixelsPerMetre = 150;

const Eigen::Vector3d kPoint(4, 0, 0);
const Eigen::Vector3d kNormal = Eigen::Vector3d(-1, 0.3, 0.2).normalized();
const Eigen::Vector3d kAcross = Eigen::Vector3d::UnitZ().cross(kNormal).normalized();
const Eigen::Vector3d kUp = kNormal.cross(kAcross);

// Noise of many scales.
cv::Mat MakeTexture() {
  cv::RNG random(1);
  cv::Mat sum(kTextureSize, kTextureSize, CV_32F, cv::Scalar(0));
  for (const double sigma : {1.5, 3.0, 6.0, 12.0}) {
    cv::Mat noise(kTextureSize, kTextureSize, CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(noise, noise, cv::Size(), sigma);
    sum += noise * sigma;  // blurred noise has a standard deviation like 1 / sigma
  }
  cv::Scalar mean, sd;
  cv::meanStdDev(sum, mean, sd);
  return (sum - mean[0]) * (45 / sd[0]) + 128;
}

ImageCamera MakeCamera(double fx, double fy, double cx, double cy, const Eigen::Quaterniond& q,
                       const Eigen::Vector3d& s, const std::array<double, 4>& distortion) {
  ImageCamera camera;
  camera.camera.intrinsics = Camera::Pinhole(fx, fy, cx, cy, 376, 240);
  camera.camera.Q = q.normalized().toRotationMatrix();
  camera.camera.s = s;
  camera.lens = camera.camera.intrinsics;
  camera.lens->model = CameraModel::kOpencv;
  std::copy(distortion.begin(), distortion.end(), camera.lens->parameters + 4);
  return camera;
}

Pose BodyFromCamera(const RigCamera& camera) {
  Pose pose;
  pose.R = camera.Q;
  pose.t = camera.s;
  return pose;
}

}  // namespace

PlaneScene::PlaneScene() : texture_(MakeTexture()) {
  cameras_.push_back(MakeCamera(229, 228, 184, 124, {0.7123, -0.0077, 0.0105, 0.7018},
                                {-0.0216, -0.0647, 0.0098}, {-0.283, 0.0740, 0.00019, 1.76e-05}));
  cameras_.push_back(MakeCamera(228, 227, 190, 128, {0.7115, -0.0026, 0.0153, 0.7025},
                                {-0.0198, 0.0454, 0.0079}, {-0.284, 0.0745, -0.0001, -3.6e-05}));
}

Pose PlaneScene::WorldFromBody(int frame) {
  // IMU of EuRoC: x up, y right, z forward.
  Pose base;
  base.R << 0, 0, 1, 0, -1, 0, 1, 0, 0;
  Pose motion;
  motion.R = ExpSO3(frame * Eigen::Vector3d(0.003, 0.004, -0.008));
  motion.t = frame * Eigen::Vector3d(0.04, 0.025, 0.01);
  return motion * base;
}

Eigen::Vector3d PlaneScene::Intersect(const Eigen::Vector3d& center,
                                      const Eigen::Vector3d& ray) const {
  return center + ray * (kNormal.dot(kPoint - center) / kNormal.dot(ray));
}

cv::Mat PlaneScene::Render(const ImageCamera& camera, const Pose& world_from_body) const {
  const Camera& c = camera.camera.intrinsics;
  const Pose world_from_camera = world_from_body * BodyFromCamera(camera.camera);
  cv::Mat map(c.height, c.width, CV_32FC2);
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) {
      const Eigen::Vector3d u = AlongRay(camera.lens.value_or(c), {x, y});
      const Eigen::Vector3d X = Intersect(world_from_camera.t, world_from_camera.R * u) - kPoint;
      map.at<cv::Vec2f>(y, x) =
          cv::Vec2f(static_cast<float>(kTextureSize / 2 + kPixelsPerMetre * kAcross.dot(X)),
                    static_cast<float>(kTextureSize / 2 - kPixelsPerMetre * kUp.dot(X)));
    }
  }
  cv::Mat seen, image;
  cv::remap(texture_, seen, map, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_CONSTANT, 128);
  seen.convertTo(image, CV_8U);
  return image;
}

Eigen::Vector2d PlaneScene::Transfer(const RigCamera& camera1, const Pose& world_from_body1,
                                     const Eigen::Vector2d& pixel1, const RigCamera& camera2,
                                     const Pose& world_from_body2) const {
  const Pose world_from_camera1 = world_from_body1 * BodyFromCamera(camera1);
  const Pose world_from_camera2 = world_from_body2 * BodyFromCamera(camera2);
  const Eigen::Vector3d X =
      Intersect(world_from_camera1.t, world_from_camera1.R * AlongRay(camera1.intrinsics, pixel1));
  Eigen::Vector2d pixel2(NAN, NAN);
  Pixel projected;
  if (Project(camera2.intrinsics, world_from_camera2.Inverse() * X, &projected)) pixel2 = projected;
  return pixel2;
}

int64_t PlaneSceneTime(int frame) { return 1403715273262142976 + frame * INT64_C(50000000); }

std::string SensorYaml(const ImageCamera& camera) {
  const Camera& c = camera.camera.intrinsics;
  const Camera lens = camera.lens.value_or(c);
  const double* const d = lens.parameters + 4;
  std::ostringstream text;
  text.precision(17);
  text << "# Default parameters\nsensor_type: camera\ncomment: VI-Sensor\n\nT_BS:\n  cols: 4\n"
       << "  rows: 4\n  data: [";
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) text << camera.camera.Q(k, j) << ", ";
    text << camera.camera.s[k] << ",\n         ";
  }
  text << "0.0, 0.0, 0.0, 1.0]\n\nrate_hz: 20\nresolution: [" << c.width << ", " << c.height
       << "]\ncamera_model: pinhole\nintrinsics: [" << c.fx() << ", " << c.fy() << ", " << c.cx()
       << ", " << c.cy() << "] #fu, fv, cu, cv\ndistortion_model: radial-tangential\n"
       << "distortion_coefficients: [" << d[0] << ", " << d[1] << ", " << d[2] << ", " << d[3]
       << "]\n\n";
  return text.str();
}

void WriteFile(const std::string& path, const std::string& text) {
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  ASSERT_TRUE(file) << path << " cannot be written";
}

void WriteImage(const std::string& path, const cv::Mat& image) {
  fs::create_directories(fs::path(path).parent_path());
  ASSERT_TRUE(cv::imwrite(path, image)) << path;
}

void WriteEurocScene(const PlaneScene& scene, int num_frames, const std::string& directory) {
  const std::string mav = directory + "/mav0";
  std::ostringstream truth;
  truth.precision(17);
  truth << "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], ...\r\n";
  for (int frame = 0; frame < num_frames; ++frame) {
    const Pose pose = PlaneScene::WorldFromBody(frame);
    const Eigen::Quaterniond q = pose.Quaternion();
    truth << PlaneSceneTime(frame) << "," << pose.t.x() << "," << pose.t.y() << "," << pose.t.z()
          << "," << q.w() << "," << q.x() << "," << q.y() << "," << q.z() << ",0,0,0,0,0,0\r\n";
  }
  WriteFile(mav + "/state_groundtruth_estimate0/data.csv", truth.str());
  for (size_t k = 0; k < scene.cameras().size(); ++k) {
    const std::string camera = mav + "/cam" + std::to_string(k);
    WriteFile(camera + "/sensor.yaml", SensorYaml(scene.cameras()[k]));
    std::string list = "#timestamp [ns],filename\r\n";
    for (int frame = 0; frame < num_frames; ++frame) {
      const std::string time = std::to_string(PlaneSceneTime(frame));
      list += time + "," + time + ".png\r\n";
      WriteImage(camera + "/data/" + time + ".png",
                 scene.Render(scene.cameras()[k], PlaneScene::WorldFromBody(frame)));
    }
    WriteFile(camera + "/data.csv", list);
  }
}

void WriteKittiScene(const PlaneScene& scene, int num_frames, const std::string& name,
                     const std::string& directory) {
  const Pose body_from_left = BodyFromCamera(scene.cameras()[0].camera);
  const std::string sequence = directory + "/sequences/" + name;
  std::string poses, times;
  const Pose left0 = PlaneScene::WorldFromBody(0) * body_from_left;
  for (int frame = 0; frame < num_frames; ++frame) {
    const Pose left = PlaneScene::WorldFromBody(frame) * body_from_left;
    const Pose pose = left0.Inverse() * left;
    char line[400];
    std::snprintf(line, sizeof(line),
                  "%.12e %.12e %.12e %.12e %.12e %.12e %.12e %.12e %.12e %.12e %.12e %.12e\n",
                  pose.R(0, 0), pose.R(0, 1), pose.R(0, 2), pose.t.x(), pose.R(1, 0), pose.R(1, 1),
                  pose.R(1, 2), pose.t.y(), pose.R(2, 0), pose.R(2, 1), pose.R(2, 2), pose.t.z());
    poses += line;
    times += std::to_string(0.1 * frame) + "\n";
    for (int k = 0; k < 2; ++k) {
      // The right camera is half a metre beside the left one.
      ImageCamera camera = scene.cameras()[0];
      camera.lens.reset();
      camera.camera.intrinsics.parameters[1] = camera.camera.intrinsics.fx();
      camera.camera.s += camera.camera.Q * Eigen::Vector3d(0.5 * k, 0, 0);
      char image[32];
      std::snprintf(image, sizeof(image), "/%06d.png", frame);
      WriteImage(sequence + "/image_" + std::to_string(k) + image,
                 scene.Render(camera, PlaneScene::WorldFromBody(frame)));
    }
  }
  WriteFile(directory + "/poses/" + name + ".txt", poses);
  WriteFile(sequence + "/times.txt", times);
  WriteFile(sequence + "/calib.txt",
            "P0: 229 0 184 0 0 229 124 0 0 0 1 0\nP1: 229 0 184 -114.5 0 229 124 0 0 0 1 0\n");
}

}  // namespace rigel
