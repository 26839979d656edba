#include "rigel/problems/io/match_text.h"

#include <cmath>
#include <limits>

#include "rigel/core/angles.h"
#include "rigel/problems/io/parse_number.h"

namespace rigel {

// Multiplying back and forth by pi/180 may change the last bit. The degrees with the fewest digits
// that read back as the same radians are written. About a tenth of all doubles are the radians of
// no double: those move by one ulp.
MatchText& MatchText::SigmaDeg(double radians) {
  const double degrees = RadToDeg(radians);
  const auto is_exact = [radians](double d) { return DegToRad(d) == radians; };
  std::array<char, 64> buffer;
  for (int digits = 1; digits <= 15; ++digits) {
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), degrees,
                                      std::chars_format::general, digits);
    const std::string_view word(buffer.data(), result.ptr - buffer.data());
    double rounded;
    if (ParseFinite(word, &rounded) && is_exact(rounded)) return Number(rounded);
  }
  const double inf = std::numeric_limits<double>::infinity();
  double below = degrees;
  double above = degrees;
  for (int k = 0; k < 4; ++k) {
    if (is_exact(below)) return Number(below);
    if (is_exact(above)) return Number(above);
    below = std::nextafter(below, -inf);
    above = std::nextafter(above, inf);
  }
  return Number(degrees);
}

}  // namespace rigel
