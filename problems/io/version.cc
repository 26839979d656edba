#include "rigel/problems/io/version.h"

namespace rigel {

const char* RigelVersion() { return RIGEL_VERSION; }

}  // namespace rigel
