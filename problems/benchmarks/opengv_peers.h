// OpenGV's generalized relative pose solvers behind Rigel's interface, to compare their times.
#ifndef RIGEL_PROBLEMS_BENCHMARKS_OPENGV_PEERS_H_
#define RIGEL_PROBLEMS_BENCHMARKS_OPENGV_PEERS_H_

#include <string>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/grouped_matches.h"
#include "rigel/core/pose.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/ransac/ransac.h"

namespace rigel {

// opengv-sixpt (rotations only: t is left at zero) and opengv-seventeenpt; none unless Rigel was
// built with RIGEL_WITH_OPENGV. A call includes the making of OpenGV's adapter.
const std::vector<SolverInfo>& OpenGvPeers();

// OpenGV's nonlinear refinement of a generalized relative pose over all matches, from `pose`. False
// if Rigel was built without OpenGV.
bool RefineWithOpenGv(const GroupedMatches& matches, Pose* pose);

struct OpenGvEstimate {
  Pose pose;
  int num_inliers = 0;
  int iterations = 0;
  double ransac_ms = 0.0;  // with the making of the adapter
  double refine_ms = 0.0;
};

// OpenGV's RANSAC with the peer of that name, then OpenGV's nonlinear refinement of the inliers.
// Confidence and iterations are those of `options`. The threshold is an angle in OpenGV: that of
// threshold_px at the first camera of the pair. False if it finds nothing or there is no such peer.
bool EstimateWithOpenGv(const std::string& peer, const RansacOptions& options,
                        const FramePair& pair, OpenGvEstimate* estimate);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_BENCHMARKS_OPENGV_PEERS_H_
