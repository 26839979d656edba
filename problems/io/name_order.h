// The order of file names that contain numbers.
#ifndef RIGEL_PROBLEMS_IO_NAME_ORDER_H_
#define RIGEL_PROBLEMS_IO_NAME_ORDER_H_

#include <string>
#include <string_view>
#include <vector>

namespace rigel {

// Whether `a` comes before `b`, of what is not a digit byte by byte, of numbers the lesser first:
// "2-10" before "10-2". Digits behind a point behind digits are decimals: "1.25" before "1.5".
bool ComesBeforeByNumbers(std::string_view a, std::string_view b);

// Sorts by the numbers in the names where all have some, else in byte order. True if byte order
// would be another.
bool SortByNumbers(std::vector<std::string>* names);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_NAME_ORDER_H_
