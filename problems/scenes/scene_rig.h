// The rig that sees a synthetic scene, where it differs from the one that the files state: an error
// of the calibration, and cameras that fire at other times.
//
// Each camera is turned by N(0, calibration_sigma_deg) about each axis of the body and moved by
// N(0, calibration_sigma_m) along it. The error is drawn from the seed: it is the same in all pairs
// of a seed. All cameras have one, the first too. What turns and moves all cameras alike is part of
// it. That part cannot be seen in the matches: it is as if the body's frame were elsewhere. Truth
// stays that of the body that the files state.
//
// A camera that fires later sees the points from where it is then. The body moves with constant
// velocity: its angular velocity and that of its origin are constant in its own frame, so it is on
// an arc (a screw). A share of the motion commutes with the whole one. So a camera K that fires a
// share a_K of the interval later is, in both views, a camera that is mounted elsewhere, at
// Exp(-a_K Log(f2_from_f1)) body_from_camera.
#ifndef RIGEL_PROBLEMS_SCENES_SCENE_RIG_H_
#define RIGEL_PROBLEMS_SCENES_SCENE_RIG_H_

#include "rigel/core/frame_pair.h"
#include "rigel/problems/scenes/synthetic.h"

namespace rigel {

// The rig that sees pair number `index`, which has the rig that its file states and its truth.
// Completes what the pair states: the error and the times of the cameras, and the times of the
// pair if a camera fires at another time.
Rig RigOfScene(const SceneMatchOptions& options, int index, FramePair* pair);

// The share of the interval by which a camera of the pair fires later.
double ShareOfTime(const SceneMatchOptions& options, const RigCamera& camera);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_SCENES_SCENE_RIG_H_
