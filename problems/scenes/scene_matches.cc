#include "rigel/problems/scenes/scene_matches.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rigel/problems/scenes/image_noise.h"

namespace rigel {
namespace {

// Lowe's ratio test: no match has a larger score.
constexpr double kRatioTest = 0.8;
// An outlier's score is distributed as the largest of so many uniform numbers, as SIFT's on KITTI.
constexpr double kOutlierDraws = 11.0;

class MatchDrawer {
 public:
  MatchDrawer(const SceneMatchOptions& options, SceneGeometry* geometry, Random* random,
              FramePair* pair)
      : options_(options), geometry_(*geometry), random_(*random), pair_(*pair) {}

  bool Draw(std::string* error) {
    const int n = options_.num_matches;
    pair_.matches.clear();
    pair_.columns = MatchColumns();
    pair_.columns.inlier.assign(n, 1);
    pair_.columns.exact.resize(n);
    StateNoise();
    const int num_inter = static_cast<int>(std::lround(options_.inter_share * n));
    pair_.matches.reserve(n);
    for (int k = 0; k < n; ++k) {
      Match match;
      if (!geometry_.DrawMatch(k, k >= n - num_inter, &random_, &match, error)) return false;
      pair_.matches.push_back(match);
      AddNoise(k);
    }
    // Outliers among all matches alike: the first num_outliers of a random order.
    order_.resize(n);
    for (int k = 0; k < n; ++k) order_[k] = k;
    const int num_outliers = static_cast<int>(std::lround(options_.outlier_share * n));
    for (int k = 0; k < num_outliers; ++k) {
      std::swap(order_[k], order_[k + random_.Index(n - k)]);
      MakeOutlier(order_[k]);
    }
    // Drawn last, so that the rest of a pair is the same with and without them.
    const int num_moving =
        std::min(static_cast<int>(std::lround(options_.moving_share * n)), n - num_outliers);
    for (int k = num_outliers; k < num_outliers + num_moving; ++k) {
      std::swap(order_[k], order_[k + random_.Index(n - k)]);
    }
    if (num_moving > 0 && !MoveToCars(num_outliers, num_outliers + num_moving)) {
      *error = "hardly any point of a car in front of the rig is in view of its cameras";
      return false;
    }
    if (options_.match_scores) DrawScores(num_outliers);
    FillSigmas();
    return true;
  }

 private:
  double SigmaOf(int camera) const {
    return options_.camera_noise_px.empty() ? options_.noise_px : options_.camera_noise_px[camera];
  }

  void StateNoise() {
    double sum = 0;
    for (int k = 0; k < pair_.rig.size(); ++k) sum += SigmaOf(k) * SigmaOf(k);
    const double sigma =
        options_.camera_noise_px.empty() ? options_.noise_px : std::sqrt(sum / pair_.rig.size());
    if (sigma > 0) pair_.noise_px = StandardDeviation(options_.noise_model) * sigma;
  }

  // To the match's exact pixels.
  void AddNoise(int k) {
    Match& match = pair_.matches[k];
    pair_.columns.exact[k] = {match.pixel1.x(), match.pixel1.y(), match.pixel2.x(),
                              match.pixel2.y()};
    match.pixel1 += DrawNoise(options_.noise_model, SigmaOf(match.camera1), &random_);
    match.pixel2 += DrawNoise(options_.noise_model, SigmaOf(match.camera2), &random_);
  }

  void MakeOutlier(int k) {
    Match& match = pair_.matches[k];
    match.pixel2 = DrawPixel(pair_.rig.cameras[match.camera2].intrinsics, &random_);
    pair_.columns.inlier[k] = 0;
    pair_.columns.exact[k] = {match.pixel1.x(), match.pixel1.y(), match.pixel2.x(),
                              match.pixel2.y()};
  }

  // Moves the matches order_[begin], ..., order_[end - 1]. False if no car was found that all their
  // cameras see.
  bool MoveToCars(int begin, int end) {
    // Cars drawn before giving up: one that all these cameras see may be rare or impossible.
    constexpr int kMaxCars = 100;
    for (int attempt = 0; attempt < kMaxCars; ++attempt) {
      geometry_.DrawCars(&random_);
      bool seen = true;
      for (int k = begin; k < end && seen; ++k) {
        seen = geometry_.DrawCarMatch(&random_, &pair_.matches[order_[k]]);
        AddNoise(order_[k]);
        pair_.columns.inlier[order_[k]] = 0;
      }
      if (seen) return true;
    }
    return false;
  }

