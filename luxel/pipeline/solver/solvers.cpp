#include "luxel/pipeline/solver/solvers.h"

#include <algorithm>
#include <array>

namespace luxel::pipeline {

// Each stands in the file of its name.
Solver gather_solver();
Solver hemicube_solver();
Solver matrix_solver();
Solver hierarchical_solver();
Solver reference_solver();

std::span<const Solver> solvers() {
  static const std::array table{
      gather_solver(),        // rays from each texel, and radiosity bounced between texels
      hemicube_solver(),      // radiosity of vertices or triangles by hemicubes
      matrix_solver(),        // radiosity of patches by a matrix of form factors
      hierarchical_solver(),  // radiosity of elements that links divide
      reference_solver(),     // the path tracer
  };
  return table;
}

const Solver* find_solver(std::string_view name) {
  const auto found = std::find_if(solvers().begin(), solvers().end(),
                                  [&](const Solver& solver) { return solver.name == name; });
  return found == solvers().end() ? nullptr : &*found;
}

std::string solver_names() {
  std::string names;
  for (const Solver& solver : solvers())
    names += (names.empty() ? "" : ", ") + std::string(solver.name);
  return names;
}

}  // namespace luxel::pipeline
