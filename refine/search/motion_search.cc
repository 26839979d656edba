#include "rigel/refine/search/motion_search.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "rigel/core/alignment.h"
#include "rigel/refine/search/frame_pair_solver.h"

namespace rigel {
namespace {

// The RANSAC run of one solver.
class Attempt {
 public:
  Attempt(const SolverInfo& solver, const Alignment& alignment, const GroupedMatches& matches,
          const RansacOptions& options, Solutions* solutions, Stop* stop)
      : solver_(solver),
        problem_(solver, matches, alignment, options),
        run_(problem_, options, solutions, stop) {}

  const SolverInfo& solver() const { return solver_; }
  bool NeedsPrior() const { return solver_.prior != PriorKind::kNone; }
  bool CanDraw() const { return problem_.CanDraw(); }
  bool Done() const { return run_.Done(); }
  const RansacResult<Solution>& result() const { return run_.result(); }

  // Makes at most `iterations`, and subtracts them from the budget.
  void Advance(int iterations, int* budget) {
    *budget -= run_.Advance(std::min(iterations, *budget));
  }
  // Optimizes the best hypotheses, unless nothing was drawn since the last call.
  void Settle() {
    if (settled_at_ == result().iterations) return;
    settled_at_ = result().iterations;
    run_.OptimizeFinalists();
  }

 private:
  const SolverInfo& solver_;
  FramePairSolver problem_;
  RansacRun<FramePairSolver> run_;
  int settled_at_ = 0;
};

// The share of the matches from whose camera pairs the solver can draw.
double Coverage(const SolverInfo& solver, const GroupedMatches& matches) {
  if (solver.sampling != SampleKind::kOnePairPlusOne) return 1.0;
  int covered = 0;
  for (const MatchGroup& group : matches.groups()) {
    if (group.size >= solver.sample_size - 1) covered += group.size;
  }
  return covered / static_cast<double>(matches.size());
}

std::string WhyNoSample(const SolverInfo& solver) {
  switch (solver.sampling) {
    case SampleKind::kOnePairPlusOne:
      return "no camera pair has " + std::to_string(solver.sample_size - 1) + " matches";
    case SampleKind::kOneCamera:
      return "no camera has " + std::to_string(solver.sample_size) + " matches with itself";
    case SampleKind::kSpread:
      break;
  }
  return "there is no sample";
}

// If 5pt+1 can draw from this share of the matches, the solvers after it are not needed.
constexpr double kEnoughCoverage = 0.5;

class Search {
 public:
  Search(const std::vector<const SolverInfo*>& solvers, const MotionPrior& prior,
         const GroupedMatches& matches, const RansacOptions& options, Stop* stop)
      : solvers_(solvers),
        prior_(prior),
        matches_(matches),
        options_(options),
        stop_(stop),
        budget_(options.max_iterations) {}

  MotionSearch Run() {
    trials_.resize(solvers_.size());
    attempts_.resize(solvers_.size());
    if (solvers_.size() == 1) {
      if (Begin(0)) Conclude(0);
    } else if (!Probe()) {
      TakeTurns();
    }
    return Summary();
  }

 private:
  // Makes the attempt of the k-th solver. False, and why in its note, if it has no sample.
  bool Begin(size_t k) {
    const SolverInfo& solver = *solvers_[k];
    trials_[k].solver = solver.name;
    if (matches_.size() < solver.sample_size) {
      trials_[k].note = std::to_string(matches_.size()) + " matches, " + solver.name + " needs " +
                        std::to_string(solver.sample_size);
      return false;
    }
    Alignment alignment;
    if (!MakeAlignment(prior_, solver.prior, &alignment, &trials_[k].note)) return false;
    attempts_[k] =
        std::make_unique<Attempt>(solver, alignment, matches_, options_, &solutions_, stop_);
    if (attempts_[k]->CanDraw()) return true;
    attempts_[k].reset();
    trials_[k].note = WhyNoSample(solver);
    return false;
  }

  // Runs solver k to its end, or to that of the budget.
  void Conclude(size_t k) {
    attempts_[k]->Advance(budget_, &budget_);
    attempts_[k]->Settle();
  }

  Doubt DoubtOf(const Attempt& attempt) const {
    return FindDoubt(prior_, attempt.solver(), attempt.result().best, matches_,
                     options_.threshold_px);
  }

  // Makes a few iterations of each solver until a motion is not doubtful, and runs its solver to
  // the end. False if there is none. Solvers without a prior come right after the first one with a
  // prior: if the prior is wrong, all solvers that use it fail.
  bool Probe() {
    std::vector<size_t> order, later;
    for (size_t k = 0; k < solvers_.size(); ++k) {
      const bool first = order.empty() || solvers_[k]->prior == PriorKind::kNone;
      (first ? order : later).push_back(k);
    }
    order.insert(order.end(), later.begin(), later.end());
    double coverage = 0.0;  // by solvers without a prior
    for (size_t i = 0; i < order.size(); ++i) {
      const size_t k = order[i];
      const bool constrained = solvers_[k]->prior != PriorKind::kNone;
      if (!constrained && coverage >= kEnoughCoverage) continue;
      if (!Begin(k)) continue;
      Attempt& attempt = *attempts_[k];
      if (!constrained) coverage = std::max(coverage, Coverage(*solvers_[k], matches_));
      // Where the budget is small each gets a part of it.
      const int left = static_cast<int>(order.size() - i);
      const int probe = i == 0 && constrained ? kFirstIterations : kProbeIterations;
      attempt.Advance(std::min(probe, std::max(1, budget_ / left)), &budget_);
      attempt.Settle();
      if (!attempt.result().found) continue;
      const Doubt doubt = DoubtOf(attempt);
      if (!doubt.Any()) {
        Conclude(k);
        return true;
      }
      trials_[k].note = "doubtful: " + doubt.Reason();
    }
    return false;
  }

