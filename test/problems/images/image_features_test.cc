// Key points are where they should be, to a fraction of a pixel; matches are those of the scene.
#include "rigel/problems/images/image_features.h"
#include "rigel/problems/images/feature_matching.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "rigel/test/problems/images/plane_scene.h"

namespace rigel {
namespace {

using testing::HasSubstr;

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

const PlaneScene& Scene() {
  static const auto* const scene = new PlaneScene();
  return *scene;
}

ImageCamera Undistorted() {
  ImageCamera camera = Scene().cameras()[0];
  camera.lens.reset();
  return camera;
}

class ImageFeaturesTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "/rigel_features_XXXXXX";
    ASSERT_NE(mkdtemp(directory_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  ImageFeatures Extract(const FeatureOptions& options, const ImageCamera& camera,
                        const cv::Mat& image, const std::string& mask = "") {
    const std::string path = directory_ + "/image.png";
    EXPECT_TRUE(cv::imwrite(path, image));
    ImageFeatures features;
    std::string error;
    EXPECT_TRUE(ExtractFeatures(options, camera, path, mask, &features, &error)) << error;
    return features;
  }

  std::string directory_;
};

FeatureOptions Options(FeatureType type) {
  FeatureOptions options;
  options.type = type;
  return options;
}

// OpenCV's own key points are a quarter of a pixel off, all in the same direction.
TEST_F(ImageFeaturesTest, SiftFindsTheCentresOfBlobs) {
  cv::Mat image(240, 376, CV_8U);
  std::vector<Eigen::Vector2d> centers;
  for (int y = 30; y < 220; y += 45) {
    for (int x = 30; x < 350; x += 45) {
      const double fraction = 0.1 * static_cast<double>(centers.size() % 10);
      centers.emplace_back(x + fraction, y - 0.7 * fraction);
    }
  }
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      double value = 60;
      for (size_t k = 0; k < centers.size(); ++k) {
        const double sigma = 1.5 + 0.2 * static_cast<double>(k % 20);
        const double r2 = (Eigen::Vector2d(x, y) - centers[k]).squaredNorm();
        value += 150 * std::exp(-r2 / (2 * sigma * sigma));
      }
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(value);
    }
  }
  const ImageFeatures features = Extract(Options(FeatureType::kSift), Undistorted(), image);
  std::vector<double> dx, dy;
  for (const Pixel& pixel : features.pixels) {
    for (const Eigen::Vector2d& center : centers) {
      if ((pixel - center).norm() > 1) continue;
      dx.push_back(pixel.x() - center.x());
      dy.push_back(pixel.y() - center.y());
    }
  }
  ASSERT_GT(dx.size(), 30u);
  EXPECT_NEAR(Median(dx), 0, 0.02);
  EXPECT_NEAR(Median(dy), 0, 0.02);
}

// What is at (x, y) is at (width - 1 - x, height - 1 - y) of the image turned by half a turn.
// Pixels that count from another point than the centre of the first break this, and so does a
// pyramid whose levels are put upon each other wrongly: by more than a pixel for ORB.
TEST_F(ImageFeaturesTest, PixelsCountFromTheCentreOfTheFirstOnAllScales) {
  const cv::Mat image = Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0));
  cv::Mat turned;
  cv::flip(image, turned, -1);
  for (const FeatureType type : {FeatureType::kSift, FeatureType::kOrb}) {
    const FeatureOptions options = Options(type);
    const ImageFeatures a = Extract(options, Undistorted(), image);
    const ImageFeatures b = Extract(options, Undistorted(), turned);
    std::vector<Match> matches;
    AppendMatches(options, 0, a, 0, b, &matches);
    std::vector<double> dx, dy, off;
    for (const Match& match : matches) {
      const Eigen::Vector2d d =
          0.5 * (match.pixel1 + match.pixel2 - Eigen::Vector2d(image.cols - 1, image.rows - 1));
      if (d.norm() > 4) continue;
      dx.push_back(d.x());
      dy.push_back(d.y());
      off.push_back(d.norm());
    }
    ASSERT_GT(dx.size(), 100u) << FeatureTypeName(type);
    EXPECT_NEAR(Median(dx), 0, 0.01) << FeatureTypeName(type);
    EXPECT_NEAR(Median(dy), 0, 0.01) << FeatureTypeName(type);
    std::sort(off.begin(), off.end());
    EXPECT_LT(off[off.size() * 9 / 10], 0.15) << FeatureTypeName(type);
  }
}