  void DrawScores(int num_outliers) {
    for (int k = 0; k < options_.num_matches; ++k) {
      const double a = random_.Uniform();
      const double b = random_.Uniform();
      pair_.matches[order_[k]].score =
          kRatioTest * (k < num_outliers ? std::pow(a, 1.0 / kOutlierDraws) : 0.5 * (a + b));
    }
  }

  void FillSigmas() {
    if (options_.camera_noise_px.empty()) return;
    const double unit = StandardDeviation(options_.noise_model);
    for (const Match& match : pair_.matches) {
      pair_.columns.sigma1.push_back(unit * SigmaOf(match.camera1));
      pair_.columns.sigma2.push_back(unit * SigmaOf(match.camera2));
    }
  }

  const SceneMatchOptions& options_;
  SceneGeometry& geometry_;
  Random& random_;
  FramePair& pair_;
  std::vector<int> order_;
};

}  // namespace

bool SceneMatchOptions::AreMatchesValid(int num_cameras, std::string* error) const {
  const auto in_unit = [](double x) { return x >= 0.0 && x <= 1.0; };
  const auto is_sigma = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (num_matches < 0) {
    *error = "num_matches must not be negative";
  } else if (!(noise_px >= 0.0) || !std::isfinite(noise_px)) {
    *error = "noise_px must be finite and not negative";
  } else if (!camera_noise_px.empty() &&
             camera_noise_px.size() != static_cast<size_t>(num_cameras)) {
    *error = "camera_noise_px must have a number for each of the " + std::to_string(num_cameras) +
             " cameras";
  } else if (!std::all_of(camera_noise_px.begin(), camera_noise_px.end(), is_sigma)) {
    *error = "camera_noise_px must be positive and finite";
  } else if (!in_unit(inter_share) || !in_unit(outlier_share)) {
    *error = "inter_share and outlier_share must lie in [0, 1]";
  } else if (!(moving_share >= 0.0) || !(moving_share + outlier_share <= 1.0)) {
    *error = "moving_share must not be negative, nor above 1 together with outlier_share";
  } else if (inter_share > 0.0 && num_cameras < 2) {
    *error = "inter_share needs two cameras";
  } else {
    return IsSeenRigValid(num_cameras, error);
  }
  return false;
}

bool SceneMatchOptions::IsSeenRigValid(int num_cameras, std::string* error) const {
  const auto is_finite = [](double x) { return std::isfinite(x); };
  if (!(calibration_sigma_deg >= 0.0) || !std::isfinite(calibration_sigma_deg)) {
    *error = "calibration_sigma_deg must be finite and not negative";
  } else if (!(calibration_sigma_m >= 0.0) || !std::isfinite(calibration_sigma_m)) {
    *error = "calibration_sigma_m must be finite and not negative";
  } else if (state_calibration_sigma && !(calibration_sigma_deg > 0 && calibration_sigma_m > 0)) {
    *error =
        "state_calibration_sigma needs a calibration_sigma_deg and a calibration_sigma_m above 0: "
        "files state positive sigmas only";
  } else if (!camera_times.empty() && camera_times.size() != static_cast<size_t>(num_cameras)) {
    *error = "camera_times must have a number for each of the " + std::to_string(num_cameras) +
             " cameras";
  } else if (!std::all_of(camera_times.begin(), camera_times.end(), is_finite)) {
    *error = "camera_times must be finite";
  } else if (!(interval_s > 0.0) || !std::isfinite(interval_s)) {
    *error = "interval_s must be positive and finite";
  } else {
    return true;
  }
  return false;
}

bool DrawSceneMatches(const SceneMatchOptions& options, SceneGeometry* geometry, Random* random,
                      FramePair* pair, std::string* error) {
  return MatchDrawer(options, geometry, random, pair).Draw(error);
}

bool Sees(const RigCamera& camera, const Eigen::Vector3d& X, Pixel* pixel) {
  const Eigen::Vector3d seen = camera.Q.transpose() * (X - camera.s);
  return seen.norm() > kMinDistance && Project(camera.intrinsics, seen, pixel) &&
         camera.intrinsics.InImage(*pixel);
}

Pixel DrawPixel(const Camera& camera, Random* random) {
  // The circle of a fisheye is at least some percent of its image.
  constexpr int kMaxPixels = 100;
  Pixel pixel;
  for (int draw = 0; draw < kMaxPixels; ++draw) {
    const double u = random->Uniform(0.0, camera.width);
    const double v = random->Uniform(0.0, camera.height);
    pixel = {u, v};
    if (AlongRay(camera, pixel).allFinite()) break;
  }
  return pixel;
}

}  // namespace rigel
