#include "rigel/refine/rig_doubts.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "rigel/core/frame_pair.h"
#include "rigel/core/pixel_unit.h"
#include "rigel/refine/least_squares/uncertainty.h"
#include "rigel/refine/refine.h"

namespace rigel {
namespace {

// Two cameras, the smaller index first: matches in either order of time.
using Cameras = std::pair<int, int>;
struct Fit {
  int rows = 0;
  int inliers = 0;
  double Share() const { return inliers / static_cast<double>(rows); }
};

std::map<Cameras, Fit> FitsOf(const RefineSummary& refine) {
  std::map<Cameras, Fit> fits;
  for (const CameraPairFit& f : refine.camera_pairs) {
    Fit& fit = fits[std::minmax(f.camera1, f.camera2)];
    fit.rows += f.rows;
    fit.inliers += f.inliers;
  }
  return fits;
}

std::string CountOf(const Fit& fit) {
  return std::to_string(fit.inliers) + " of " + std::to_string(fit.rows) + " fit";
}

std::vector<int> FrozenCameras(const FramePair& pair) {
  constexpr double kMoving = 10.0;
  constexpr double kNearlyAll = 0.8;
  if (pair.rig.size() < 2) return {};
  struct Counts {
    int rows = 0, still = 0, moving = 0;
  };
  std::vector<Counts> counts(pair.rig.size());
  const double limit = kMinMatchNoisePx * PixelUnit(pair.rig);
  for (const Match& match : pair.matches) {
    if (!match.IsIntra()) continue;
    Counts& c = counts[match.camera1];
    const double moved2 = (match.pixel2 - match.pixel1).squaredNorm();
    ++c.rows;
    c.still += moved2 <= limit * limit ? 1 : 0;
    c.moving += moved2 > kMoving * kMoving * limit * limit ? 1 : 0;
  }
  const bool any_moves = std::any_of(counts.begin(), counts.end(), [](const Counts& c) {
    return c.rows >= kMinDoubtRows && 2 * c.moving > c.rows;
  });
  std::vector<int> frozen;
  for (int k = 0; k < pair.rig.size() && any_moves; ++k) {
    if (counts[k].rows >= kMinDoubtRows && counts[k].still >= kNearlyAll * counts[k].rows) {
      frozen.push_back(k);
    }
  }
  return frozen;
}

// Number of matches that fit with the better of the two swaps; nothing if neither is far better.
std::optional<int> InliersIfSwapped(const FramePair& pair, int num_inliers, const Cameras& cameras,
                                    const std::function<int(const FramePair&)>& inliers_with) {
  constexpr double kFewerOutliers = 0.75;
  constexpr int kMoreInliers = 6;
  const int total = static_cast<int>(pair.matches.size());
  const int outliers = total - num_inliers;
  int best = 0;
  const auto try_swapped = [&](bool intrinsics) {
    FramePair swapped = pair;
    RigCamera& a = swapped.rig.cameras[cameras.first];
    RigCamera& b = swapped.rig.cameras[cameras.second];
    std::swap(a, b);
    if (!intrinsics) std::swap(a.intrinsics, b.intrinsics);
    best = std::max(best, inliers_with(swapped));
  };
  try_swapped(false);
  const auto& all = pair.rig.cameras;
  if (!SameLens(all[cameras.first].intrinsics, all[cameras.second].intrinsics)) try_swapped(true);
  if (best < num_inliers + kMoreInliers || total - best > kFewerOutliers * outliers) {
    return std::nullopt;
  }
  return best;
}

// What the camera pairs with enough rows have in common.
struct FitSurvey {
  double most = 0.0;  // largest share that fits
  int inter_inliers = 0;
  std::optional<Cameras> most_rows;  // between two cameras
};

FitSurvey Survey(const std::map<Cameras, Fit>& fits) {
  FitSurvey survey;
  for (const auto& [cameras, fit] : fits) {
    if (fit.rows < kMinDoubtRows) continue;
    survey.most = std::max(survey.most, fit.Share());
    if (cameras.first == cameras.second) continue;
    survey.inter_inliers += fit.inliers;
    if (!survey.most_rows || fit.rows > fits.at(*survey.most_rows).rows) {
      survey.most_rows = cameras;
    }
  }
  return survey;
}

RigDoubt FewFitDoubt(const Cameras& cameras, const Fit& fit) {
  const bool intra = cameras.first == cameras.second;
  const std::string name =
      intra ? "camera " + std::to_string(cameras.first)
            : "cameras " + std::to_string(cameras.first) + "-" + std::to_string(cameras.second);
  return {
      RigDoubtKind::kFewFit, cameras.first, cameras.second,
      name + ": " + CountOf(fit) +
          (intra ? "; is it swapped with another, is its quaternion x y z w, are its intrinsics "
                   "another's, or are these matches wrong?"
                 : "; are they swapped, is a quaternion x y z w, or are these matches wrong?")};
}

// Adds a doubt for each camera pair of which few matches fit. Returns the cameras that may be
// swapped: those of such pairs, and two cameras that no match connects.
std::vector<Cameras> DoubtFewFits(const std::map<Cameras, Fit>& fits, double most,
                                  const std::vector<int>& frozen, std::vector<RigDoubt>* doubts) {
  const auto is_frozen = [&](int camera) {
    return std::find(frozen.begin(), frozen.end(), camera) != frozen.end();
  };
  std::vector<Cameras> to_swap;
  std::vector<int> few_by_themselves;
  for (const auto& [cameras, fit] : fits) {
    const bool few = fit.rows >= kMinDoubtRows && most >= kMostFit && fit.Share() < kFewFit * most;
    if (!few || is_frozen(cameras.first) || is_frozen(cameras.second)) continue;
    doubts->push_back(FewFitDoubt(cameras, fit));
    if (cameras.first != cameras.second) {
      to_swap.push_back(cameras);
      continue;
    }
    for (const int other : few_by_themselves) {
      if (fits.count({other, cameras.first}) == 0) to_swap.emplace_back(other, cameras.first);
    }
    few_by_themselves.push_back(cameras.first);
  }
  return to_swap;
}

}  // namespace

std::vector<RigDoubt> FindRigDoubts(const FramePair& pair, bool length_is_open,
                                    bool prior_is_doubted, const RefineSummary& refine,
                                    const std::function<int(const FramePair&)>& inliers_with) {
  const std::vector<int> frozen = FrozenCameras(pair);
  std::vector<RigDoubt> doubts;
  doubts.reserve(frozen.size());
  for (const int k : frozen) {
    doubts.push_back({RigDoubtKind::kFrozen, k, k,
                      "camera " + std::to_string(k) +
                          " shows the same image twice while others move: is it frozen?"});
  }
  const std::map<Cameras, Fit> fits = FitsOf(refine);
  const FitSurvey survey = Survey(fits);
  std::vector<Cameras> to_swap;
  if (!prior_is_doubted) to_swap = DoubtFewFits(fits, survey.most, frozen, &doubts);
  const bool length_is_missing =
      refine.IsSolutionUsable() && refine.RigDirectionKnown() && !refine.scale_observable &&
      length_is_open && refine.camera_pairs.size() > 1 && survey.inter_inliers >= kMinDoubtRows &&
      10 * survey.inter_inliers >= refine.num_inliers;
  if (to_swap.empty() && length_is_missing && frozen.empty()) to_swap.push_back(*survey.most_rows);
  // One swapped pair makes matches of other pairs fit badly too, so three pairs are enough to try.
  constexpr size_t kMaxSwaps = 3;
  for (size_t k = 0; k < std::min(to_swap.size(), kMaxSwaps); ++k) {
    const auto inliers = InliersIfSwapped(pair, refine.num_inliers, to_swap[k], inliers_with);
    if (!inliers) continue;
    const auto [a, b] = to_swap[k];
    doubts.push_back({RigDoubtKind::kSwapped, a, b,
                      "with cameras " + std::to_string(a) + " and " + std::to_string(b) +
                          " swapped " + std::to_string(*inliers) + " of " +
                          std::to_string(pair.matches.size()) + " matches fit instead of " +
                          std::to_string(refine.num_inliers) +
                          ": are they, or is the sign of their baseline wrong?"});
  }
  return doubts;
}

}  // namespace rigel