TEST_F(ImageFeaturesTest, UndistortedMatchesFollowTheGeometryOfTheScene) {
  const Pose poses[] = {PlaneScene::WorldFromBody(0), PlaneScene::WorldFromBody(2)};
  for (const FeatureType type : {FeatureType::kSift, FeatureType::kOrb}) {
    const FeatureOptions options = Options(type);
    ImageFeatures features[2][2];
    for (int k = 0; k < 2; ++k) {
      for (int time = 0; time < 2; ++time) {
        const ImageCamera& camera = Scene().cameras()[k];
        features[time][k] = Extract(options, camera, Scene().Render(camera, poses[time]));
      }
    }
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        std::vector<Match> matches;
        AppendMatches(options, i, features[0][i], j, features[1][j], &matches);
        std::vector<double> errors, near_border;
        for (const Match& match : matches) {
          EXPECT_EQ(match.camera1, i);
          EXPECT_EQ(match.camera2, j);
          EXPECT_GE(match.score, 0);
          EXPECT_LE(match.score, options.ratio);
          const Eigen::Vector2d expected =
              Scene().Transfer(Scene().cameras()[i].camera, poses[0], match.pixel1,
                               Scene().cameras()[j].camera, poses[1]);
          errors.push_back((match.pixel2 - expected).norm());
          if (std::abs(match.pixel1.x() - 188) > 140) near_border.push_back(errors.back());
        }
        const std::string where =
            std::string(FeatureTypeName(type)) + " " + std::to_string(i) + std::to_string(j);
        // ORB's corners are whole pixels of their level.
        const double bound = type == FeatureType::kSift ? 0.2 : 1.2;
        ASSERT_GT(errors.size(), 100u) << where;
        ASSERT_GT(near_border.size(), 10u) << where;
        EXPECT_LT(Median(errors), bound) << where;
        EXPECT_LT(Median(near_border), bound) << where;
      }
    }
  }
}

TEST_F(ImageFeaturesTest, APairOfPixelsOccursOnceThoughKeyPointsHaveSeveralOrientations) {
  const FeatureOptions options;
  const cv::Mat image = Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0));
  const ImageFeatures features = Extract(options, Undistorted(), image);
  using Key = std::tuple<double, double, double, double>;
  std::set<std::pair<double, double>> pixels;
  for (const Pixel& pixel : features.pixels) pixels.insert({pixel.x(), pixel.y()});
  ASSERT_LT(pixels.size(), features.pixels.size()) << "no key point of several orientations";
  std::vector<Match> matches;
  AppendMatches(options, 0, features, 0, features, &matches);
  std::set<Key> keys;
  for (const Match& m : matches) {
    keys.insert(Key(m.pixel1.x(), m.pixel1.y(), m.pixel2.x(), m.pixel2.y()));
    EXPECT_EQ(m.pixel1, m.pixel2);
    EXPECT_EQ(m.score, 0);
  }
  EXPECT_EQ(keys.size(), matches.size());
  EXPECT_EQ(keys.size(), pixels.size());
}

// The ratio is that of the worse side, whichever image comes first.
TEST_F(ImageFeaturesTest, MatchesAreTheSameFromBothSides) {
  for (const FeatureType type : {FeatureType::kSift, FeatureType::kOrb}) {
    FeatureOptions options = Options(type);
    const ImageFeatures a = Extract(options, Undistorted(),
                                    Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0)));
    const ImageFeatures b = Extract(options, Undistorted(),
                                    Scene().Render(Undistorted(), PlaneScene::WorldFromBody(3)));
    std::vector<Match> forward, backward;
    AppendMatches(options, 0, a, 1, b, &forward);
    AppendMatches(options, 1, b, 0, a, &backward);
    const auto key = [](const Match& m, bool turned) {
      const Eigen::Vector2d& p = turned ? m.pixel2 : m.pixel1;
      const Eigen::Vector2d& q = turned ? m.pixel1 : m.pixel2;
      return std::make_tuple(p.x(), p.y(), q.x(), q.y(), m.score);
    };
    std::set<std::tuple<double, double, double, double, double>> keys;
    for (const Match& m : forward) keys.insert(key(m, false));
    ASSERT_GT(keys.size(), 50u);
    ASSERT_EQ(forward.size(), backward.size());
    for (const Match& m : backward) EXPECT_EQ(keys.count(key(m, true)), 1u);

    // A stricter ratio keeps those of the lower scores.
    options.ratio = 0.6;
    std::vector<Match> strict;
    AppendMatches(options, 0, a, 1, b, &strict);
    EXPECT_EQ(static_cast<long>(strict.size()),
              std::count_if(forward.begin(), forward.end(),
                            [](const Match& m) { return m.score <= 0.6; }));
    EXPECT_LT(strict.size(), forward.size());
  }
}

TEST_F(ImageFeaturesTest, MaxFeaturesKeepsTheStrongest) {
  const cv::Mat image = Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0));
  for (const FeatureType type : {FeatureType::kSift, FeatureType::kOrb}) {
    FeatureOptions options = Options(type);
    const size_t all = Extract(options, Undistorted(), image).pixels.size();
    options.max_features = 50;
    const size_t few = Extract(options, Undistorted(), image).pixels.size();
    EXPECT_GT(all, 200u);
    EXPECT_GE(few, 40u);
    EXPECT_LE(few, 60u);
  }
}

