// Names of the values of an enum, as flags and reports spell them: one table, searched both ways.
#ifndef RIGEL_CORE_ENUM_NAMES_H_
#define RIGEL_CORE_ENUM_NAMES_H_

#include <cstddef>
#include <string_view>

namespace rigel {

template <class Enum>
struct EnumName {
  Enum value;
  const char* name;
};

// "unknown" if the table does not have the value.
template <class Enum, size_t N>
const char* NameOf(const EnumName<Enum> (&names)[N], Enum value) {
  for (const EnumName<Enum>& entry : names) {
    if (entry.value == value) return entry.name;
  }
  return "unknown";
}

// False, *value unchanged, if the table does not have the name.
template <class Enum, size_t N>
bool FindValue(const EnumName<Enum> (&names)[N], std::string_view name, Enum* value) {
  for (const EnumName<Enum>& entry : names) {
    if (name == entry.name) {
      *value = entry.value;
      return true;
    }
  }
  return false;
}

}  // namespace rigel

#endif  // RIGEL_CORE_ENUM_NAMES_H_
