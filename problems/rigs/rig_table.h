// A rig as a table for people.
#ifndef RIGEL_PROBLEMS_RIGS_RIG_TABLE_H_
#define RIGEL_PROBLEMS_RIGS_RIG_TABLE_H_

#include <string>

#include "rigel/core/body_axes.h"
#include "rigel/problems/io/rig_file.h"

namespace rigel {

// A row a camera, and the baselines below; at most 100 columns. `axes` say what forward, right and
// up are.
std::string RigTable(const RigFile& file, const BodyAxes& axes);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_RIGS_RIG_TABLE_H_
