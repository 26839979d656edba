#include "rigel/refine/search/scale_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rigel/refine/least_squares/small_engine.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/search/sign_and_scale.h"

namespace rigel {
namespace {

constexpr int kMaxLengths = 12;
constexpr double kStep = 3.0;
constexpr double kHopeless = 0.7;
constexpr double kFar = 1000.0;
// Times the threshold: the rotation that was found with a wrong |t| has an error of a few sigma.
constexpr double kLooseFactor = 4.0;

// Matches to compare the minima, and matches to find them roughly.
constexpr size_t kSubset = 200;
constexpr size_t kCoarseSubset = 100;
// Number of lengths that are optimized to their minima.
constexpr size_t kPolished = 3;
// Largest difference of their scores to the best, as a share of outliers.
constexpr double kInReach = 0.1;

struct Candidate {
  double score = 0.0;
  Pose motion;
};

double ShortestLength(const GroupedMatches& matches, const Eigen::Matrix3d& R) {
  double shortest = 0.0;
  for (const MatchGroup& group : matches.groups()) {
    const Eigen::Vector3d& s1 = matches.rig().cameras[group.camera1].s;
    const Eigen::Vector3d& s2 = matches.rig().cameras[group.camera2].s;
    const double baseline = (R * s1 - s2).norm();
    shortest = std::max(shortest, (group.camera1 == group.camera2 ? 0.5 : 0.03) * baseline);
  }
  return shortest;
}

class LengthSearch {
 public:
  LengthSearch(const GroupedMatches& matches, double threshold_px, double noise_px,
               const PriorResiduals& prior, const Pose& start)
      : matches_(matches),
        threshold_px_(threshold_px),
        noise_px_(noise_px),
        prior_(prior),
        start_(start),
        direction_(start.t.normalized()),
        subset_(matches.EvenSubset(kSubset)),
        coarse_(matches.EvenSubset(kCoarseSubset)),
        engine_(subset_),
        coarse_engine_(coarse_) {}

  // The best motion that was found.
  Pose Run(const std::vector<double>& more_lengths) {
    const std::vector<double> lengths = Lengths(more_lengths);
    const double start_score = ScoreOf(subset_, start_);
    Candidate longest = FromLength(lengths.back());
    Polish(&longest);
    std::vector<Candidate> candidates;
    // If the longest fits as well as the start, the arms do not determine |t|: the others are
    // skipped.
    const bool within = lengths.size() > 1 && start_.t.norm() <= lengths[lengths.size() - 2];
    if (!within || std::abs(start_score - longest.score) >= Outlier()) {
      for (size_t k = 0; k + 1 < lengths.size(); ++k) candidates.push_back(FromLength(lengths[k]));
    }
    PolishBest(&candidates);
    candidates.push_back(longest);
    candidates.push_back({start_score, start_});
    SortByScore(&candidates);
    const Pose found = candidates[0].motion;
    // The best of the subset must not be worse for all matches.
    return ScoreOf(matches_, found) < ScoreOf(matches_, start_) ? found : start_;
  }

 private:
  double Outlier() const { return threshold_px_ * threshold_px_; }

  static void SortByScore(std::vector<Candidate>* candidates) {
    std::stable_sort(candidates->begin(), candidates->end(),
                     [](const Candidate& x, const Candidate& y) { return x.score < y.score; });
  }

  // The shortest first. The last is so long that the arms do not matter.
  std::vector<double> Lengths(const std::vector<double>& more_lengths) const {
    const double shortest = ShortestLength(matches_, start_.R);
    const std::vector<double> all(coarse_.size(), 1.0);
    const double share = coarse_.size() / static_cast<double>(matches_.size());
    double length = shortest;
    std::vector<double> lengths;
    for (int k = 0; k < kMaxLengths; ++k, length *= kStep) {
      Pose at = start_;
      at.t = length * direction_;
      const Matrix6d information =
          SampsonInformation(coarse_, all, at) / (share * noise_px_ * noise_px_);
      if (RelativeScaleSigma(information, at) > kHopeless) break;
      lengths.push_back(length);
    }
    lengths.insert(lengths.end(), more_lengths.begin(), more_lengths.end());
    lengths.push_back(std::max(kFar * shortest, kStep * length));
    return lengths;
  }

  // Of all matches and of the prior, pixels^2.
  double ScoreOf(const GroupedMatches& scored, const Pose& motion) const {
    PriorResiduals::Residuals r;
    prior_.Evaluate(motion, &r, nullptr);
    const double score = scored.ScoreInFront(motion, threshold_px_,
                                             std::numeric_limits<double>::infinity(), nullptr);
    return score * matches_.size() / scored.size() + noise_px_ * noise_px_ * r.squaredNorm();
  }

  bool Optimize(const GroupedMatches& with, SmallEngine* engine, double threshold, Pose* motion) {
    LeastSquaresOptions options;
    options.limits_length = true;
    options.loss_scale = threshold;
    with.SelectInliers(*motion, threshold, &errors_, &mask_);
    const double unit = noise_px_ * std::sqrt(with.size() / static_cast<double>(matches_.size()));
    return engine->Minimize(options, mask_, prior_, unit, motion);
  }

  // Roughly.
  Candidate FromLength(double length) {
    Candidate candidate;
    candidate.motion = start_;
    candidate.motion.t = length * direction_;
    ResolveSign(coarse_, kLooseFactor * threshold_px_, &candidate.motion);
    Optimize(coarse_, &coarse_engine_, kLooseFactor * threshold_px_, &candidate.motion);
    candidate.score = ScoreOf(subset_, candidate.motion);
    return candidate;
  }

  // To the minimum.
  void Polish(Candidate* candidate) {
    for (int pass = 0; pass < 2; ++pass) {
      if (!Optimize(subset_, &engine_, threshold_px_, &candidate->motion)) break;
    }
    candidate->score = ScoreOf(subset_, candidate->motion);
  }

  // Keeps the best few and those near them.
  void PolishBest(std::vector<Candidate>* candidates) {
    SortByScore(candidates);
    size_t kept = 0;
    while (kept < std::min(kPolished, candidates->size()) &&
           (*candidates)[kept].score <=
               (*candidates)[0].score + kInReach * Outlier() * matches_.size()) {
      ++kept;
    }
    candidates->resize(kept);
    for (Candidate& candidate : *candidates) Polish(&candidate);
  }

  const GroupedMatches& matches_;
  const double threshold_px_;
  const double noise_px_;
  const PriorResiduals& prior_;
  const Pose start_;
  const Eigen::Vector3d direction_;
  const GroupedMatches subset_;
  const GroupedMatches coarse_;
  SmallEngine engine_, coarse_engine_;
  std::vector<double> errors_;
  std::vector<char> mask_;
};

}  // namespace

bool SearchScale(const GroupedMatches& matches, double threshold_px, double noise_px,
                 const PriorResiduals& prior, const std::vector<double>& lengths, Pose* pose) {
  if (!(pose->t.norm() > 0) || !(ShortestLength(matches, pose->R) > 0)) return false;
  const Pose found = LengthSearch(matches, threshold_px, noise_px, prior, *pose).Run(lengths);
  if (found.t == pose->t) return false;
  *pose = found;
  return true;
}

}  // namespace rigel
