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
  double length = 0.0;  // the start's
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

}  // namespace

bool SearchScale(const GroupedMatches& matches, double threshold_px, double noise_px,
                 const PriorResiduals& prior, const std::vector<double>& more_lengths, Pose* pose) {
  const double norm = pose->t.norm();
  double length = ShortestLength(matches, pose->R);
  if (!(norm > 0) || !(length > 0)) return false;
  const Eigen::Vector3d direction = pose->t / norm;
  const GroupedMatches subset = matches.EvenSubset(kSubset);
  const GroupedMatches coarse = matches.EvenSubset(kCoarseSubset);
  SmallEngine engine(subset), coarse_engine(coarse);
  std::vector<double> errors;
  std::vector<char> mask;
  const std::vector<double> all(coarse.size(), 1.0);

  // The shortest first. The last is so long that the arms do not matter.
  std::vector<double> lengths;
  const double share = coarse.size() / static_cast<double>(matches.size());
  for (int k = 0; k < kMaxLengths; ++k, length *= kStep) {
    Pose at = *pose;
    at.t = length * direction;
    const Matrix6d information =
        SampsonInformation(coarse, all, at) / (share * noise_px * noise_px);
    if (RelativeScaleSigma(information, at) > kHopeless) break;
    lengths.push_back(length);
  }
  lengths.insert(lengths.end(), more_lengths.begin(), more_lengths.end());
  lengths.push_back(std::max(kFar * ShortestLength(matches, pose->R), kStep * length));

  // Of all matches and of the prior, pixels^2.
  const auto score_of = [&](const GroupedMatches& scored, const Pose& motion) {
    PriorResiduals::Residuals r;
    prior.Evaluate(motion, &r, nullptr);
    const double score =
        scored.ScoreInFront(motion, threshold_px, std::numeric_limits<double>::infinity(), nullptr);
    return score * matches.size() / scored.size() + noise_px * noise_px * r.squaredNorm();
  };
  const auto optimize = [&](const GroupedMatches& with, SmallEngine* solver, double threshold,
                            Pose* motion) {
    LeastSquaresOptions options;
    options.limits_length = true;
    options.loss_scale = threshold;
    with.SelectInliers(*motion, threshold, &errors, &mask);
    const double unit = noise_px * std::sqrt(with.size() / static_cast<double>(matches.size()));
    return solver->Minimize(options, mask, prior, unit, motion);
  };

  // From each length roughly, then from the best few and from the longest to the minimum.
  std::vector<Candidate> candidates;
  const auto polish = [&](Candidate* candidate) {
    for (int pass = 0; pass < 2; ++pass) {
      if (!optimize(subset, &engine, threshold_px, &candidate->motion)) break;
    }
    candidate->score = score_of(subset, candidate->motion);
  };
  const auto from_length = [&](double from) {
    Candidate candidate;
    candidate.length = from;
    candidate.motion = *pose;
    candidate.motion.t = from * direction;
    ResolveSign(coarse, kLooseFactor * threshold_px, &candidate.motion);
    optimize(coarse, &coarse_engine, kLooseFactor * threshold_px, &candidate.motion);
    candidate.score = score_of(subset, candidate.motion);
    return candidate;
  };
  const double outlier = threshold_px * threshold_px;
  const double start_score = score_of(subset, *pose);
  Candidate longest = from_length(lengths.back());
  polish(&longest);
  // If the longest fits as well as the start, the arms do not determine |t|: the others are
  // skipped.
  const bool within = lengths.size() > 1 && norm <= lengths[lengths.size() - 2];
  if (!within || std::abs(start_score - longest.score) >= outlier) {
    for (size_t k = 0; k + 1 < lengths.size(); ++k) candidates.push_back(from_length(lengths[k]));
  }
  const auto by_score = [](const Candidate& x, const Candidate& y) { return x.score < y.score; };
  std::stable_sort(candidates.begin(), candidates.end(), by_score);
  size_t kept = 0;
  while (kept < std::min(kPolished, candidates.size()) &&
         candidates[kept].score <= candidates[0].score + kInReach * outlier * matches.size()) {
    ++kept;
  }
  candidates.resize(kept);
  for (Candidate& candidate : candidates) polish(&candidate);
  candidates.push_back(longest);
  candidates.push_back({norm, start_score, *pose});
  std::stable_sort(candidates.begin(), candidates.end(), by_score);
  const Pose found = candidates[0].motion;
  // The best of the subset must not be worse for all matches.
  if (found.t == pose->t || !(score_of(matches, found) < score_of(matches, *pose))) {
    return false;
  }
  *pose = found;
  return true;
}

}  // namespace rigel
