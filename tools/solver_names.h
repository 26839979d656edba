// Lists of solvers in the values of flags.
#ifndef RIGEL_TOOLS_SOLVER_NAMES_H_
#define RIGEL_TOOLS_SOLVER_NAMES_H_

#include <functional>
#include <string>
#include <vector>

namespace rigel {

// The names that --solvers lists, comma separated; none if it is empty. False with a message if it
// has commas alone, or a name that is not known. `known` is a text with the known ones.
bool ParseSolvers(const std::string& solvers,
                  const std::function<bool(const std::string& name)>& is_known,
                  const std::string& known, std::vector<std::string>* names, std::string* error);

}  // namespace rigel

#endif  // RIGEL_TOOLS_SOLVER_NAMES_H_