TEST_F(ImageFeaturesTest, AnImageWithoutKeyPointsHasNoMatches) {
  const cv::Mat flat(240, 376, CV_8U, cv::Scalar(128));
  const cv::Mat image = Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0));
  for (const FeatureType type : {FeatureType::kSift, FeatureType::kOrb}) {
    const FeatureOptions options = Options(type);
    const ImageFeatures none = Extract(options, Scene().cameras()[0], flat);
    const ImageFeatures some = Extract(options, Undistorted(), image);
    std::vector<Match> matches;
    AppendMatches(options, 0, none, 0, some, &matches);
    AppendMatches(options, 0, some, 0, none, &matches);
    AppendMatches(options, 0, none, 0, none, &matches);
    EXPECT_THAT(matches, testing::IsEmpty());
    EXPECT_EQ(none.width, 376);
    EXPECT_EQ(none.height, 240);
  }
}

// Where the lens's polynomial turns back no pixel can be undistorted: such key points are dropped.
TEST_F(ImageFeaturesTest, PixelsThatTheDistortionCannotReachAreDropped) {
  ImageCamera camera = Undistorted();
  const cv::Mat image = Scene().Render(camera, PlaneScene::WorldFromBody(0));
  const size_t all = Extract(FeatureOptions(), camera, image).pixels.size();
  camera.lens = camera.camera.intrinsics;
  camera.lens->model = CameraModel::kOpencv;
  camera.lens->parameters[4] = -1.2;  // folds at a radius of 0.53
  const ImageFeatures rest = Extract(FeatureOptions(), camera, image);
  EXPECT_GT(rest.pixels.size(), 20u);
  EXPECT_LT(rest.pixels.size(), all);
  EXPECT_EQ(rest.descriptors.rows, static_cast<int>(rest.pixels.size()));
  for (const Pixel& pixel : rest.pixels) {
    EXPECT_LT(AlongRay(camera.camera.intrinsics, pixel).head<2>().norm(), 0.6);
  }
}

TEST_F(ImageFeaturesTest, ColourImagesAreReadAsGrey) {
  const cv::Mat grey = Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0));
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, colour);
  EXPECT_EQ(Extract(FeatureOptions(), Undistorted(), colour).pixels,
            Extract(FeatureOptions(), Undistorted(), grey).pixels);
}

TEST_F(ImageFeaturesTest, WhatIsNoImageOfTheCameraIsTold) {
  const auto error_of = [](const std::string& path) {
    ImageFeatures features;
    std::string error;
    EXPECT_FALSE(ExtractFeatures(FeatureOptions(), Undistorted(), path, "", &features, &error));
    EXPECT_THAT(error, testing::StartsWith(path + ": "));
    EXPECT_THAT(error, testing::Not(HasSubstr("\n")));
    return error;
  };
  EXPECT_THAT(error_of(directory_ + "/none.png"), HasSubstr("cannot be opened: No such file"));
  EXPECT_THAT(error_of(directory_), HasSubstr("cannot be read"));
  const std::string path = directory_ + "/a.png";
  WriteFile(path, "");
  EXPECT_THAT(error_of(path), HasSubstr("not an image that can be decoded: the file is empty"));
  WriteFile(path, "This is no image.");
  EXPECT_THAT(error_of(path), HasSubstr("not an image that can be decoded"));
  ASSERT_TRUE(cv::imwrite(path, cv::Mat(100, 200, CV_8U, cv::Scalar(1))));
  EXPECT_THAT(error_of(path), HasSubstr("200 x 100 pixels, expected 376 x 240"));
  // Cut off half-way.
  ASSERT_TRUE(cv::imwrite(path, Scene().Render(Undistorted(), PlaneScene::WorldFromBody(0))));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_THAT(error_of(path), HasSubstr("the image is cut off"));
  // Its head announces more than is decoded: width and height at bytes 16 and 20, the end in place.
  const std::string head("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  const std::string end = "IEND\xae\x42\x60\x82";
  WriteFile(path, head + std::string("\0\0\x4e\x20\0\0\x4e\x20", 8) + end);  // 20000 x 20000
  EXPECT_THAT(error_of(path), HasSubstr("400000000 pixels, expected at most 200 million"));
  WriteFile(path,
            std::string("\xff\xd8\xff\xe0\0\x04xx\xff\xc0\0\x0b\x08\xff\xff\xff\xff\x01", 19));
  EXPECT_THAT(error_of(path), HasSubstr("4294836225 pixels, expected at most 200 million"));
  // A file of no end is not read to it.
  WriteFile(path, "");
  std::filesystem::resize_file(path, uintmax_t{1} << 40);
  EXPECT_THAT(error_of(path), HasSubstr("more than 1 GiB"));
}

}  // namespace
}  // namespace rigel
