// Cells of a CSV file (RFC 4180).
#ifndef RIGEL_PROBLEMS_IO_CSV_H_
#define RIGEL_PROBLEMS_IO_CSV_H_

#include <string>
#include <string_view>

namespace rigel {

// Quoted if it has to be.
std::string CsvText(std::string_view text);

// The shortest text that reads back as the same double; empty if it is not finite.
std::string CsvNumber(double value);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_CSV_H_
