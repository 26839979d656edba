#include "rigel/tools/solver_names.h"

#include "rigel/tools/tool.h"

namespace rigel {

bool ParseSolvers(const std::string& solvers,
                  const std::function<bool(const std::string& name)>& is_known,
                  const std::string& known, std::vector<std::string>* names, std::string* error) {
  *names = SplitCommas(solvers);
  if (!solvers.empty() && names->empty()) {
    return Refuse("--solvers=" + solvers + ": names no solver", error);
  }
  for (const std::string& name : *names) {
    if (is_known(name)) continue;
    return Refuse("--solvers: there is no solver '" + name + "'; expected some of " + known, error);
  }
  return true;
}

}  // namespace rigel
