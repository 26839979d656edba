// Angle units. The API speaks radians; degrees appear only in names that end in `_deg`.
#ifndef RIGEL_CORE_ANGLES_H_
#define RIGEL_CORE_ANGLES_H_

namespace rigel {

inline constexpr double kPi = 3.14159265358979323846;

constexpr double DegToRad(double degrees) { return degrees * (kPi / 180.0); }
constexpr double RadToDeg(double radians) { return radians * (180.0 / kPi); }

}  // namespace rigel

#endif  // RIGEL_CORE_ANGLES_H_
