// What each minimal solver makes of degenerate configurations, by measurement.
#ifndef RIGEL_PROBLEMS_DEGENERACY_H_
#define RIGEL_PROBLEMS_DEGENERACY_H_

#include <string>
#include <vector>

#include "rigel/minimal/catalogue.h"

namespace rigel {

// A configuration of rig, motion, scene and matches.
enum class Configuration {
  kInter,                 // between two cameras: the regular case, for comparison
  kIntra,                 // within each of two cameras
  kIntraThree,            // within each of three cameras
  kPureTranslation,       // within the cameras, no rotation
  kCentralRig,            // all camera centres at the body's origin
  kPanoramicRig,          // all camera centres at one point off the origin
  kAxialRig,              // three centres on one line, matches between cameras
  kSingleCamera,          // one camera off the origin
  kForwardMotion,         // t along +z, within the cameras
  kNoMotion,              // R = I, t = 0, within the cameras
  kHorizon,               // all rays perpendicular to the vertical, between cameras
  kPlanarScene,           // all points on the ground, between cameras
  kPureTranslationInter,  // between cameras, no rotation
};

const std::vector<Configuration>& AllConfigurations();
const char* ConfigurationName(Configuration configuration);

// Shares of noise-free problems.
struct DegeneracyCell {
  double solved = 0.0;     // with any solution
  double rotation = 0.0;   // with a solution of the true rotation (to 1e-4 rad) ...
  double direction = 0.0;  // ... and the true direction of t (to 0.3 deg) or, at t = 0, any
  double scale = 0.0;      // ... and the true |t| (to 5 percent), said to be known
  double no_scale = 0.0;   // the solution nearest to the truth says that |t| is not known
};

// Rotation of 5 degrees for exact solvers and 0.1 degrees for first-order ones, so that their bias
// stays below the tolerances.
DegeneracyCell MeasureDegeneracy(const SolverInfo& solver, Configuration configuration,
                                 int num_problems);

// The table of docs/degeneracies.md: Markdown, one row a solver, one column a configuration.
std::string DegeneracyTable(int num_problems);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_DEGENERACY_H_
