// Names for the flags of TranslationForm.
#ifndef RIGEL_TEST_REFINE_LEAST_SQUARES_TRANSLATION_FORMS_H_
#define RIGEL_TEST_REFINE_LEAST_SQUARES_TRANSLATION_FORMS_H_

#include "rigel/refine/least_squares/motion_parameterization.h"

namespace rigel {

// planar, depths, holds_length.
inline constexpr TranslationForm kFreeTranslation = {false, false, false};
inline constexpr TranslationForm kSphere = {false, false, true};
inline constexpr TranslationForm kPlane = {true, false, false};
inline constexpr TranslationForm kCircle = {true, false, true};
inline constexpr TranslationForm kDepths = {false, true, false};
inline constexpr TranslationForm kPlanarDepths = {true, true, false};
inline constexpr TranslationForm kDepthsOnSphere = {false, true, true};
inline constexpr TranslationForm kPlanarDepthsOnSphere = {true, true, true};

}  // namespace rigel

#endif  // RIGEL_TEST_REFINE_LEAST_SQUARES_TRANSLATION_FORMS_H_