  // -1 if none found a motion.
  int Best() const {
    int best = -1;
    for (size_t k = 0; k < attempts_.size(); ++k) {
      if (attempts_[k] == nullptr || !attempts_[k]->result().found) continue;
      if (best < 0 || attempts_[k]->result().score < attempts_[best]->result().score) {
        best = static_cast<int>(k);
      }
    }
    return best;
  }

  // The best, unless its motion deviates from its prior and a solver without a prior has about as
  // good a motion: then that solver.
  int Choice() const {
    constexpr double kAlike = 1.02;  // scores of one motion by two solvers
    const int best = Best();
    if (best < 0 || !attempts_[best]->NeedsPrior() || !DoubtOf(*attempts_[best]).leaves_prior) {
      return best;
    }
    for (size_t k = 0; k < attempts_.size(); ++k) {
      if (attempts_[k] == nullptr || attempts_[k]->NeedsPrior()) continue;
      const RansacResult<Solution>& result = attempts_[k]->result();
      if (result.found && result.score <= kAlike * attempts_[best]->result().score) {
        return static_cast<int>(k);
      }
    }
    return best;
  }

  void TakeTurns() {
    // The constrained solver with the best score, or the first.
    int constrained = -1;
    for (size_t k = 0; k < attempts_.size(); ++k) {
      if (attempts_[k] == nullptr || !attempts_[k]->NeedsPrior()) continue;
      if (constrained < 0 ||
          attempts_[k]->result().score < attempts_[constrained]->result().score) {
        constrained = static_cast<int>(k);
      }
    }
    std::vector<size_t> live;
    for (size_t k = 0; k < attempts_.size(); ++k) {
      if (attempts_[k] == nullptr) continue;
      if (!attempts_[k]->NeedsPrior() || static_cast<int>(k) == constrained) live.push_back(k);
    }
    bool decided = Decides(Best());
    for (bool goes_on = true; goes_on && !decided && budget_ > 0 && !Exhausted();) {
      goes_on = false;
      for (const size_t k : live) {
        Attempt& attempt = *attempts_[k];
        if (attempt.Done() || budget_ == 0 || decided) continue;
        goes_on = true;
        attempt.Advance(kProbeIterations, &budget_);
        if (!attempt.Done()) continue;
        attempt.Settle();
        decided = Decides(Best());
      }
    }
    for (const size_t k : live) attempts_[k]->Settle();
  }

  // True if the work of all solvers is used up or the search was stopped.
  bool Exhausted() const {
    double work_us = 0.0;
    for (const auto& attempt : attempts_) {
      if (attempt != nullptr) work_us += attempt->result().work_us;
    }
    return !(work_us < options_.max_work_us) || stop_->Asked();
  }

  // True if the other solvers are not expected to find a better motion than solver k.
  bool Decides(int k) const {
    if (k < 0 || !attempts_[k]->Done()) return false;
    return !attempts_[k]->NeedsPrior() || !DoubtOf(*attempts_[k]).SaysWrong();
  }

  MotionSearch Summary() {
    MotionSearch search;
    const int best = Choice();
    for (size_t k = 0; k < solvers_.size(); ++k) {
      SolverTrial& trial = trials_[k];
      if (trial.solver.empty()) {
        trial.solver = solvers_[k]->name;
        trial.note = kNotNeeded;
      }
      if (attempts_[k] == nullptr) continue;
      const RansacResult<Solution>& result = attempts_[k]->result();
      trial.iterations = result.iterations;
      trial.hypotheses = result.hypotheses;
      trial.num_inliers = result.num_inliers;
      search.iterations += result.iterations;
      search.hypotheses += result.hypotheses;
      if (!result.found) trial.note = "no motion";
      if (search.solver == nullptr || static_cast<int>(k) == best) search.solver = solvers_[k];
      if (static_cast<int>(k) != best) {
        if (trial.note.empty()) trial.note = "another motion fits better";
        continue;
      }
      search.best = result;
      const Doubt doubt = DoubtOf(*attempts_[k]);
      trial.num_inliers = doubt.num_inliers;
      trial.note =
          "chosen: " + (doubt.Any() ? "best score, but " + doubt.Reason()
                                    : std::to_string(doubt.num_inliers) + " of " +
                                          std::to_string(doubt.num_matches) + " matches agree");
    }
    search.trials = std::move(trials_);
    return search;
  }

  const std::vector<const SolverInfo*>& solvers_;
  const MotionPrior& prior_;
  const GroupedMatches& matches_;
  const RansacOptions& options_;
  Stop* stop_;
  Solutions solutions_;
  std::vector<std::unique_ptr<Attempt>> attempts_;  // of the solvers; null: not begun
  std::vector<SolverTrial> trials_;
  int budget_;
};

}  // namespace

MotionSearch SearchMotion(const std::vector<const SolverInfo*>& solvers, const MotionPrior& prior,
                          const GroupedMatches& matches, const RansacOptions& options, Stop* stop) {
  return Search(solvers, prior, matches, options, stop).Run();
}

}  // namespace rigel
