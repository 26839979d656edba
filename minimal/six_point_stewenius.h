#ifndef RIGEL_MINIMAL_SIX_POINT_STEWENIUS_H_
#define RIGEL_MINIMAL_SIX_POINT_STEWENIUS_H_

#include "rigel/minimal/prepared_matches.h"
#include "rigel/minimal/solutions.h"

namespace rigel {

int Solve6ptStewenius(const PreparedMatches& matches, const int* sample, Solutions* solutions);

}  // namespace rigel

#endif  // RIGEL_MINIMAL_SIX_POINT_STEWENIUS_H_
