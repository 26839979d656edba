// Uses the installed package: one call at least into each library. Exit 0 if every check holds.
#include <cstdio>

#include "rigel/core/pose.h"
#include "rigel/minimal/catalogue.h"

namespace {

int failures = 0;

void Check(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "failed: %s\n", what);
  ++failures;
}

void CheckCore() {
  rigel::Pose pose;
  pose.R = rigel::RotationY(0.25);
  pose.t = Eigen::Vector3d(0.0, 0.0, 1.0);
  const rigel::Pose identity = pose * pose.Inverse();
  Check(rigel::LogSO3(identity.R).norm() < 1e-12, "pose * inverse does not rotate");
  Check(identity.t.norm() < 1e-12, "pose * inverse does not translate");
}

void CheckMinimal() {
  Check(!rigel::SolverCatalogue().empty(), "the catalogue has solvers");
  for (const rigel::SolverInfo& solver : rigel::SolverCatalogue()) {
    Check(rigel::FindSolver(solver.name) != nullptr, solver.name);
    Check(solver.solve != nullptr, solver.name);
  }
  Check(rigel::FindSolver("no such solver") == nullptr, "an unknown name is no solver");
}

}  // namespace

int main() {
  CheckCore();
  CheckMinimal();
  if (failures == 0) std::printf("solvers: %s\n", rigel::SolverNames().c_str());
  return failures == 0 ? 0 : 1;
}
