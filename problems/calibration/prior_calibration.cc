#include "rigel/problems/calibration/prior_calibration.h"

#include "rigel/core/enum_names.h"

namespace rigel {
namespace {

constexpr EnumName<CalibrationLevel> kLevelNames[] = {{CalibrationLevel::kNone, "none"},
                                                      {CalibrationLevel::kTilt, "tilt"},
                                                      {CalibrationLevel::kFull, "full"}};

}  // namespace

const char* CalibrationLevelName(CalibrationLevel level) { return NameOf(kLevelNames, level); }

}  // namespace rigel
