// OpenGV's generalized relative pose solvers behind Rigel's interface, to time both in one run.
#ifndef RIGEL_PROBLEMS_OPENGV_PEERS_H_
#define RIGEL_PROBLEMS_OPENGV_PEERS_H_

#include <vector>

#include "rigel/core/pose.h"
#include "rigel/minimal/catalogue.h"
#include "rigel/minimal/grouped_matches.h"

namespace rigel {

// opengv-sixpt (rotations only: t is left at zero) and opengv-seventeenpt; none unless Rigel was
// built with RIGEL_WITH_OPENGV. A call includes the making of OpenGV's adapter.
const std::vector<SolverInfo>& OpenGvPeers();

// OpenGV's nonlinear refinement of a generalized relative pose over all matches, from `pose`. False
// if Rigel was built without OpenGV.
bool RefineWithOpenGv(const GroupedMatches& matches, Pose* pose);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_OPENGV_PEERS_H_
